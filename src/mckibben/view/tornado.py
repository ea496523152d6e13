"""The tornado chart of a `Sensitivity`: which numbers drive a result, the strongest on top."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.results.sensitivity import ANGLES, Sensitivity
from mckibben.units import show
from mckibben.view import style

ROW = 0.2
"""Height [inch] of a bar with its gap: room for a line of text."""
MARGIN = 1.15
"""Height [inch] of everything but the bars: title, axis and notes."""
LABELS = 1.7
"""Width [inch] kept for the names on the left."""
NUMBER = 0.5
"""Width [inch] kept for the number beside a bar."""
MARK = " *"
"""Put after the name of a number that is assumed."""


def tornado(sensitivity: Sensitivity) -> Figure:
    """Bars of per cent per per cent, sorted by the first result, one panel for each result.

    Assumed numbers carry a star. A number or a result that is zero has no per cents and is named below the bars.
    """
    data = sensitivity.data
    share, results = data["relative"].values, [str(name) for name in data["result"].values]
    drawn = np.isfinite(share).any(axis=0)
    rows = [k for k in sensitivity.order.tolist() if np.isfinite(share[k]).any()]
    if not rows:
        return _nothing(sensitivity)
    columns = [j for j in range(len(results)) if drawn[j]]
    width = style.PAGE if len(columns) > 1 else 5.0
    figure = style.new_figure(width, MARGIN + ROW * len(rows))
    panels = np.atleast_1d(figure.subplots(1, len(columns), sharey=True))
    for j, axes in zip(columns, panels, strict=True):
        _panel(axes, share[rows, j], (width - LABELS) / len(columns) - 0.2)
        name, unit = results[j].replace("_", " "), str(data["result_unit"].values[j])
        axes.set_title(f"{name[0].upper()}{name[1:]}: {_value(float(data['result_value'].values[j]), unit)}")
        axes.set_xlabel("% change for +1 %")
        style.tidy(axes)
        axes.title.set_fontsize(style.TICK + 0.5)
        axes.grid(False, axis="y")
        axes.tick_params(axis="y", length=0.0)
    panels[0].set_yticks(range(len(rows)), [_label(sensitivity, k) for k in rows])
    panels[0].invert_yaxis()
    _notes(figure, sensitivity, [k for k in range(len(share)) if k not in rows], np.flatnonzero(~drawn))
    return figure


def _panel(axes: Axes, shares: np.ndarray, width: float) -> None:
    """Bars from zero to both sides, each with its number outside its end, on about `width` inches."""
    largest = float(np.nanmax(np.abs(shares)))
    for row, value in enumerate(shares.tolist()):
        if np.isnan(value):
            continue
        axes.barh(row, value, height=0.7, color=style.BLUE if value >= 0.0 else style.VERMILLION)
        side = 1.0 if value >= 0.0 else -1.0
        axes.text(value + side * 0.02 * largest, row, _signed(value), va="center", fontsize=style.NOTE + 0.5,
                  ha="left" if side > 0.0 else "right")  # fmt: skip
    axes.axvline(0.0, color=style.BLACK, linewidth=0.6)
    low, high = min(0.0, float(np.nanmin(shares))), max(0.0, float(np.nanmax(shares)))
    sides = (low < 0.0) + (high > 0.0)
    room = (high - low) * NUMBER / (width - sides * NUMBER)
    axes.set_xlim(low - room if low < 0.0 else -0.03 * high, high + room if high > 0.0 else -0.03 * low)


def _signed(value: float) -> str:
    return f"{value:+.3g}".replace("-", "−") if abs(value) >= 5e-4 else "≈ 0"


def _value(value: float, unit: str) -> str:
    return show(100.0 * value, "1", 4) + " %" if unit == "1" else show(value, unit, 4)


def _label(sensitivity: Sensitivity, row: int) -> str:
    known = sensitivity.data.isel(number=row)
    mark = MARK if bool(known["number_assumed"].values) else ""
    return f"{known['number'].values} = {known['number_shown'].values}{mark}"


def _notes(figure: Figure, sensitivity: Sensitivity, left_out: list[int], without: np.ndarray) -> None:
    data = sensitivity.data
    said = f"{sensitivity.test.kind} test, state {data.attrs['state']}"
    notes = [f"{said[0].upper()}{said[1:]}; {ANGLES}."]
    if bool(data["number_assumed"].values.any()):
        notes.append("* assumed, not measured.")
    if left_out:
        names = ", ".join(str(data["number"].values[k]) for k in left_out)
        notes.append(f"No bar, being zero (see the absolute derivatives): {names}.")
    if len(without):
        zero = ", ".join(str(data["result"].values[j]) for j in without)
        notes.append(f"No per cent of a result that is zero: {zero}.")
    if sensitivity.verdict != "stable":
        notes.append(f"The state is {sensitivity.verdict}: {sensitivity.reason}.")
    style.note(figure, " ".join(notes))


def _nothing(sensitivity: Sensitivity) -> Figure:
    """A picture that says why there are no bars."""
    figure = style.new_figure(5.0, 1.2)
    said = sensitivity.reason if not sensitivity.complete else "every number or result asked for is zero"
    figure.text(0.5, 0.5, "\n".join(textwrap.wrap(f"No sensitivities: {said}", 70)), ha="center", va="center",
                fontsize=style.LABEL)  # fmt: skip
    return figure
