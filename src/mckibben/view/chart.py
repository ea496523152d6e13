"""The picture of a map: force over contraction at several pressures, and over its range."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from mckibben.potential.chart import Chart
from mckibben.units import show
from mckibben.view import style

__all__ = ["OUTSIDE", "charted", "contraction", "grid", "levels", "words"]

CURVES = 5
"""Pressures of which the force is drawn."""
OUTSIDE = "goes on outside the range"
RUBS = "with friction"
FINE = 201
BEYOND = 0.06
"""How far the picture goes beyond the range, over its size."""
LEGEND = 0.6
"""Room above the forces, over their range, for what the lines mean."""


def charted(chart: Chart) -> Figure:
    """The forces of a map, its range, the length without force, and its error."""
    figure = style.new_figure(style.PAGE, 3.0)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _curves(left, chart)
    _range(figure, right, chart)
    for axes, letter in ((left, "a"), (right, "b")):
        style.panel(axes, letter)
    style.heading(figure, words(chart))
    style.assumption_note(figure, chart.muscle)
    return figure


def words(chart: Chart) -> str:
    """The heading: which muscle, and how far off the map is."""
    name = f'Map of muscle "{chart.muscle.name}"' if chart.muscle.name else "Map of a muscle without a name"
    error = f"force to {show(chart.force_error, 'N', 2)} ({100.0 * chart.error:.2g} % of the largest)"
    return f"{name}: {error} at {chart.data.sizes['check']} states that it was not made of"


def levels(chart: Chart) -> Iterator[tuple[float, np.ndarray, np.ndarray, np.ndarray]]:
    """Some pressures [Pa] with the lengths [m] that are drawn: inside of the range, below it and above it."""
    for P in np.linspace(*chart.pressures, CURVES).tolist():
        low, high = (float(end) for end in chart.lengths(P))
        room = BEYOND * (high - low)
        yield P, np.linspace(low, high, FINE), np.linspace(low - room, low, 21), np.linspace(high, high + room, 21)


def grid(chart: Chart, points: int = FINE, beyond: float = BEYOND) -> tuple[np.ndarray, np.ndarray]:
    """Lengths [m] over the range and a part of it beyond, and pressures [Pa]."""
    shortest, longest = (float(chart.data.attrs[f"asked_{end}"]) for end in ("shortest", "longest"))
    room = beyond * (longest - shortest)
    return np.linspace(shortest - room, longest + room, points), np.linspace(*chart.pressures, points)


def contraction(chart: Chart, length: np.ndarray) -> np.ndarray:
    """Contraction [%] at lengths [m]."""
    return 100.0 * (1.0 - length / chart.muscle.rest_length)


def _curves(axes: Axes, chart: Chart) -> None:
    """Force over contraction, dotted where the map goes on outside of its range."""
    forces = []
    for k, (P, inside, low, high) in enumerate(levels(chart)):
        colour = style.LINES[k % len(style.LINES)]
        forces.append(chart.force(inside, P))
        if chart.rubs is not None:
            low_force, high_force = chart.branches(inside, P)
            axes.fill_between(contraction(chart, inside), low_force, high_force, color=colour, alpha=0.3, lw=0.0,
                              label=None if k else RUBS)  # fmt: skip
        axes.plot(contraction(chart, inside), forces[-1], color=colour, lw=1.2, label=show(P, "Pa", 3))
        for side, outside in enumerate((low, high)):
            label = OUTSIDE if k + side == 0 else None
            axes.plot(contraction(chart, outside), chart.force(outside, P), ":", color=colour, lw=1.0, label=label)
    lowest, highest = min(f.min() for f in forces), max(f.max() for f in forces)
    axes.set_ylim(lowest - 0.08 * (highest - lowest), highest + LEGEND * (highest - lowest))
    axes.axhline(0.0, color="0.5", lw=0.6)
    axes.set(xlabel="Contraction (%)", ylabel=style.axis_label("force", "N"))
    handles, labels = axes.get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda k: labels[k] in (OUTSIDE, RUBS))
    style.tidy(axes)
    axes.legend([handles[k] for k in order], [labels[k] for k in order], loc="upper right", ncols=2, frameon=False,
                fontsize=style.TICK - 0.5)  # fmt: skip


def _range(figure: Figure, axes: Axes, chart: Chart) -> None:
    """Contours of the force over length and pressure; hatched where the muscle has no state or none was asked for."""
    lengths, pressures = grid(chart)
    values = chart.values(lengths[:, None], pressures)
    force = np.where(values.inside, values.force, np.nan).T
    size = float(np.nanmax(np.abs(force)))
    levels = MaxNLocator(16, symmetric=True).tick_values(-size, size)
    x, y = style.shown(lengths, "m"), style.shown(pressures, "Pa")
    axes.set_facecolor("0.93")
    axes.patch.set(hatch="////", edgecolor="0.7")
    filled = axes.contourf(x, y, force, levels, cmap="RdBu_r")
    style.colour_bar(figure, filled, axes, style.axis_label("force", "N"), ticks=MaxNLocator(9, symmetric=True))
    free = chart.free_length(pressures)
    if np.isfinite(free).any():
        axes.plot(style.shown(free, "m"), y, color="k", lw=1.2, label="free: 0 N")
    low, high = chart.lengths(pressures)
    axes.plot(style.shown(low, "m"), y, color=style.BLUE, lw=1.0, label="shortest, longest")
    axes.plot(style.shown(high, "m"), y, color=style.BLUE, lw=1.0)
    axes.fill([], [], facecolor="0.93", edgecolor="0.7", hatch="////", label="not in the map")
    axes.set(xlabel=style.axis_label("length", "m"), ylabel=style.axis_label("pressure", "Pa"))
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    style.tidy(axes, "upper center", ncols=3, bbox_to_anchor=(0.5, 1.16))
