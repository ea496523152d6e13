"""The picture of tolerances: how each result is distributed, and the part that each number has in it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.results.tolerances import Tolerances
from mckibben.units import show
from mckibben.view import style
from mckibben.view.words import title

__all__ = ["scatter"]

ROW = 0.5
"""Height [inch] of a number with its bars."""
LEAST = 2.1
"""Least height [inch] of a result's panels."""
BINS = 32
"""Bars of a distribution at most."""
SHARES = {"share": ("by derivatives", style.SKY), "first": ("alone, sampled", style.BLUE),
          "total": ("in all, sampled", style.ORANGE)}  # fmt: skip
"""Bars of a number: label and colour."""
BAR = 0.26
"""Height of a bar over that of a number."""
QUANTILES = {"5 %": "right", "50 %": "center", "95 %": "left"}
"""The quantiles and the side of their line on which they are written."""
FAR = 2.5
"""Distances of the outer quantiles from the middle one up to which samples are drawn."""


def scatter(tolerances: Tolerances) -> Figure:
    """A row for each result: its distribution with the quantiles 5, 50 and 95 %, and bars of the shares of variance.

    The line over a distribution is the normal one that derivatives foretell. Assumed numbers carry a star; a note names
    them all.
    """
    data, results = tolerances.data, tolerances.results
    height = max(LEAST, 0.9 + ROW * len(tolerances.numbers))
    figure = style.new_figure(style.PAGE, height * len(results) + 0.5)
    panels = np.atleast_2d(figure.subplots(len(results), 2, width_ratios=(1.0, 1.1)))
    for k, (left, right) in enumerate(panels):
        _distribution(left, tolerances, k)
        _shares(right, tolerances, k)
    said = f"{tolerances.test.kind} test, state {data.attrs['state']}"
    name = title(tolerances.muscle)
    style.heading(figure, f"{name}: tolerances; {said}")
    style.note(figure, " ".join(f"{line[0].upper()}{line[1:]}." for line in tolerances.notes))
    return figure


def _distribution(axes: Axes, tolerances: Tolerances, k: int) -> None:
    known = tolerances.data.isel(result=k)
    name, unit = tolerances.results[k].replace("_", " "), str(known["result_unit"].values)
    found = known["sampled"].values
    good = _people(found[np.isfinite(found)], unit)
    meant, linear = (_people(float(value), unit) for value in (known["result_value"].values, tolerances.linear[k]))
    axes.set_xlabel(f"{name[:1].upper()}{name[1:]} (%)" if unit == "1" else style.axis_label(name, unit))
    axes.set_ylabel("Samples")
    if not len(good):
        axes.text(0.5, 0.5, "no sample has a stable state", ha="center", transform=axes.transAxes, fontsize=style.LABEL)
        style.tidy(axes)
        return
    quantiles = _people(tolerances.quantiles[:, k], unit)
    near = _near(good, quantiles)
    count, edges, _ = axes.hist(near, bins=min(BINS, max(8, len(near) // 16)), color="0.8", edgecolor="white",
                                linewidth=0.3)  # fmt: skip
    if linear > 0.0:
        at = np.linspace(edges[0], edges[-1], 200)
        density = np.exp(-0.5 * ((at - meant) / linear) ** 2) / (linear * np.sqrt(2.0 * np.pi))
        axes.plot(at, len(good) * (edges[1] - edges[0]) * density, color=style.VERMILLION, linewidth=1.2,
                  label="by derivatives")  # fmt: skip
    for (share, side), value in zip(QUANTILES.items(), quantiles.tolist(), strict=True):
        axes.axvline(value, color=style.BLUE, linewidth=1.0, linestyle="-" if share == "50 %" else "--")
        axes.annotate(f"{share}\n{value:.4g}", (value, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2),
                      textcoords="offset points", ha=side, va="bottom", fontsize=style.NOTE + 0.5,
                      color=style.BLUE)  # fmt: skip
    if len(near) < len(good):
        axes.text(0.99, 0.6, f"{len(good) - len(near)} samples\nbeyond", ha="right", transform=axes.transAxes,
                  fontsize=style.NOTE + 0.5, color=style.GREY)  # fmt: skip
    axes.set_ylim(0.0, 1.25 * float(np.max(count)))
    style.tidy(axes, legend="upper left" if linear > 0.0 else None, frameon=True, edgecolor="none", framealpha=0.9)


def _near(good: np.ndarray, quantiles: np.ndarray) -> np.ndarray:
    """The samples that are drawn: a few that lie far off would hide the others."""
    low, middle, high = quantiles.tolist()
    return good[(good >= middle - FAR * (middle - low)) & (good <= middle + FAR * (high - middle))]


def _people(values: np.ndarray | float, unit: str) -> np.ndarray:
    return np.asarray(100.0 * np.asarray(values) if unit == "1" else style.shown(np.asarray(values), unit))


def _shares(axes: Axes, tolerances: Tolerances, k: int) -> None:
    data, order = tolerances.data, tolerances.order
    places = np.arange(len(order))
    drawn = {kind: 100.0 * data[kind].values[order, k] for kind in SHARES}
    drawn = {kind: values for kind, values in drawn.items() if np.isfinite(values).any()}
    for row, (kind, values) in enumerate(drawn.items()):
        label, colour = SHARES[kind]
        at = places + (row - 0.5 * (len(drawn) - 1)) * BAR
        axes.barh(at, values, height=0.9 * BAR, color=colour, label=label)
        if row == len(drawn) - 1:
            for place, value in zip(at.tolist(), values.tolist(), strict=True):
                said = f"{value:.0f} %" if value >= 0.5 else "< 0.5 %"
                axes.text(max(value, 0.0) + 2.0, place, said, va="center", fontsize=style.NOTE + 0.5)
    axes.set_yticks(places, [_label(tolerances, row) for row in order.tolist()])
    axes.set_ylim(len(order) - 0.4, -0.6)
    axes.set_xlim(0.0, 115.0)
    axes.set_xlabel("Part in the variance (%)")
    style.tidy(axes, legend="lower right")
    axes.grid(False, axis="y")
    axes.tick_params(axis="y", length=0.0)


def _label(tolerances: Tolerances, row: int) -> str:
    known = tolerances.data.isel(number=row)
    mark = " *" if bool(known["number_assumed"].values) else ""
    size, unit = float(known["number_tolerance"].values), str(known["number_display"].values)
    way = "±" if str(known["number_distribution"].values) == "uniform" else "sd "
    return f"{known['number'].values}{mark}\n{known['number_shown'].values}, {way}{show(size, unit, 4)}"
