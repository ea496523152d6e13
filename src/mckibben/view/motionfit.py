"""The picture of a fit of a motion: measured values over those of the rig, and what is left, over time."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from mckibben.results.motionfit import MOMENTS, MotionFit
from mckibben.view import style

__all__ = ["followed"]

TALL = 2.0
"""Height [inch] of the panels of one quantity."""
UNITS = {"length": "m", "pressure": "Pa", "force": "N", "angle": "rad"}


def followed(fit: MotionFit) -> Figure:
    """A row for each quantity: over time what was measured and the fitted rig; and the rig less what was measured.

    The band beside the residuals is two standard deviations of a measured value.
    """
    names = fit.quantities
    figure = style.new_figure(style.PAGE, TALL * len(names) + 0.6)
    panels = figure.subplots(len(names), 2, sharex=True, squeeze=False)
    for (left, right), name in zip(panels, names, strict=True):
        chosen = fit.data["quantity"].values == name
        time, measured, predicted, size = (fit.data[one].values[chosen] for one in MOMENTS)
        unit = UNITS[name]
        left.plot(time, style.shown(measured, unit), ".", color=style.GREY, markersize=4.0, label="measured")
        left.plot(time, style.shown(predicted, unit), color=style.BLUE, linewidth=1.2, label="fitted rig")
        left.set_ylabel(style.axis_label(name, unit))
        band = style.shown(2.0 * size, unit)
        right.axhspan(-float(np.max(band)), float(np.max(band)), color=style.GREY, alpha=0.15, linewidth=0.0)
        right.plot(time, style.shown(predicted - measured, unit), ".", color=style.BLUE, markersize=4.0)
        right.set_ylabel(style.axis_label("rig less measured", unit))
    for axes in panels[-1]:
        axes.set_xlabel("Time (s)")
    for axes in panels.ravel():
        style.tidy(axes, legend="best" if axes is panels[0, 0] else None)
    for axes, letter in zip(panels.ravel(), "abcdefgh", strict=False):
        style.panel(axes, letter)
    said = ", ".join(f"{name} {row['value']}" for name, row in fit.table.iterrows())
    style.heading(figure, f"Fit of a motion to {fit.data.attrs['source']}: {said}")
    style.note(figure, " ".join(f"{line[0].upper()}{line[1:]}." for line in fit.notes))
    return figure
