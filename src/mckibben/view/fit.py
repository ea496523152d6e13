"""The picture of a fit: measured points over the forces of the fitted muscle, and what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps

from mckibben.results.fit import Fitted
from mckibben.spec.errors import SpecError
from mckibben.view import style
from mckibben.view.measured import MARKERS
from mckibben.view.words import title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["colours_of", "columns", "drivers", "fitted", "label", "of_test", "words"]

FEW = len(style.LINES)
"""Tests that have a colour of their own; more take theirs from a sequence."""
MOST_NAMES = 24
"""Names in the legend."""
WIDEST_NAME = 26
"""Letters of a name."""
LEVEL = 0.02
"""Part of its size by which a quantity may vary within a test that holds it."""
UPRIGHT = 36
"""Letters of all names together that fit below the strips side by side."""
JITTER = 0.22
"""Half of the width over which the points of a strip lie beside each other."""


def fitted(fit: Fitted) -> Figure:
    """Forces over contraction or pressure, whichever the tests vary; the residuals over it, and by the other one."""
    if not len(fit.residuals):
        raise SpecError("plot", allowed="the fit has no points")
    shown, colours = columns(fit), colours_of(fit)
    driver, other = drivers(fit)
    figure = style.new_figure(style.PAGE, 5.2)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.35, 1.0))
    forces, residuals = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, 0])
    strips = figure.add_subplot(grid[1, 1], sharey=residuals)
    _forces(forces, fit, shown, driver, colours)
    _residuals(residuals, fit, shown, driver, colours)
    if _few_levels(fit, shown[other]):
        _strips(strips, fit, colours)
    else:
        _residuals(strips, fit, shown, other, colours)
    _legend(figure, fit, colours)
    for axes, letter in ((forces, "a"), (residuals, "b"), (strips, "c")):
        style.panel(axes, letter)
    style.say(figure, *words(fit), fit.muscle)
    return figure


def columns(fit: Fitted) -> dict[str, Any]:
    """What is drawn, in the units that people see."""
    data = fit.data
    return {
        "contraction": 100.0 * (1.0 - data["length"].values / fit.rest_lengths),
        "pressure": style.shown(data["pressure"].values, "Pa"),
        "force": data["force"].values, "predicted": data["predicted"].values, "residual": fit.residuals,
    }  # fmt: skip


def of_test(fit: Fitted, name: str) -> np.ndarray:
    return np.flatnonzero(fit.data["test"].values == name)


def _varies_pressure(fit: Fitted) -> bool:
    """Whether within a test the pressure varies more than the length, each as a part of its size."""
    parts = {name: np.asarray(fit.data[name].values) for name in ("pressure", "length")}
    spans = {name: 0.0 for name in parts}
    for test in dict.fromkeys(fit.data["test"].values.tolist()):
        for name, values in parts.items():
            some = values[of_test(fit, test)]
            spans[name] += float(np.ptp(some)) / max(float(np.abs(some).max()), 1e-12)
    return spans["pressure"] > spans["length"]


def drivers(fit: Fitted) -> tuple[str, str]:
    """What the tests vary, pressure or contraction, and the other one."""
    return ("pressure", "contraction") if _varies_pressure(fit) else ("contraction", "pressure")


def colours_of(fit: Fitted) -> dict[str, Any]:
    """The tests with their colours."""
    tests = [str(name) for name in dict.fromkeys(fit.data["test"].values.tolist())]
    return dict(zip(tests, _colours(len(tests)), strict=True))


def _few_levels(fit: Fitted, values: np.ndarray) -> bool:
    """Whether every test holds this quantity."""
    slack = LEVEL * float(np.abs(values).max())
    return all(np.ptp(values[of_test(fit, test)]) <= slack for test in set(fit.data["test"].values.tolist()))


def _colours(count: int) -> list[Any]:
    if count <= FEW:
        return list(style.LINES[:count])
    return [tuple(colour) for colour in colormaps[style.SEQUENCE](np.linspace(0.0, 0.92, count))]


def label(name: str) -> str:
    return style.axis_label(*{"contraction": (name, "%"), "pressure": (name, "Pa")}.get(name, (name, "N")))


def _points(axes: Axes, fit: Fitted, rows: np.ndarray, x: np.ndarray, y: np.ndarray, colour: Any) -> None:
    """Points with the markers of their branches."""
    branches = fit.data["branch"].values[rows]
    for branch, marker in MARKERS.items():
        of = branches == branch
        axes.plot(x[of], y[of], linestyle="none", marker=marker, markersize=2.8, markerfacecolor="none",
                  markeredgewidth=0.7, color=colour)  # fmt: skip


def _forces(axes: Axes, fit: Fitted, shown: dict[str, Any], driver: str, colours: dict[str, Any]) -> None:
    for test, colour in colours.items():
        rows = of_test(fit, test)
        _points(axes, fit, rows, shown[driver][rows], shown["force"][rows], colour)
        branches = fit.data["branch"].values[rows]
        for branch in dict.fromkeys(branches.tolist()):
            some = rows[branches == branch]
            some = some[np.argsort(shown[driver][some], kind="stable")]
            axes.plot(shown[driver][some], shown["predicted"][some], color=colour, linewidth=1.0)
    axes.set_xlabel(label(driver))
    axes.set_ylabel(label("force"))
    style.tidy(axes)


def _residuals(axes: Axes, fit: Fitted, shown: dict[str, Any], across: str, colours: dict[str, Any]) -> None:
    for test, colour in colours.items():
        rows = of_test(fit, test)
        _points(axes, fit, rows, shown[across][rows], shown["residual"][rows], colour)
    axes.axhline(0.0, color=style.GREY, linewidth=0.6)
    axes.set_xlabel(label(across))
    axes.set_ylabel("Model less measured (N)")
    style.tidy(axes)


def _strips(axes: Axes, fit: Fitted, colours: dict[str, Any]) -> None:
    """Residuals test by test, beside each other in the order of the points, with the mean of each."""
    for k, (test, colour) in enumerate(colours.items()):
        rows = of_test(fit, test)
        residuals = fit.residuals[rows]
        x = k + (np.linspace(-JITTER, JITTER, len(rows)) if len(rows) > 1 else np.zeros(1))
        _points(axes, fit, rows, x, residuals, colour)
        axes.plot([k - 0.35, k + 0.35], [residuals.mean()] * 2, color=style.BLACK, linewidth=1.2)
    axes.axhline(0.0, color=style.GREY, linewidth=0.6)
    names = [_short(test) for test in colours]
    axes.set_xlim(-0.6, len(names) - 0.4)
    upright = sum(map(len, names)) <= UPRIGHT
    axes.set_xticks(range(len(names)), names, rotation=0.0 if upright else 90.0)
    axes.set_xlabel("Test (line: its mean)")
    axes.set_ylabel("Model less measured (N)")
    style.tidy(axes)
    axes.tick_params(axis="x", labelsize=style.TICK if len(names) <= 12 else style.NOTE)
    axes.grid(False, axis="x")


def _short(name: str) -> str:
    return name if len(name) <= WIDEST_NAME else f"{name[: WIDEST_NAME - 1]}…"


def _legend(figure: Figure, fit: Fitted, colours: dict[str, Any]) -> None:
    """Tests by their colours, and what line and markers stand for, beside the panels."""
    from matplotlib.lines import Line2D

    branches = [branch for branch in MARKERS if (fit.data["branch"].values == branch).any()]
    handles = [Line2D([], [], color=style.GREY, linewidth=1.0, label="model")]
    for branch in branches:
        said = "measured" if len(branches) == 1 else f"measured, {branch}"
        handles.append(Line2D([], [], color=style.GREY, linestyle="none", marker=MARKERS[branch], markersize=2.8,
                              markerfacecolor="none", markeredgewidth=0.7, label=said))  # fmt: skip
    names = list(colours)
    every = -(-len(names) // MOST_NAMES)
    for name in [*names[::every], *([names[-1]] if (len(names) - 1) % every else [])]:
        handles.append(Line2D([], [], color=colours[name], linewidth=2.0, label=_short(name)))
    figure.legend(handles=handles, loc="outside right center", fontsize=style.TICK - 0.5, frameon=False,
                  handlelength=1.6)  # fmt: skip


def words(fit: Fitted) -> tuple[str, list[str]]:
    """The heading, and the notes below."""
    tests = len(set(fit.data["test"].values.tolist()))
    name = f"{len(fit.muscles)} muscles" if fit.further else title(fit.muscle)
    many = f"{len(fit.residuals)} points of {tests} test{'s' if tests != 1 else ''}"
    share = fit.share(fit.largest)
    worst = f"{fit.largest:.3g} N" + ("" if np.isnan(share) else f" ({share:.2g} %)")
    notes = [f"Measured: {fit.data.attrs['source']}."]
    found = [f"{name} {_with_error(row['value'], row['error'])}"
             for name, row in fit.table.iterrows() if name not in fit.undetermined]  # fmt: skip
    if found:
        notes.append(f"Fitted (± standard error): {'; '.join(found)}.")
    if fit.undetermined:
        notes.append(f"Not determined by these data: {', '.join(fit.undetermined)}.")
    if not fit.converged:
        notes.append("The search was ended before it had settled.")
    return f"{name}, {many}: {fit.goodness}, largest difference {worst}", notes


def _with_error(value: str, error: str) -> str:
    number, _, unit = value.partition(" ")
    return f"{number} ± {error} {unit}".rstrip() if error else value
