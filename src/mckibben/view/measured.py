"""Measured points over the curve of a result, and how far the curve is from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.data.branches import LOADING, UNKNOWN, UNLOADING
from mckibben.data.compare import Comparison, axes_of, compare, matching, values_of
from mckibben.data.values import Data
from mckibben.results.result import Result
from mckibben.spec.errors import SpecError
from mckibben.view import style

__all__ = ["draw", "overlay", "say"]

MARKERS = {LOADING: "o", UNLOADING: "v", UNKNOWN: "s"}
MOST = 300
"""Points of a branch that are drawn; of more, local means. Differences are of all points."""


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
        picked = matching(result, data).decimated(MOST)
        across, what, _ = axes_of(result)
        x, y = (_shown(values_of(picked, result, of), of) for of in (across, what))
        colour = style.LINES[k % len(style.LINES)] if len(results) > 1 else style.GREEN
        draw(axes, x, y, picked.branches, colour, "measured" if len(results) == 1 else "")
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
    style.note(figure, f"{start} less measured ({data.source}): {comparison}.")


def _shown(values: np.ndarray, name: str) -> Any:
    return 100.0 * values if name == "contraction" else style.shown(values, {"pressure": "Pa", "force": "N"}[name])
