"""Interactive pictures of maps: the force over length and pressure, every point with its numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from mckibben.potential.chart import Chart
from mckibben.spec.errors import SpecError
from mckibben.units import from_si, show
from mckibben.view import style, web
from mckibben.view.chart import OUTSIDE, RUBS, contraction, grid, levels, words
from mckibben.view.maps import muscle_of
from mckibben.view.words import sentence, title

__all__ = ["charted", "force_map"]

BLANK = "Blank: not in the map."
POINTS = 81
"""Lengths and pressures at which a map tells its numbers."""
PLACE = ("length: %{x:.5~g} mm", "pressure: %{y:.5~g} bar", "force: %{z:.5~g} N")
"""How a point of a force over length and pressure tells these; plotly fills in the numbers."""
TOLD = {
    "contraction": ("1", "%"), "volume": ("m^3", "mL"), "stiffness": ("N/m", "N/mm"),
    "largest_fibre_tension": ("N", "N"),
}  # fmt: skip
"""What else it tells: SI unit, and the unit shown."""


def charted(chart: Chart) -> web.Web:
    """Forces of a map over contraction, and over its range with its edges."""
    figure = web.panels(1, 2, column_widths=[0.46, 0.54], horizontal_spacing=0.1)
    for k, (P, inside, low, high) in enumerate(levels(chart)):
        colour, name = style.LINES[k % len(style.LINES)], show(P, "Pa", 3)
        if chart.rubs is not None:
            _band(figure, chart, P, inside, colour, not k)
        _curve(figure, chart, P, inside, name, line={"color": colour, "width": 2})
        for side, outside in enumerate((low, high)):
            _curve(figure, chart, P, outside, OUTSIDE, line={"color": colour, "width": 1.5, "dash": "dot"},
                   legendgroup=OUTSIDE, legendrank=2000, showlegend=k + side == 0)  # fmt: skip
    figure.add_hline(0.0, line={"color": web.GREY, "width": 1}, row=1, col=1)
    figure.update_xaxes(title_text="Contraction (%)", row=1, col=1)
    figure.update_yaxes(title_text=style.axis_label("force", "N"), row=1, col=1)
    lengths, pressures = grid(chart, POINTS, beyond=0.0)
    values = chart.values(lengths, pressures[:, None])
    told = {name: getattr(values, name) for name in ("volume", "stiffness")}
    short = np.broadcast_to(0.01 * contraction(chart, lengths), values.force.shape)
    force = np.where(values.inside, values.force, np.nan)
    _contours(figure, lengths, pressures, force, {"contraction": short, **told}, 2)
    ends = style.shown(grid(chart)[0][[0, -1]], "m")
    figure.update_xaxes(range=[float(end) for end in ends], row=1, col=2)
    low, high = chart.lengths(pressures)
    y, place = style.shown(pressures, "Pa"), {"row": 1, "col": 2}
    for edge, shown in ((low, True), (high, False)):
        line = web.dots(style.shown(edge, "m"), y, None, mode="lines", line={"color": style.BLUE, "width": 1.5})
        figure.add_scatter(**line, name="shortest, longest", legend="legend2", showlegend=shown, **place)
    free = chart.free_length(pressures)
    if np.isfinite(free).any():
        line = web.dots(style.shown(free, "m"), y, None, mode="lines", line={"color": style.BLACK, "width": 1.5})
        figure.add_scatter(**line, name="free: 0 N", legend="legend2", **place)
    figure.update_layout(
        legend={"x": figure.layout.xaxis.domain[1], "xanchor": "right", "y": 1.0, "bgcolor": "rgba(255,255,255,0.8)"},
        legend2={"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": figure.layout.xaxis2.domain[0]},
    )
    return web.Web(figure, words(chart), (BLANK, *map(sentence, chart.notes)), 520)


def force_map(forces: xr.Dataset) -> web.Web:
    """Force over length and pressure that `force_map` found; blank where there is no admissible state."""
    force = forces["force"].values
    if min(force.shape) < 2:
        raise SpecError("interactive", allowed="a force map of one length or one pressure is a curve: run that test")
    figure = web.panels()
    told = {name: forces[name].values for name in ("contraction", "volume", "largest_fibre_tension")}
    _contours(figure, forces["length"].values, forces["pressure"].values, force, told, 1)
    muscle = muscle_of(forces)
    name = "" if muscle is None else f"{title(muscle)}: "
    return web.Web(
        figure, f"{name}force over length and pressure", () if muscle is None else (style.assumption(muscle),)
    )


def _curve(figure: Any, chart: Chart, P: float, lengths: np.ndarray, name: str, **options: Any) -> None:
    """The force over the contraction at one pressure."""
    values, short = chart.values(lengths, P), contraction(chart, lengths)
    columns = {
        "length": [show(x, "m", 5) for x in lengths], "contraction": [f"{x:.5g} %" for x in short],
        "pressure": [show(P, "Pa", 5)] * len(lengths), "force": [show(x, "N", 5) for x in values.force],
        "volume": [show(x, "m^3", 5) for x in values.volume],
        "stiffness": [show(x, TOLD["stiffness"][1], 5) for x in values.stiffness],
    }  # fmt: skip
    if chart.rubs is not None:
        columns[RUBS] = [f"± {show(x, 'N', 3)}" for x in chart.friction(lengths, P)]
    figure.add_scatter(
        **web.dots(short, values.force, web.rows_of(columns), mode="lines", name=name, **options), row=1, col=1
    )


def _band(figure: Any, chart: Chart, P: float, lengths: np.ndarray, colour: str, first: bool) -> None:
    """What lies between the branches of a muscle with friction at one pressure."""
    short = contraction(chart, lengths)
    for force, fill in zip(chart.branches(lengths, P), (None, "tonexty"), strict=True):
        line = web.dots(short, force, None, mode="lines", line={"color": colour, "width": 0}, fill=fill)
        shown = {"legendgroup": RUBS, "legendrank": 1999, "showlegend": first and fill is not None}
        figure.add_scatter(**line, **shown, name=RUBS, opacity=0.3, row=1, col=1)


def _contours(
    figure: Any, lengths: np.ndarray, pressures: np.ndarray, force: np.ndarray, told: dict[str, np.ndarray], column: int
) -> None:
    """Forces (pressures, lengths) as coloured contours, red where the muscle pulls, and a line without force."""
    shown = [
        100.0 * values if TOLD[name][1] == "%" else from_si(values, TOLD[name][1]) for name, values in told.items()
    ]
    lines = [f"{name.replace('_', ' ')}: %{{customdata[{k}]:.5~g}} {TOLD[name][1]}" for k, name in enumerate(told)]
    size = float(np.nanmax(np.abs(force))) if np.isfinite(force).any() else 1.0
    figure.add_contour(
        x=style.shown(lengths, "m"), y=style.shown(pressures, "Pa"), z=force, customdata=np.stack(shown, axis=-1),
        zmin=-size, zmax=size, colorscale=web.colour_scale("RdBu_r"), ncontours=24, line={"width": 0.3},
        hovertemplate="<br>".join([*PLACE, *lines]) + "<extra></extra>", hoverongaps=False, showlegend=False,
        colorbar={"title": {"text": style.axis_label("force", "N"), "side": "top"}, "thickness": 14},
        row=1, col=column,
    )  # fmt: skip
    figure.update_xaxes(title_text=style.axis_label("length", "m"), showgrid=False, row=1, col=column)
    figure.update_yaxes(title_text=style.axis_label("pressure", "Pa"), showgrid=False, row=1, col=column)
