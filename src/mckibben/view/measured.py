"""Measured points over the curve of a result, and how far the curve is from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import attrs
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.data.branches import LOADING, UNKNOWN, UNLOADING
from mckibben.data.compare import Comparison, axes_of, compare, matching, values_of
from mckibben.data.values import Data
from mckibben.results.result import Result
from mckibben.spec.errors import SpecError
from mckibben.units import show
from mckibben.view import style

__all__ = ["MeasuredPoints", "draw", "overlay", "points", "said", "say"]

MARKERS = {LOADING: "o", UNLOADING: "v", UNKNOWN: "s"}
MOST = 300
"""Points of a branch that are drawn; of more, local means. Differences are of all points."""


@attrs.frozen(eq=False)
class MeasuredPoints:
    """Measured points that belong to a curve, in the units of its axes."""

    x: np.ndarray
    y: np.ndarray
    data: Data  #: the same points
    lengths: np.ndarray  #: [m]

    def branches(self) -> Iterator[tuple[str, str, np.ndarray]]:
        """Each branch that is there: its name, its marker, and which points are of it."""
        for branch, marker in MARKERS.items():
            of = self.data.branches == branch
            if of.any():
                yield branch, marker, of

    def told(self) -> list[list[tuple[str, str]]]:
        """What is known of each point: names and values for people."""
        data, made = self.data, []
        for k, (length, pressure, force) in enumerate(zip(self.lengths, data.pressure, data.force, strict=True)):
            values = (("length", length, "m"), ("pressure", pressure, "Pa"), ("force", force, "N"))
            numbers = [(name, show(float(value), unit, 5)) for name, value, unit in values]
            made.append([("test", data.tests[int(data.which[k])]), *numbers])
        return made


def points(result: Result, data: Data) -> MeasuredPoints:
    """The points at which the bench held what the test held; SpecError where there are none."""
    picked = matching(result, data).decimated(MOST)
    across, what, _ = axes_of(result)
    x, y = (_shown(values_of(picked, result, of), of) for of in (across, what))
    return MeasuredPoints(x, y, picked, values_of(picked, result, "length"))


def draw(
    axes: Axes, x: np.ndarray, y: np.ndarray, branches: np.ndarray, colour: str = style.GREEN, name: str = ""
) -> None:
    """Points in the units of the axes, each branch with a marker of its own where there are several.

    They lie below the curve, which many of them would hide.
    """
    there = [branch for branch in MARKERS if (branches == branch).any()]
    for branch in there:
        of = branches == branch
        said = f"{name}, {branch}" if name and len(there) > 1 else name
        axes.plot(x[of], y[of], linestyle="none", marker=MARKERS[branch], markersize=3.0, markerfacecolor="none",
                  markeredgewidth=0.7, color=colour, label=said or "_points", zorder=1.5)  # fmt: skip


def overlay(figure: Figure, results: Mapping[str, Result], data: Data) -> Figure:
    """Lay the points of `data` over a figure of one result (its name "") or of several, and note the differences."""
    axes, found = figure.axes[0], dict[str, Comparison]()
    trouble: SpecError | None = None
    for k, (name, result) in enumerate(results.items()):
        try:
            found[name] = compare(result, data)
        except SpecError as error:  # of a family, the bench may lack one
            trouble = error
            continue
        of = points(result, data)
        colour = style.LINES[k % len(style.LINES)] if len(results) > 1 else style.GREEN
        draw(axes, of.x, of.y, of.data.branches, colour, "measured" if len(results) == 1 else "")
    if not found:
        assert trouble is not None
        raise trouble
    if len(results) > 1:  # colours tell the curves apart, and markers the branches
        kept = np.unique(np.concatenate([matching(results[name], data).branches for name in found]))
        draw(axes, np.full(len(kept), np.nan), np.full(len(kept), np.nan), kept, style.GREY, "measured")
    elif axes.get_legend_handles_labels()[1][:1] != ["model"]:
        axes.lines[0].set_label("model")
    axes.relim()
    axes.autoscale_view()
    style.tidy(axes, "best")
    figure.set_figheight(figure.get_figheight() + 0.3 * len(found))
    for name, comparison in found.items():
        say(figure, f"{name}: model" if name else "Model", data, comparison)
    return figure


def say(figure: Figure, start: str, data: Data, comparison: Comparison) -> None:
    """Note below the figure how far a curve is from the points."""
    style.note(figure, said(start, data, comparison))


def said(start: str, data: Data, comparison: Comparison) -> str:
    """How far a curve is from the points, in a sentence."""
    return f"{start} less measured ({data.source}): {comparison}."


def _shown(values: np.ndarray, name: str) -> Any:
    return 100.0 * values if name == "contraction" else style.shown(values, {"pressure": "Pa", "force": "N"}[name])
