"""Interactive pictures: plotly in the style of the house, and a picture as a page that needs nothing from outside."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from typing import Any

import attrs
import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from mckibben.spec.errors import SpecError
from mckibben.view import style

__all__ = [
    "GREY",
    "SYMBOLS",
    "Web",
    "check_plotly",
    "colour_scale",
    "dots",
    "hover",
    "panels",
    "rows_of",
    "safe",
    "wrapped",
]

GREY = to_hex(style.GREY)
FAINT = to_hex("0.9")
SYMBOLS = {
    "o": "circle-open", "v": "triangle-down-open", "^": "triangle-up-open", ">": "triangle-right-open",
    "<": "triangle-left-open", "s": "square-open", "x": "x-thin-open",
}  # fmt: skip
"""Plotly's names of matplotlib's markers."""
DASHES = {"-": "solid", "--": "dash", ":": "dot"}
"""Plotly's names of matplotlib's lines."""
CONFIG = {
    "displaylogo": False, "responsive": True, "showSendToCloud": False, "plotlyServerURL": "",
    "modeBarButtonsToRemove": ["select2d", "lasso2d", "autoScale2d"],
    "toImageButtonOptions": {"format": "svg", "filename": "picture"},
}  # fmt: skip
"""What plotly's buttons do: nothing is sent anywhere."""
_FONT = "DejaVu Sans, Verdana, Arial, sans-serif"
_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; \
style-src 'unsafe-inline'; img-src data: blob:; form-action 'none'; base-uri 'none'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light">
<title>{heading}</title>
<style>
body {{ margin: 1rem; background: #fff; color: #000; font-family: {font}; }}
h1 {{ margin: 0 0 0.4rem; font-size: 1rem; font-weight: normal; }}
#frame {{ height: max({height}px, calc(100vh - 8rem)); margin-right: 32px; }}
#frame > div {{ height: 100%; }}
#frame .modebar {{ right: -34px !important; }}
p {{ margin: 0.4rem 0 0; font-size: 0.75rem; color: {grey}; }}
</style>
</head>
<body>
<h1>{heading}</h1>
<noscript><p>This picture is drawn by JavaScript, which is switched off here.</p></noscript>
<div id="frame">{figure}</div>
{notes}
</body>
</html>
"""
"""Its policy lets a browser load nothing from anywhere, whatever plotly could ask for."""


@attrs.frozen(eq=False)
class Web:
    """An interactive picture with the words above and below it."""

    figure: Any  #: of plotly
    heading: str
    notes: tuple[str, ...] = ()
    height: int = 480  #: least height of the picture in pixels

    def page(self) -> bytes:
        """One HTML file, plotly inside (some 5 MB); equal pictures are equal files."""
        drawn = self.figure.to_html(full_html=False, include_plotlyjs=True, div_id="picture", config=CONFIG)
        notes = "\n".join(f"<p>{html.escape(line)}</p>" for line in self.notes if line)
        made = _PAGE.format(
            heading=html.escape(self.heading), font=_FONT, height=self.height, grey=GREY, figure=drawn, notes=notes
        )
        return made.encode("utf-8")


def check_plotly(name: str) -> None:
    """SpecError in one sentence where plotly is missing."""
    if find_spec("plotly") is None:
        said = "is an interactive picture, which takes plotly to draw"
        raise SpecError(name, allowed=said, advice='pip install "mckibben[interactive]", or write .png, .pdf or .svg')


def panels(rows: int = 1, columns: int = 1, **options: Any) -> Any:
    """A plotly Figure in the style of the house, with so many panels."""
    from plotly.subplots import make_subplots

    figure = make_subplots(rows, columns, **options)
    axis = {
        "showgrid": True, "gridcolor": FAINT, "zeroline": False, "linecolor": style.BLACK, "linewidth": 1,
        "ticks": "outside", "ticklen": 4, "automargin": True, "title_standoff": 8, "exponentformat": "power",
    }  # fmt: skip
    space = {"backgroundcolor": "#ffffff", "gridcolor": FAINT, "linecolor": style.BLACK, "zeroline": False}
    figure.update_layout(
        template="none", paper_bgcolor="#ffffff", plot_bgcolor="#ffffff", colorway=list(style.LINES),
        font={"family": _FONT, "size": 13, "color": style.BLACK}, hovermode="closest",
        hoverlabel={"bgcolor": "#ffffff", "bordercolor": GREY, "align": "left", "namelength": -1,
                    "font": {"family": _FONT, "size": 12, "color": style.BLACK}},
        margin={"l": 10, "r": 10, "t": 16, "b": 10}, legend={"font": {"size": 12}, "itemsizing": "trace"},
        modebar={"orientation": "v", "bgcolor": "#ffffff", "color": GREY, "activecolor": style.BLACK},
    )  # fmt: skip
    figure.update_xaxes(axis)
    figure.update_yaxes(axis)
    figure.update_scenes({name: space for name in ("xaxis", "yaxis", "zaxis")})
    return figure


def dots(x: Any, y: Any, said: Iterable[str] | None, **options: Any) -> dict[str, Any]:
    """What plotly's scatter takes for points that tell a text each; without texts they tell nothing."""
    shown = {"hoverinfo": "skip"} if said is None else {"text": list(said), "hovertemplate": "%{text}<extra></extra>"}
    return {"x": np.asarray(x, float), "y": np.asarray(y, float), **shown, **options}


def hover(head: str, told: Iterable[tuple[str, str]]) -> str:
    """What a point tells: a line in bold, and names with their values; text as plotly takes it."""
    lines = [f"<b>{safe(head)}</b>"] if head else []
    return "<br>".join([*lines, *(f"{safe(name)}: {safe(value)}" for name, value in told)])


def safe(text: str) -> str:
    """Text that plotly shows as it is: its labels read some HTML."""
    return html.escape(text, quote=False).replace("\n", "<br>")


def wrapped(text: str, width: int) -> str:
    """Text in lines of so many letters."""
    return "<br>".join(map(safe, textwrap.wrap(text, width)))


def colour_scale(name: str) -> list[tuple[float, str]]:
    """A colour map of matplotlib as plotly takes it."""
    return [(float(x), to_hex(colormaps[name](float(x)))) for x in np.linspace(0.0, 1.0, 33)]


def rows_of(columns: Mapping[str, Iterable[str]]) -> list[str]:
    """The texts of points by columns of texts, one name each."""
    return [hover("", zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
