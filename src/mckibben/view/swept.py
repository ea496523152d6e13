"""The picture of a sweep: its last states over what varies."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.results.swept import Swept, said
from mckibben.spec import FreeContraction, Isotonic
from mckibben.units import DISPLAY
from mckibben.view import style
from mckibben.view.maps import muscle_of

__all__ = ["swept"]

LINES = 6
"""Curves of a second field that are drawn side by side; of more, their ends and some between."""
WIDE = 4.8
"""Width of the picture [in]: a column, and names of curves beside it."""
MOST = 20_000
"""Designs that are drawn one by one."""


def swept(data: xr.Dataset) -> Figure:
    """What the test does not hold, at the last state of each design, over the fields that vary.

    Over one field of numbers as a curve, over two as curves side by side, else over the designs in their order. States
    that are not stable have a ring, those that were not reached nothing. Curves and designs that are too many are left
    out, which a note says.
    """
    last = data.isel(step=-1) if "step" in data.dims else data
    name = _watched(data)
    figure = style.new_figure(WIDE, 2.7)
    axes = figure.add_subplot()
    axes.set_ylabel(style.axis_label(name, _unit(last[name], name)))
    left_out = ""
    if not np.isfinite(last[name].values).any():
        axes.text(0.5, 0.5, "no state was reached", transform=axes.transAxes, ha="center", fontsize=style.LABEL)
    else:
        left_out = _drawn(axes, last, name)
    style.tidy(axes, "upper left", bbox_to_anchor=(1.0, 1.0))
    found = Swept(data)
    title = str(data.attrs["title"])
    style.heading(figure, f"{title[0].upper()}{title[1:]}: the last state of each")
    if not found.large:
        style.note(figure, f"Designs: {said(found.statuses)}. States: {said(found.counts)}.")
    if left_out:
        style.note(figure, left_out)
    muscle = muscle_of(data)
    if muscle is not None:
        style.assumption_note(figure, muscle)
    return figure


def _watched(data: xr.Dataset) -> str:
    """The result that a test is made for: what it does not hold."""
    kind = tomllib.loads(data.attrs["test"]).get("kind")
    return "contraction" if kind in (FreeContraction.kind, Isotonic.kind) else "force"


def _drawn(axes: Axes, last: xr.Dataset, name: str) -> str:
    """Draws the states, and says which of them are left out."""
    long = [str(dim) for dim, size in last[name].sizes.items() if size > 1]
    long.sort(key=lambda dim: (last[dim].dtype.kind not in "if", -last.sizes[dim]) if dim in last.coords else (True, 0))
    first = long[0] if long else ""
    if 1 <= len(long) <= 2 and first in last.coords and last[first].dtype.kind in "if":
        part = last.squeeze()
        unit = _unit(last[first])
        axes.set_xlabel(first if unit == "1" else f"{first} ({unit})")
        rows = _some(part.sizes[long[1]]) if len(long) == 2 else [None]
        for k, row in enumerate(rows):
            one = part if row is None else part.isel({long[1]: row})
            label = None if row is None else f"{long[1]} {_value(last[long[1]], row)}"
            colour = style.LINES[k % len(style.LINES)]
            _points(axes, _shown(one[first]), one, name, colour, label, "-")
        every = part.sizes[long[1]] if len(long) == 2 else 1
        return f"Drawn: {len(rows)} of {every} values of {long[1]}." if len(rows) < every else ""
    axes.set_xlabel("Design")
    flat = last[[name, "verdict"]].stack(designs=last[name].dims) if last[name].dims else last.expand_dims("designs")
    every, flat = flat.sizes["designs"], flat.isel(designs=slice(None, MOST))
    _points(axes, np.arange(flat.sizes["designs"]), flat, name, style.BLUE, None, "none")
    return f"Drawn: the first {MOST} of {every} designs." if every > MOST else ""


def _points(axes: Axes, x: Any, part: xr.Dataset, name: str, colour: str, label: str | None, line: str) -> None:
    """A curve of stable states, and rings around those that are not."""
    y, stable = _shown(part[name]), part["verdict"].values == 0
    axes.plot(x, y, linestyle=line, marker="o", markersize=2.5, linewidth=1.0, color=colour, label=label)
    if (~stable & np.isfinite(y)).any():
        axes.plot(x[~stable], y[~stable], "o", markersize=6, markerfacecolor="none", color=style.GREY)


def _some(count: int) -> list[Any]:
    """Some of so many rows, both ends among them."""
    return list(dict.fromkeys(np.linspace(0, count - 1, min(count, LINES)).round().astype(int).tolist()))


def _unit(values: xr.DataArray, name: str = "") -> str:
    unit = str(values.attrs.get("units", "1"))
    return "%" if name == "contraction" else DISPLAY.get(unit, unit)


def _shown(values: xr.DataArray) -> Any:
    percent = values.name == "contraction"
    return 100.0 * values.values if percent else style.shown(values.values, str(values.attrs.get("units", "1")))


def _value(coordinate: xr.DataArray, row: int) -> str:
    value = coordinate.values[row]
    if coordinate.dtype.kind not in "if":
        return str(value)
    unit = _unit(coordinate)
    shown = style.shown(value, str(coordinate.attrs.get("units", "1")))
    return f"{shown:.4g}" + ("" if unit == "1" else f" {unit}")
