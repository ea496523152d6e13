"""House style of the pictures: sizes, colours, labels with units, notes, and writing to disk.

Figures are made without pyplot, so nothing global is kept: pictures can be drawn in threads and without a display.
"""

from __future__ import annotations

import io
import math
import os
import textwrap
from collections.abc import Iterable
from pathlib import Path
from threading import Lock
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, FigureBase

from mckibben import disk
from mckibben.spec import Muscle, SpecError
from mckibben.units import DISPLAY, from_si

COLUMN = 3.5
"""Width [inch] of a column of a two-column paper."""
PAGE = 7.16
"""Width [inch] of a page of a two-column paper."""

INCH = 96
"""Pixels of an inch of a picture in a notebook."""

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
"""The colours of Okabe and Ito, which colour-blind readers can tell apart."""
LINES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Colours of lines in the order of use. Without yellow, which is too faint."""

DENSITY_MESH = "viridis"
"""Colour map of the energy density of the fibres: even steps to the eye."""
DENSITY_CHAMBER = "cividis"
"""Colour map of the energy density of the chamber: even steps too, and not to be taken for that of the fibres."""
SEQUENCE = "viridis"
"""Colour map of a sequence of states."""

GREY = "0.45"
"""Colour of notes and of lines that mark where a step ends: dark enough to be read."""
LABEL = 8.0
"""Font size [pt] of axis labels and titles: that of captions in a two-column paper."""
TICK = 7.0
"""Font size [pt] of tick labels and legends."""
NOTE = 5.5
"""Font size [pt] of notes below a picture, the smallest that prints well."""

_FILES: Any = {"pdf.fonttype": 42, "svg.hashsalt": "mckibben"}
"""How files are written: TrueType fonts, and names inside an SVG that are the same every time."""
_WRITING = Lock()
"""matplotlib's settings are global: only one thread at a time may change them to write a file."""


class Picture(Figure):
    """A figure that a notebook shows by itself, once."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        return picture(self, "png"), {"width": round(INCH * self.get_figwidth())}


def new_figure(width: float = COLUMN, height: float = 2.6) -> Figure:
    """An empty figure of a given size [inch]. pyplot does not know it, so that it need not be closed."""
    figure = Picture(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def shown(values: Any, unit: str) -> Any:
    """SI values in the unit that people see: m in mm, Pa in bar, rad in deg, J in mJ."""
    return from_si(values, DISPLAY.get(unit, unit))


def axis_label(meaning: str, unit: str) -> str:
    """Label of an axis: axis_label("force", "N") is "Force (N)"; `unit` is SI or the unit shown, "1" or "" is none."""
    written = DISPLAY.get(unit, unit)
    for power, raised in (("^2", "²"), ("^3", "³"), ("^4", "⁴")):
        written = written.replace(power, raised)
    first = meaning[:1].upper() + meaning[1:]
    return first if written in ("", "1") else f"{first} ({written})"


def tidy(axes: Axes, legend: str | None = None, **options: Any) -> Axes:
    """Fonts, spines and grid of the house; with `legend` a legend at that place."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_linewidth(0.6)
    axes.tick_params(labelsize=TICK, width=0.6, length=2.5)
    axes.tick_params(which="minor", width=0.4, length=1.5)
    for label in (axes.xaxis.label, axes.yaxis.label, axes.title):
        label.set_fontsize(LABEL)
    axes.grid(True, color="0.9", linewidth=0.5)
    axes.set_axisbelow(True)
    if legend is not None and axes.get_legend_handles_labels()[0]:
        settings: dict[str, Any] = {"loc": legend, "fontsize": TICK - 0.5, "frameon": False, "handlelength": 2.2}
        axes.legend(**settings | options)
    return axes


def panel(axes: Axes, letter: str) -> None:
    """Letter of a panel, in its upper left corner outside the axes."""
    axes.set_title(letter, loc="left", fontsize=LABEL, fontweight="bold", pad=4.0)


def colour_bar(figure: FigureBase, colours: Any, place: Any, label: str, **options: Any) -> Any:
    """A colour bar in the house's fonts."""
    bar = figure.colorbar(colours, ax=place, **({"aspect": 28, "pad": 0.02} | options))
    bar.set_label(label, fontsize=TICK)
    bar.ax.tick_params(labelsize=TICK - 0.5, width=0.5, length=2.0)
    bar.outline.set_linewidth(0.5)
    return bar


def note(figure: Figure, text: str) -> None:
    """A small note below everything; several notes stand below each other."""
    width = int(figure.get_figwidth() * 72.0 / (0.57 * NOTE))
    lines = [figure.get_supxlabel(), *textwrap.wrap(text, width)]
    figure.supxlabel("\n".join(line for line in lines if line), fontsize=NOTE, color=GREY, x=0.01, ha="left")


def heading(figure: Figure, text: str) -> None:
    """A line above everything that says what is shown."""
    width = int(figure.get_figwidth() * 72.0 / (0.55 * TICK))
    figure.suptitle("\n".join(textwrap.wrap(text, width)), fontsize=TICK, color=BLACK)


def say(figure: Figure, text: str, notes: Iterable[str], muscle: Muscle) -> None:
    """A line above everything in which no line begins with a unit, and the notes and assumptions below."""
    heading(figure, text.replace(" %", "\u00a0%").replace(" N", "\u00a0N"))
    for line in notes:
        note(figure, line)
    assumption_note(figure, muscle)


def assumption_note(figure: Figure, muscle: Muscle) -> None:
    """Add a note that names the values of the muscle that are assumed, if there are any."""
    said = assumption(muscle)
    if said:
        note(figure, said)


def assumption(muscle: Muscle) -> str:
    """The sentence that names the values of the muscle that are assumed; empty where there are none."""
    groups = (
        ("fibre count", "braid.fibres"),
        ("fibre values", "braid.fibre."),
        ("chamber values", "chamber"),
        ("end condition", "ends"),
    )
    words = [word for word, start in groups if any(_within(name, start) for name in muscle.assumed)]
    known = [start for _, start in groups]
    words += [name for name in muscle.assumed if not any(_within(name, start) for start in known)]
    if not words:
        return ""
    said = (", ".join(words[:-1]) + " and " if words[1:] else "") + words[-1]
    said = said.replace("fibre values, chamber values", "fibre and chamber values")
    said = said.replace("fibre values and chamber values", "fibre and chamber values")
    reason = ": the paper does not print them" if (muscle.name or "").startswith("paper") else ""
    verb = "is" if words == ["fibre count"] or words == ["end condition"] else "are"
    return f"{said[0].upper()}{said[1:]} {verb} assumed{reason}."


def _within(name: str, start: str) -> bool:
    return name == start or (name + ".").startswith(start if start.endswith(".") else start + ".")


def save(figure: Figure, stem: str | os.PathLike[str], formats: Iterable[str] = ("pdf", "png")) -> tuple[Path, ...]:
    """Write a figure as STEM.pdf and STEM.png (200 dpi), over files of these names, each whole or not at all.

    Returns the paths. Raises SpecError for a place that cannot be written.
    """
    paths = [Path(f"{os.fspath(stem)}.{kind}") for kind in formats]
    for path in paths:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SpecError(str(path), allowed=f"cannot be written: {error.strerror or error}") from error
        disk.write(path, picture(figure, path.suffix[1:]), force=True)
    return tuple(paths)


def picture(figure: Figure, kind: str, pixels: int = 0) -> bytes:
    """A figure as the bytes of a file, "pdf", "png" (200 dpi, and at least `pixels` wide) or "svg".

    It holds no date, so that equal pictures are equal files, and fonts as journals want them (TrueType).
    """
    nothing = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(kind)
    content = io.BytesIO()
    with _WRITING, matplotlib.rc_context(_FILES):
        dpi = max(200, math.ceil(pixels / figure.get_figwidth()))
        figure.savefig(content, format=kind, dpi=dpi, metadata=nothing)
    return content.getvalue()
