"""The paper's figures of results (Figs. 4 to 6), and what they leave open: textbook formulas and convergence.

Figs. 1 to 3 live in `sketches`. A measured curve is drawn only where its file is given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import jax
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from mckibben.compiled.kernel import kernel
from mckibben.model.cylinder import cylinder_angle, cylinder_force, cylinder_length
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.textbook import virtual_work_force
from mckibben.paper.measured import Measured
from mckibben.paper.sketches import MAGIC, fig1, fig2, fig3
from mckibben.results.result import Result
from mckibben.spec import Muscle
from mckibben.view import style
from mckibben.view.curves import column, label, mark
from mckibben.view.measured import draw
from mckibben.view.projection import View
from mckibben.view.shape3d import draw_muscle
from mckibben.view.tube import Tube

__all__ = ["convergence", "fig1", "fig2", "fig3", "fig4", "fig5", "fig6", "formula_force", "textbook"]

FORMULA, CYLINDER, MODEL = "Eq. (31), no stored energy", "cylinder with stored energy", "model"
FORMULAS = "Eq. (31) = Chou–Hannaford = Tondu–Lopez"
DENSITY = "(mJ per mm of initial length)"
_BLACK: dict[str, Any] = {"color": style.BLACK, "linewidth": 1.3}
_FORMULA: dict[str, Any] = {"color": style.VERMILLION, "linewidth": 1.1, "linestyle": "--"}
_CYLINDER: dict[str, Any] = {"color": style.BLUE, "linewidth": 1.1, "linestyle": "-."}


def middle_angle(result: Result, step: int = 0) -> float:
    """Braid angle [rad] at mid-length of one state; of the first, before pressurisation, as Eq. (31) takes it."""
    return float(result.data["theta"].values[step, result.data.sizes["v"] // 2])


def formula_force(result: Result) -> np.ndarray:
    """Force [N] by Eq. (31) at every state's pressure, with the mid-length angle before pressurisation."""
    return np.asarray(virtual_work_force(middle_angle(result), result.pressure, parameters(result.muscle)))


@partial(kernel, static_argnums=())
def _forces(theta: Any, pressure: Any, p: Parameters) -> Any:
    return jax.vmap(lambda a, b: cylinder_force(a, b, p))(theta, pressure)


def _cylinder(muscle: Muscle, theta: Any, pressure: Any) -> np.ndarray:
    """Force [N] of the cylinder with stored energy; angle [rad] and pressure [Pa] are broadcast to one dimension."""
    t, P = np.broadcast_arrays(np.asarray(theta, float), np.asarray(pressure, float))
    filled = [np.resize(values, 256 * -(-len(t) // 256)) for values in (t, P)]  # few shapes are compiled
    return np.asarray(_forces(*filled, parameters(muscle)))[: len(t)]


def fig4(cases: Mapping[str, Result], relaxed: Result, measured: Mapping[str, Measured] | None = None) -> Figure:
    """Fig. 4: cases a to d of the paper.

    a, b: force against pressure at constant length: the model, Eq. (31) and the cylinder with stored energy, the latter
    two with the mid-length angle before pressurisation. c, d: change of length over the length L before pressurisation.
    Each point of the curve is a muscle pressurised at L and then let go until F = 0; as that end state does not depend
    on the way to it, the curve is drawn from `relaxed`, the states of no force at each pressure. The path of the test
    itself (pressurise at L, then relax at full pressure) is dotted. By Eq. (31) it ends at the magic angle.

    Args:
        cases: results of the isometric tests "a" and "b" and of the protocols "c" and "d".
        relaxed: states with F = 0 over the pressures.
        measured: per case, points to draw beside the curves, with the model's differences from them.
    """
    figure = style.new_figure(style.PAGE, 5.0)
    panels = dict(zip("abcd", figure.subplots(2, 2).ravel(), strict=True))
    for name in "ab":
        _force_panel(panels[name], cases[name])
    for name in "cd":
        _strain_panel(panels[name], cases[name], relaxed)
    for name, axes in panels.items():
        style.panel(axes, f"{name})")
        if measured and name in measured:
            points = measured[name]
            draw(axes, style.shown(points.pressure, "Pa"), points.value, points.branches, name="measured")
            style.note(figure, f"{name}) {points.said}.")
        style.tidy(axes, "best")
    style.assumption_note(figure, cases["a"].muscle)
    return figure


def _force_panel(axes: Axes, result: Result) -> None:
    pressure = column(result, "pressure")
    axes.plot(pressure, column(result, "force"), label=MODEL, **_BLACK)
    axes.plot(pressure, formula_force(result), label=FORMULA, **_FORMULA)
    axes.plot(pressure, _cylinder(result.muscle, middle_angle(result), result.pressure), label=CYLINDER, **_CYLINDER)
    mark(axes, result, pressure, column(result, "force"))
    axes.set(xlabel=label("pressure"), ylabel=label("force"))
    axes.set_title(f"held at {column(result, 'length')[0]:.4g} mm", fontsize=style.LABEL)


def _strain_panel(axes: Axes, result: Result, relaxed: Result) -> None:
    held = int(np.flatnonzero(np.asarray(result.data["protocol_step"].values) == 0)[-1])
    L = float(result.length[held])
    p = parameters(result.muscle)
    rest = (relaxed.length - L) / L
    axes.plot(column(relaxed, "pressure"), rest, label="model, F = 0", **_BLACK)
    mark(axes, relaxed, column(relaxed, "pressure"), rest)
    path = slice(held, None)
    axes.plot(column(result, "pressure")[path], (result.length[path] - L) / L, color="0.45", linewidth=1.1,
              linestyle=":", label="path of the test")  # fmt: skip
    magic = (float(np.asarray(cylinder_length(np.radians(MAGIC), p))) - L) / L
    axes.axhline(magic, label="Eq. (31): magic angle", **_FORMULA)
    pressure, length = _free_cylinder(result.muscle, float(np.nanmax(relaxed.pressure)))
    axes.plot(style.shown(pressure, "Pa"), (length - L) / L, label=CYLINDER, **_CYLINDER)
    axes.set(xlabel=label("pressure"), ylabel="Change of length ΔL / L")
    axes.set_title(f"let go from L = {1e3 * L:.4g} mm", fontsize=style.LABEL)


def _free_cylinder(muscle: Muscle, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressures [Pa] up to `highest` and lengths [m] of the cylinder without force: F is linear in P at each angle."""
    p = parameters(muscle)
    magic, theta0 = np.radians(MAGIC), float(muscle.braid.angle)
    theta = magic + (theta0 - magic) * np.geomspace(1.0, 1e-4, 256)
    stored = _cylinder(muscle, theta, 0.0)
    pressure = stored / (stored - _cylinder(muscle, theta, 1.0))
    used = (pressure >= -1e-9) & (pressure <= highest)
    return pressure[used], np.asarray(cylinder_length(theta[used], p))


def fig5(result: Result) -> Figure:
    """Fig. 5: energy densities of mesh and chamber on the deformed shape, first and last state of case a.

    Mesh and chamber have scales of their own, logarithmic for the mesh, whose end layers stand out by far. The curves
    below compare both on one scale.
    """
    figure = style.new_figure(style.PAGE, 4.1)
    grid = figure.add_gridspec(3, 2, height_ratios=(0.75, 0.75, 1.25))
    states = ((0, "initial"), (len(result) - 1, "final"))
    parts = (("density_fibres", "mesh", style.DENSITY_MESH), ("density_chamber", "chamber", style.DENSITY_CHAMBER))
    for k, (name, part, cmap) in enumerate(parts):
        values = np.asarray(result.data[name].values)[[i for i, _ in states]]
        norm = LogNorm(float(values.min()), float(values.max())) if k == 0 else Normalize(0.0, float(values.max()))
        places = []
        for row, (i, when) in enumerate(states):
            axes = figure.add_subplot(grid[row, k])
            colours = draw_muscle(axes, Tube.of(result, i), View(), values=values[row], cmap=cmap, norm=norm)
            pressure = column(result, "pressure")[i]
            axes.set_title(f"{part}, {when}: {pressure:.3g} bar", fontsize=style.TICK, pad=2.0)
            places.append(axes)
        style.colour_bar(figure, colours, places, "Energy density\n" + DENSITY, shrink=0.9, aspect=20)
    axes = figure.add_subplot(grid[2, :])
    for i, when in states:
        z = style.shown(result.data["z"].values[i], "m")
        for (name, part, _), colour in zip(parts, (style.BLUE, style.ORANGE), strict=True):
            axes.plot(z, result.data[name].values[i], color=colour, linestyle="--" if i == 0 else "-", linewidth=1.1,
                      label=f"{part}, {when}")  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(1e-3, None)
    axes.set(xlabel=style.axis_label("axial position z", "m"), ylabel="Energy density\n" + DENSITY)
    style.tidy(axes, "upper center", ncols=4)
    style.assumption_note(figure, result.muscle)
    return figure


def fig6(stiff: Result, factor: float = 100.0) -> Figure:
    """Fig. 6: case b with fibres `factor` times stiffer: force against pressure, and the final density of the mesh."""
    figure = style.new_figure(style.COLUMN, 4.5)
    top, bottom = figure.subplots(2, 1, height_ratios=(1.0, 0.95))
    _force_panel(top, stiff)
    top.set_title(f"fibres {factor:g} times stiffer, held at {column(stiff, 'length')[0]:.4g} mm", fontsize=style.LABEL)
    style.tidy(top, "best")
    last = int(np.flatnonzero(np.isfinite(stiff.force))[-1])
    values = np.asarray(stiff.data["density_fibres"].values[last])
    norm = LogNorm(float(values.min()), float(values.max()))
    colours = draw_muscle(bottom, Tube.of(stiff, last), View(), values=values, cmap=style.DENSITY_MESH, norm=norm)
    bottom.set_title(f"mesh, {column(stiff, 'pressure')[last]:.3g} bar", fontsize=style.TICK, pad=2.0)
    name = "Energy density " + DENSITY
    style.colour_bar(figure, colours, bottom, name, orientation="horizontal", aspect=32, pad=0.05)
    style.assumption_note(figure, stiff.muscle)
    return figure


def textbook(results: Sequence[Result]) -> Figure:
    """Force against contraction at several pressures: the model, the cylinder with stored energy and the formulas.

    Eq. (31), Chou-Hannaford and Tondu-Lopez are one formula and one line. Below: what the formula misses.
    """
    figure = style.new_figure(style.COLUMN, 4.6)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1.0))
    for k, (result, colour) in enumerate(zip(results, style.LINES, strict=False)):
        muscle, p = result.muscle, parameters(result.muscle)
        theta = np.asarray(cylinder_angle(result.length, p))
        formula = np.asarray(virtual_work_force(theta, result.pressure, p))
        cylinder = _cylinder(muscle, theta, result.pressure)
        x, force = column(result, "contraction"), column(result, "force")
        rows = ((force, "-", MODEL), (cylinder, "-.", CYLINDER), (formula, ":", FORMULAS))
        for values, dashes, name in rows:
            style_of: dict[str, Any] = {"linestyle": dashes, "linewidth": 1.2}
            top.plot(x, values, color=colour, **style_of)
            if k == 0:
                top.plot([], [], color="0.2", label=name, **style_of)
            if name != FORMULAS:
                bottom.plot(x, values - formula, color=colour, **style_of)
        mark(top, result, x, force)
        top.plot([], [], color=colour, linewidth=3.0, label=f"{column(result, 'pressure')[0]:.3g} bar")
    bottom.axhline(0.0, color="0.2", linestyle=":", linewidth=1.2)
    top.set_ylabel(label("force"))
    bottom.set(xlabel=label("contraction"), ylabel="Force less\nformula (N)")
    style.tidy(bottom)
    style.tidy(top, "upper right", fontsize=6.0)
    figure.align_ylabels()
    style.assumption_note(figure, results[0].muscle)
    return figure


def convergence(curves: Mapping[str, tuple[Sequence[float], Sequence[float]]], muscle: Muscle | None = None) -> Figure:
    """Relative error of the force against size, one curve per discretisation: name to (sizes, errors)."""
    figure = style.new_figure(style.COLUMN, 2.7)
    axes = figure.add_subplot()
    for (name, (sizes, errors)), colour, marker in zip(curves.items(), style.LINES, "os^Dv<>", strict=False):
        shown = np.maximum(np.asarray(errors, float), 1e-16)
        axes.plot(sizes, shown, color=colour, marker=marker, markersize=3.5, linewidth=1.1, label=name)
    axes.set(xscale="log", yscale="log")
    axes.set(xlabel="Functions in the discretisation", ylabel="Relative error of the force")
    axes.set_xticks([5, 10, 20, 50, 100, 200], ["5", "10", "20", "50", "100", "200"])
    axes.minorticks_off()
    style.tidy(axes, "best")
    if muscle is not None:
        style.assumption_note(figure, muscle)
    return figure
