"""The picture of a frequency response: gain and phase over frequency."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from mckibben.results.answers import Bode
from mckibben.units import DISPLAY, from_si
from mckibben.view import style

__all__ = ["answered"]

UNITS = {"length": "m", "angle": "rad", "speed": "m/s", "pressure": "Pa", "force": "N"}
"""SI units of what answers."""


def answered(bode: Bode) -> Figure:
    """Gain and phase over frequency, with the natural frequency where there is one."""
    figure = style.new_figure(style.COLUMN, 3.6)
    gain, phase = figure.subplots(2, 1, sharex=True, height_ratios=(1.4, 1.0))
    shown = UNITS[bode.of]
    top = DISPLAY.get(shown, shown)
    below = "1" if bode.by == "command" else ("N m" if "angle" in bode.at else "N")
    unit = top if below == "1" else f"{top}/{below}" if " " not in below else f"{top}/({below})"
    gain.loglog(bode.frequency, from_si(bode.gain, top), color=style.BLUE, linewidth=1.2)
    gain.set_ylabel(f"{bode.of.capitalize()} by {bode.by} ({unit})")
    phase.semilogx(bode.frequency, np.degrees(bode.phase), color=style.BLUE, linewidth=1.2)
    phase.set_ylabel("Phase (deg)")
    phase.set_xlabel("Frequency (Hz)")
    natural = bode.natural_frequency
    if bode.frequency.min() < natural < bode.frequency.max():
        for axes in (gain, phase):
            axes.axvline(natural, color=style.GREY, linewidth=0.7, linestyle="--")
        told = f"{natural:.3g} Hz,\ndamping ratio {bode.damping:.2g}"
        gain.annotate(told, (natural, 0.03), xycoords=("data", "axes fraction"), xytext=(-4, 0), ha="right",
                      textcoords="offset points", fontsize=style.NOTE + 1.0, color=style.GREY)  # fmt: skip
    for axes in (gain, phase):
        style.tidy(axes)
        axes.grid(True, which="minor", color="0.95", linewidth=0.4)
    style.note(figure, "By equations made linear about the equilibrium with closed valves.")
    return figure
