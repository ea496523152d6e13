"""Curves of any result: the picture for its kind of test, profiles along the length, energies, load sharing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.results.result import Result
from mckibben.results.variables import FIELDS, STEP
from mckibben.view import style
from mckibben.view.words import lost

MARKS = {"unstable": ("x", style.VERMILLION), "inadmissible": ("s", style.ORANGE)}
"""Marker and colour of states that exist and are not stable."""

PARTS = (
    ("energy_chamber", "chamber", style.ORANGE, "-"),
    ("energy_bending_1", "bending 1 (in plane)", style.SKY, "-"),
    ("energy_bending_2", "bending 2 (normal)", style.BLUE, "-"),
    ("energy_twist", "twist", style.GREEN, "--"),
)
"""Parts of the stored energy: variable, name in the legend, colour and line style."""
PROTOCOL = (("force", style.BLUE), ("length", style.GREEN), ("pressure", style.VERMILLION))
"""What is drawn of a protocol state by state, and its colour."""
FIELD_NAMES = {"r": "radius r", "theta": "braid angle θ", "psi": "slope ψ", "fibre_tension": "fibre tension T"}
"""Short names of fields on axes; others go by their meaning."""


def column(result: Result, name: str) -> np.ndarray:
    """A variable of the result in the unit shown: mm, N, bar, deg, mJ; contraction in per cent."""
    values = np.asarray(result.data[name].values, float)
    if name == "contraction":
        return 100.0 * values
    return np.asarray(style.shown(values, (STEP | FIELDS)[name][0]))


def label(name: str) -> str:
    """Axis label of a variable of one value per state."""
    return style.axis_label(name, "%" if name == "contraction" else STEP[name][0])


def driven(result: Result) -> str:
    """What the test varies: "pressure", "length", or "state" where several things do."""
    kind = result.test.kind
    if kind in ("isometric", "blocked-force", "isotonic", "free-contraction"):
        return "pressure"
    return "contraction" if kind == "isobaric" else "state"


def drawn(result: Result) -> str:
    """What is drawn of a test that varies one thing."""
    return "contraction" if result.test.kind in ("isotonic", "free-contraction") else "force"


def starts(result: Result) -> list[float]:
    """Where the steps of a protocol begin, between two states."""
    return [float(k) + 0.5 for k in np.flatnonzero(np.diff(result.column("protocol_step")))]


def against(result: Result) -> tuple[np.ndarray, str]:
    """Values and label of the axis that a result is drawn against."""
    name = driven(result)
    return (np.arange(len(result), dtype=float), "State") if name == "state" else (column(result, name), label(name))


def plot(result: Result) -> Figure:
    """Draw a result as the kind of its test asks for."""
    kind = result.test.kind
    if kind in ("protocol", "step"):
        figure = _plot_protocol(result)
    else:
        figure = style.new_figure()
        axes = figure.add_subplot()
        y = drawn(result)
        x = driven(result)
        line(axes, result, x, y)
        axes.set(xlabel=label(x), ylabel=label(y))
        if y == "contraction":
            _length_axis(axes, result)
        style.tidy(axes, "best" if axes.get_legend_handles_labels()[0] else None)
    notes(figure, result)
    return figure


def family(results: Mapping[str, Result]) -> Figure:
    """Curves of several results of one kind of test in one picture, with their names in the legend."""
    first = next(iter(results.values()))
    figure = style.new_figure()
    axes = figure.add_subplot()
    y = drawn(first)
    x = driven(first)
    for k, (name, result) in enumerate(results.items()):
        line(axes, result, x, y, color=style.LINES[k % len(style.LINES)], label=name)
    axes.set(xlabel="State" if x == "state" else label(x), ylabel=label(y))
    style.tidy(axes, "best")
    style.assumption_note(figure, first.muscle)
    return figure


def line(axes: Axes, result: Result, x: str, y: str, **options: Any) -> None:
    """One curve of a result in units shown, its states as dots, those not stable marked."""
    xs, ys = (np.arange(len(result), dtype=float) if name == "state" else column(result, name) for name in (x, y))
    settings: dict[str, Any] = {"color": style.BLUE, "linewidth": 1.2, "marker": ".", "markersize": 3.0}
    axes.plot(xs, ys, **settings | options)
    mark(axes, result, xs, ys)


def mark(axes: Axes, result: Result, xs: np.ndarray, ys: np.ndarray) -> None:
    """Mark the states that are not stable, one entry of the legend per verdict."""
    verdicts = np.array(result.verdict)
    known = set(axes.get_legend_handles_labels()[1])
    for verdict, (marker, colour) in MARKS.items():
        hit = verdicts == verdict
        if hit.any():
            name = f"_{verdict}" if verdict in known else verdict
            axes.plot(xs[hit], ys[hit], linestyle="none", marker=marker, color=colour, markersize=4.5,
                      markerfacecolor="none", label=name, zorder=4)  # fmt: skip


def notes(figure: Figure, result: Result) -> None:
    """Below the picture: what was not reached and why, and what is assumed."""
    said = lost(result)
    if said:
        if not np.isfinite(result.column("length")).any():
            for axes in figure.axes:
                axes.set(xticks=[], yticks=[])
                axes.text(0.5, 0.5, "no state was reached", transform=axes.transAxes, ha="center", fontsize=style.LABEL)
        style.note(figure, said)
    style.assumption_note(figure, result.muscle)


def _length_axis(axes: Axes, result: Result) -> None:
    H0 = float(style.shown(float(result.muscle.rest_length), "m"))

    def to_length(contraction: Any) -> Any:
        return H0 * (1.0 - 0.01 * np.asarray(contraction))

    def to_contraction(length: Any) -> Any:
        return 100.0 * (1.0 - np.asarray(length) / H0)

    second = axes.secondary_yaxis("right", functions=(to_length, to_contraction))
    second.set_ylabel(label("length"), fontsize=style.LABEL)
    second.tick_params(labelsize=style.TICK, width=0.6, length=2.5)
    second.spines["right"].set_linewidth(0.6)


def _plot_protocol(result: Result) -> Figure:
    figure = style.new_figure(style.PAGE, 3.8)
    grid = figure.add_gridspec(3, 2, width_ratios=(1.25, 1.0))
    parts = np.asarray(result.data["protocol_step"].values)
    first = None
    for row, (name, colour) in enumerate(PROTOCOL):
        axes = figure.add_subplot(grid[row, 0], sharex=first)
        first = first or axes
        line(axes, result, "state", name, color=colour)
        axes.set_ylabel(label(name))
        for start in starts(result):
            axes.axvline(start, color=style.GREY, linewidth=0.6, linestyle=":")
        style.tidy(axes, "best")
        axes.tick_params(labelbottom=row == 2)
    assert first is not None
    for k in np.unique(parts):
        middle = float(np.flatnonzero(parts == k).mean())
        first.text(middle, 1.04, f"step {k + 1}", transform=first.get_xaxis_transform(), ha="center", fontsize=6.5)
    axes.set_xlabel("State")
    figure.align_ylabels()
    cycle = figure.add_subplot(grid[:, 1])
    for k in np.unique(parts):
        here = parts == k
        cycle.plot(column(result, "length")[here], column(result, "force")[here], color=style.LINES[k % 7],
                   linewidth=1.2, marker=".", markersize=3.0, label=f"step {k + 1}")  # fmt: skip
    mark(cycle, result, column(result, "length"), column(result, "force"))
    cycle.set(xlabel=label("length"), ylabel=label("force"))
    style.tidy(cycle, "best")
    return figure


def chosen(result: Result, steps: Sequence[int] | None, count: int = 5) -> list[int]:
    """The states to draw: those asked for, or up to `count` spread over those that have values."""
    if steps is not None:
        return [range(len(result))[k] for k in steps]
    good = np.flatnonzero(np.isfinite(np.asarray(result.data["length"].values, float)))
    if not len(good):
        return []
    return [int(good[k]) for k in np.unique(np.linspace(0, len(good) - 1, min(count, len(good))).round().astype(int))]


def colours(count: int) -> list[Any]:
    """Colours of a sequence of states, dark to light; the faintest end of the map is left out."""
    return [colormaps[style.SEQUENCE](x) for x in np.linspace(0.0, 0.85, count)]


def state_name(result: Result, step: int) -> str:
    """Name of a state in a legend: its pressure, its length, or number, length and pressure."""
    h, P = column(result, "length")[step], column(result, "pressure")[step]
    name = driven(result)
    if name == "pressure":
        return f"{P:.3g} bar"
    return f"{h:.4g} mm" if name == "contraction" else f"state {step}: {h:.4g} mm, {P:.3g} bar"


def along(result: Result, names: Sequence[str], steps: Sequence[int] | None = None) -> Figure:
    """Fields against the axial position, one panel each, at several states."""
    figure = style.new_figure(style.COLUMN, 0.5 + 1.75 * len(names))
    panels = np.atleast_1d(figure.subplots(len(names), sharex=True))
    picked = chosen(result, steps)
    for axes, name in zip(panels, names, strict=True):
        unit, meaning = FIELDS[name]
        for k, colour in zip(picked, colours(len(picked)), strict=True):
            z = style.shown(result.data["z"].values[k], "m")
            axes.plot(z, style.shown(result.data[name].values[k], unit), color=colour, linewidth=1.2,
                      label=state_name(result, k))  # fmt: skip
        axes.set_ylabel(style.axis_label(FIELD_NAMES.get(name, meaning), unit))
        style.tidy(axes)
    panels[-1].set_xlabel(style.axis_label("axial position z", "m"))
    columns = 2 if driven(result) == "state" else 5
    style.tidy(panels[0], "lower center", fontsize=6.0, ncols=columns, handlelength=1.2, bbox_to_anchor=(0.5, 1.0),
               columnspacing=1.0)  # fmt: skip
    figure.align_ylabels()
    notes(figure, result)
    return figure


def profiles(result: Result, steps: Sequence[int] | None = None) -> Figure:
    """Radius r(z) and braid angle theta(z) at several states."""
    return along(result, ("r", "theta"), steps)


def tension(result: Result, steps: Sequence[int] | None = None) -> Figure:
    """Tension of one fibre along the muscle at several states."""
    return along(result, ("fibre_tension",), steps)


def energy(result: Result) -> Figure:
    """Stored energies, and as a check the first state's energy plus the work done since, which should be the total."""
    figure = style.new_figure(style.COLUMN, 2.9)
    axes = figure.add_subplot()
    x, name = against(result)
    for part, meaning, colour, dashes in PARTS:
        axes.plot(x, column(result, part), color=colour, linewidth=1.1, linestyle=dashes, label=meaning)
    total, work = column(result, "energy"), column(result, "work")
    axes.plot(x, total, color=style.BLACK, linewidth=1.4, label="total stored")
    if np.isfinite(total).any():
        start = total[np.flatnonzero(np.isfinite(total))[0]]
        axes.plot(x, start + work, color=style.VERMILLION, linestyle="none", marker="o", markersize=3.0,
                  markerfacecolor="none", label="first + work done since")  # fmt: skip
    mark(axes, result, x, total)
    axes.set(xlabel=name, ylabel=style.axis_label("energy", "J"))
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.4 * (high - low))
    style.tidy(axes, "upper left", fontsize=6.0, ncols=2, handlelength=1.4, columnspacing=0.8)
    notes(figure, result)
    return figure


def shares(result: Result) -> Figure:
    """Shares of the axial load F + pi r^2 P that mesh and chamber carry at mid-length."""
    figure = style.new_figure(style.COLUMN, 2.4)
    axes = figure.add_subplot()
    x, name = against(result)
    middle = int(result.data.sizes["v"]) // 2
    for part, meaning, colour in (("share_mesh", "mesh", style.BLUE), ("share_chamber", "chamber", style.ORANGE)):
        values = 100.0 * np.asarray(result.data[part].values)[:, middle]
        axes.plot(x, values, color=colour, linewidth=1.2, marker=".", markersize=3.0, label=meaning)
    axes.set(xlabel=name, ylabel="Share of F + πr²P (%)")
    style.tidy(axes, "center right")
    notes(figure, result)
    return figure
