"""Pictures for a datasheet: the admissible region in the length-pressure plane, and force over both."""

import tomllib

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from mckibben.spec.text import muscle_from_mapping
from mckibben.view import style


def region(limits: xr.Dataset) -> Figure:
    """The working range that `working_range` found: lengths a muscle can be held at, per pressure."""
    figure = style.new_figure(height=2.9)
    axes = figure.add_subplot()
    pressure = style.shown(limits["pressure"].values, "Pa")
    shortest, longest = (style.shown(limits[name].values, "m") for name in ("shortest", "longest"))
    axes.fill_betweenx(pressure, shortest, longest, color=style.SKY, alpha=0.25, lw=0, label="admissible and stable")
    axes.plot(shortest, pressure, "o-", ms=2.5, color=style.BLUE, label="shortest")
    stable = style.shown(limits["stable_down_to"].values, "m")
    if np.nanmax(shortest - stable) > 1e-3:
        axes.plot(stable, pressure, ":", color=style.BLUE, label="stable, but behind its fitting")
    axes.plot(longest, pressure, "--", color=style.VERMILLION, label="full extension")
    muscle = muscle_from_mapping(tomllib.loads(limits.attrs["muscle"]))
    axes.axvline(1e3 * muscle.braid.length, color="0.5", lw=0.8, label="initial length")
    axes.set_xlabel(style.axis_label("length", "m"))
    axes.set_ylabel(style.axis_label("pressure", "Pa"))
    style.tidy(axes, "upper center", ncols=2, bbox_to_anchor=(0.5, 1.32))
    style.assumption_note(figure, muscle)
    return figure


def force_map(forces: xr.Dataset) -> Figure:
    """Force over length and pressure; blank where there is no admissible state."""
    figure = style.new_figure(height=2.9)
    axes = figure.add_subplot()
    length, pressure = style.shown(forces["length"].values, "m"), style.shown(forces["pressure"].values, "Pa")
    force = forces["force"].values
    size = float(np.nanmax(np.abs(force)))
    levels = MaxNLocator(20, symmetric=True).tick_values(-size, size)
    filled = axes.contourf(length, pressure, force, levels, cmap="RdBu_r")
    lines = axes.contour(length, pressure, force, [0.0], colors="k", linewidths=1.0)
    axes.clabel(lines, fmt="free: 0 N", fontsize=6)
    figure.colorbar(filled, ax=axes, ticks=MaxNLocator(9, symmetric=True), label=style.axis_label("force", "N"))
    axes.set_xlabel(style.axis_label("length", "m"))
    axes.set_ylabel(style.axis_label("pressure", "Pa"))
    style.assumption_note(figure, muscle_from_mapping(tomllib.loads(forces.attrs["muscle"])))
    return figure
