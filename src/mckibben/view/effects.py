"""The bar chart of `Effects`: what changes by how much, the largest on top."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from mckibben.results.effects import Effects
from mckibben.units import show
from mckibben.view import style

__all__ = ["bars"]

SHOWN = {
    "force": ("force", style.BLUE),
    "middle_radius": ("radius at mid-length", style.ORANGE),
    "peak_fibre_tension": ("fibre tension", style.GREEN),
}
"""Quantities of the chart: label and colour."""
ROW = 0.55
"""Height [inch] of an effect with its bars."""
BAR = 0.26
"""Height of a bar over that of a row."""
ROUNDING = 1e-6
"""Change in per cent below which there is none."""


def bars(effects: Effects) -> Figure:
    """Change in per cent of force, radius and tension by each effect; what has no numbers is named below."""
    table = effects.table
    known = table[np.isfinite(table["force [%]"])]
    figure = style.new_figure(5.6, 1.3 + ROW * max(len(known), 1))
    axes = figure.subplots()
    assumed = dict(zip(effects.data["effect"].values.tolist(), effects.data["assumed"].values.tolist(), strict=True))
    largest = 1e-3
    for k, (name, (label, colour)) in enumerate(SHOWN.items()):
        values = known[f"{name} [%]"].to_numpy()
        largest = max(largest, float(np.nanmax(np.abs(values), initial=0.0)))
        axes.barh(np.arange(len(known)) + (k - 1) * BAR, values, height=0.9 * BAR, color=colour, label=label)
    for row, value in enumerate(known["force [%]"].tolist()):
        side = 1.0 if value >= 0.0 else -1.0
        said = "0 %" if abs(value) < ROUNDING else f"{value:+.2g} %".replace("-", "−")
        axes.text(value + side * 0.02 * largest, row - BAR, said, va="center", fontsize=style.NOTE + 0.5,
                  ha="left" if side > 0.0 else "right")  # fmt: skip
    axes.axvline(0.0, color=style.BLACK, linewidth=0.6)
    axes.set_yticks(range(len(known)), [f"{name}{' *' if assumed[name] else ''}" for name in known.index])
    axes.invert_yaxis()
    axes.margins(x=0.15)
    axes.set_xlabel("Change by the effect (%)")
    at = f"{show(effects.length, 'm')}, {show(effects.pressure, 'Pa')}"
    axes.set_title(f"Effects at {at}; muscle {effects.muscle.name or 'without a name'}")
    style.tidy(axes)
    axes.grid(False, axis="y")
    axes.legend(fontsize=style.TICK, loc="best")
    notes = ["* with an assumed number: see the switch."] if any(assumed[name] for name in known.index) else []
    lost = [name for name in table.index if name not in known.index]
    notes += [f"No numbers: {', '.join(lost)}."] if lost else []
    style.note(figure, " ".join(notes))
    return figure
