"""Pictures for a datasheet: the admissible region in the length-pressure plane, and force over both."""

import tomllib

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from mckibben.spec import Muscle, SpecError
from mckibben.spec.text import muscle_from_mapping
from mckibben.view import style

ENDLESS = 1.5
"""Length over the initial one up to which a region without a longest length is drawn."""


def region(limits: xr.Dataset) -> Figure:
    """The working range that `working_range` found: lengths a muscle can be held at, per pressure."""
    figure = style.new_figure(height=2.9)
    axes = figure.add_subplot()
    pressure = style.shown(limits["pressure"].values, "Pa")
    shortest, longest = (style.shown(limits[name].values, "m") for name in ("shortest", "longest"))
    muscle = muscle_of(limits)
    known, made = np.isfinite(longest), np.nan if muscle is None else style.shown(muscle.rest_length, "m")
    beyond = np.where(known, longest, ENDLESS * made)  # fibres that stretch set no limit
    label = "admissible and stable" + ("" if known.any() else ", with no longest length")
    axes.fill_betweenx(pressure, shortest, beyond, color=style.SKY, alpha=0.25, lw=0, label=label)
    axes.plot(shortest, pressure, "o-", ms=2.5, color=style.BLUE, label="shortest")
    stable = style.shown(limits["stable_down_to"].values, "m")
    if (shortest - stable > 1e-3).any():  # not where they are NaN
        axes.plot(stable, pressure, ":", color=style.BLUE, label="stable, but behind its fitting")
    if known.any():
        axes.plot(longest, pressure, "--", color=style.VERMILLION, label="full extension")
    if muscle is not None:
        axes.axvline(1e3 * muscle.rest_length, color="0.5", lw=0.8, label="initial length")
        style.assumption_note(figure, muscle)
    axes.set_xlabel(style.axis_label("length", "m"))
    axes.set_ylabel(style.axis_label("pressure", "Pa"))
    style.tidy(axes, "upper center", ncols=2, bbox_to_anchor=(0.5, 1.32))
    return figure


def force_map(forces: xr.Dataset) -> Figure:
    """Force over length and pressure; blank where there is no admissible state."""
    figure = style.new_figure(height=2.9)
    axes = figure.add_subplot()
    length, pressure = style.shown(forces["length"].values, "m"), style.shown(forces["pressure"].values, "Pa")
    force = forces["force"].values
    axes.set(xlabel=style.axis_label("length", "m"), ylabel=style.axis_label("pressure", "Pa"))
    if not np.isfinite(force).any():
        axes.text(0.5, 0.5, "no state was reached", transform=axes.transAxes, ha="center", fontsize=style.LABEL)
    elif min(force.shape) == 1:
        _line(axes, length, pressure, force)
    else:
        _contours(figure, axes, length, pressure, force)
    style.tidy(axes)
    muscle = muscle_of(forces)
    if muscle is not None:
        style.assumption_note(figure, muscle)
    return figure


def _contours(figure: Figure, axes: Axes, length: np.ndarray, pressure: np.ndarray, force: np.ndarray) -> None:
    size = float(np.nanmax(np.abs(force)))
    levels = MaxNLocator(20, symmetric=True).tick_values(-size, size)
    filled = axes.contourf(length, pressure, force, levels, cmap="RdBu_r")
    if np.nanmin(force) < 0.0 < np.nanmax(force):
        lines = axes.contour(length, pressure, force, [0.0], colors="k", linewidths=1.0)
        axes.clabel(lines, fmt="free: 0 N", fontsize=6)
    style.colour_bar(figure, filled, axes, style.axis_label("force", "N"), ticks=MaxNLocator(9, symmetric=True))


def _line(axes: Axes, length: np.ndarray, pressure: np.ndarray, force: np.ndarray) -> None:
    """A map of one pressure, or of one length: a curve."""
    x, name = (length, axes.get_xlabel()) if len(pressure) == 1 else (pressure, axes.get_ylabel())
    axes.plot(x, force.ravel(), color=style.BLUE, linewidth=1.2, marker=".", markersize=3.0)
    axes.set(xlabel=name, ylabel=style.axis_label("force", "N"))


def muscle_of(data: xr.Dataset) -> Muscle | None:
    """The muscle of a Dataset; None where a file cannot hold it (a law of the user's own)."""
    try:
        return muscle_from_mapping(tomllib.loads(data.attrs["muscle"]))
    except SpecError:
        return None
