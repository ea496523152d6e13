"""The picture of a design: its force over the contraction with what was demanded, and the room left; or the front."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.results.design import Designed
from mckibben.spec.wishes import text_of
from mckibben.units import DISPLAY, from_si
from mckibben.view import style
from mckibben.view.words import title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["demands", "designed", "goal", "places", "room", "words"]

WIDE = 42
"""Letters of a line of a limit's name."""
FULL = 100.0
"""Room [%] beyond which a bar is cut off."""


def designed(design: Designed) -> Figure:
    """The front of a design that has one; otherwise the curves of the best, and the room in each limit."""
    return _fronted(design) if design.front is not None else _single(design)


def _single(design: Designed) -> Figure:
    limits = len(design.data["limit"])
    figure = style.new_figure(style.PAGE, max(2.8, 1.6 + 0.42 * limits))
    grid = figure.add_gridspec(1, 2, width_ratios=(1.25, 1.0))
    _curves(figure.add_subplot(grid[0, 0]), design)
    if limits:
        _room(figure.add_subplot(grid[0, 1]), design)
    style.say(figure, *words(design), design.muscle)
    return figure


def _curves(axes: Axes, design: Designed) -> None:
    """Force over contraction of the best design at each pressure, its states, and what was demanded."""
    data = design.data
    for k, pressure in enumerate(data["curve"].values.tolist()):
        colour = style.LINES[k % len(style.LINES)]
        x, y = (data[name].values[k] for name in ("curve_contraction", "curve_force"))
        axes.plot(100.0 * x, y, color=colour, linewidth=1.2, label=text_of(pressure, "Pa"))
    axes.plot(100.0 * data["contraction"].values, data["force"].values, linestyle="none", marker="o", markersize=3.2,
              color=style.BLACK, label="states asked for")  # fmt: skip
    shown = set()
    for x, y, marker, name in demands(design):
        label = None if name in shown else name
        shown.add(name)
        axes.plot([x], [y], linestyle="none", marker=marker, markersize=6.5, markerfacecolor="none",
                  markeredgewidth=1.2, color=style.VERMILLION, label=label, zorder=4)  # fmt: skip
    axes.axhline(0.0, color=style.GREY, linewidth=0.6)
    axes.set_xlabel(style.axis_label("contraction", "%"))
    axes.set_ylabel(style.axis_label("force", "N"))
    style.tidy(axes, "best")


def demands(design: Designed) -> Iterator[tuple[float, float, str, str]]:
    """Each demand that is a point: contraction [%], force [N], the marker that points to what is allowed, its name."""
    data = design.data
    for k, kind in enumerate(map(str, data["limit_kind"].values)):
        at, least = float(data["limit_at"].values[k]), float(data["limit_sign"].values[k]) < 0.0
        name = f"demanded, at {'least' if least else 'most'}"
        if kind == "force":
            yield 100.0 * float(data["limit_contraction"].values[k]), at, "^" if least else "v", name
        elif kind == "stroke":
            yield 100.0 * at, float(data["limit_force"].values[k]), ">" if least else "<", name


def room(design: Designed) -> tuple[np.ndarray, list[str]]:
    """Room left in each limit [%], below 0 where it is missed, and the colours of the bars."""
    left = -100.0 * design.data["limit_over"].values
    colours = [style.VERMILLION if one < -1e-3 else style.ORANGE if active else style.BLUE
               for one, active in zip(left, design.data["limit_active"].values.tolist(), strict=True)]  # fmt: skip
    return left, colours


def _room(axes: Axes, design: Designed) -> None:
    """How far every limit is from being reached, in per cent of it; what is missed goes to the other side."""
    left, colours = room(design)
    cut = np.clip(left, -FULL, FULL)
    places = np.arange(len(left))[::-1]
    axes.barh(places, cut, height=0.5, color=colours)
    axes.axvline(0.0, color=style.BLACK, linewidth=0.8)
    names = [textwrap.fill(str(name), WIDE) for name in design.data["limit"].values]
    axes.set_yticks(places, names)
    for place, one, end, value in zip(places, left, cut, design.limits["value"], strict=True):
        said = f" {value}" + (" (reached)" if abs(one) < 0.1 else "")
        axes.annotate(said, (max(end, 0.0), place), fontsize=style.NOTE, va="center")
    axes.set_xlim(min(-2.0, 1.15 * cut.min()), max(10.0, 1.45 * cut.max()))
    axes.set_xlabel("Room left (% of the limit)")
    style.tidy(axes)
    axes.tick_params(axis="y", labelsize=style.NOTE)
    axes.grid(False, axis="y")


def _fronted(design: Designed) -> Figure:
    """The goals of the front against each other, and what the designs are along it."""
    figure = style.new_figure(style.PAGE, 3.0)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.15, 1.0))
    _goals(figure, figure.add_subplot(grid[0, 0]), design)
    _free(figure.add_subplot(grid[0, 1]), design)
    style.say(figure, *words(design), design.muscle)
    return figure


def goal(design: Designed, k: int, values: Any) -> tuple[Any, str, str]:
    """Values of a goal in the unit that people see, the label of their axis, and which way is better."""
    unit, display = (str(design.data[f"goal_{kind}"].values[k]) for kind in ("unit", "display"))
    sense, _, measure = str(design.data["goal"].values[k]).partition(" ")
    better = "larger is better" if sense == "maximise" else "smaller is better"
    if display == "%":
        return 100.0 * values, style.axis_label(measure, "%"), better
    written = display or DISPLAY.get(unit, unit)
    return from_si(values, written), style.axis_label(measure, written), better


def _shown(design: Designed, k: int, values: Any) -> tuple[Any, str]:
    """The same, the label in lines with which way is better below it."""
    shown, label, better = goal(design, k, values)
    return shown, f"{textwrap.fill(label, 46)}\n{better}"


def _goals(figure: Figure, axes: Axes, design: Designed) -> None:
    values = design.data["front_goal"].values
    columns = [_shown(design, k, values[:, k]) for k in range(values.shape[1])]
    best = [_shown(design, k, design.data["goal_value"].values[k])[0] for k in range(values.shape[1])]
    look: dict[str, Any] = {"s": 11.0, "linewidths": 0.0}
    if len(columns) > 2:
        points = axes.scatter(columns[0][0], columns[1][0], c=columns[2][0], cmap=style.SEQUENCE, **look)
        style.colour_bar(figure, points, axes, columns[2][1].replace("\n", ", "))
    else:
        axes.scatter(columns[0][0], columns[1][0], color=style.BLUE, label="front", **look)
    axes.plot([best[0]], [best[1]], linestyle="none", marker="*", markersize=9.0, color=style.VERMILLION,
              label="nearest to the best of every goal")  # fmt: skip
    axes.set_xlabel(columns[0][1])
    axes.set_ylabel(columns[1][1])
    style.tidy(axes, "best")


def places(design: Designed) -> Iterator[tuple[str, np.ndarray, str]]:
    """Each free number along the front: its name with its range, where in it each design is [%], and a colour."""
    data = design.data
    for k, name in enumerate(design.numbers):
        values = data["front_value"].values[:, k]
        low, high = (float(data[end].values[k]) for end in ("from", "to"))
        if not np.isfinite(values).all():
            continue
        if not np.isfinite(low + high):
            low, high = float(values.min()), float(values.max())
        unit = str(data["unit"].values[k])
        ends = [text_of(end, unit, digits=3) for end in (low, high)]
        part = (values - low) / ((high - low) or 1.0)
        yield f"{name}, {ends[0]} to {ends[1]}", 100.0 * part, style.LINES[k % len(style.LINES)]


def _free(axes: Axes, design: Designed) -> None:
    """Where in its range each free number is along the front."""
    x, label = _shown(design, 0, design.data["front_goal"].values[:, 0])
    for said, part, colour in places(design):
        axes.plot(x, part, linestyle="none", marker="o", markersize=2.6, color=colour, label=said)
    axes.set_xlabel(label.partition("\n")[0] if label.count("\n") < 2 else label.rpartition("\n")[0])
    axes.set_ylabel("Place in its range (%)")
    lines = len(axes.get_lines())
    axes.set_ylim(-4.0, 106.0 + 9.0 * lines)  # the names stand above the points
    axes.set_yticks(range(0, 101, 20))
    style.tidy(axes)
    axes.legend(fontsize=style.NOTE, frameon=False, loc="upper left", handlelength=1.2, labelspacing=0.3)


def words(design: Designed) -> tuple[str, list[str]]:
    """The heading, and the notes below."""
    values = "; ".join(f"{one} {row['value']}" for one, row in design.table.iterrows())
    goals = zip(design.goals.items(), design.data["goal_unit"].values, design.data["goal_display"].values, strict=True)
    said = "; ".join(f"{name}: {text_of(value, str(unit), str(display))}" for (name, value), unit, display in goals)
    notes = [f"Best of {design.tried} designs: {values}."]
    if not design.feasible:
        notes.append("The demands cannot be met together: this design misses them least.")
    return f"{title(design.given)}, designed to {said}", notes
