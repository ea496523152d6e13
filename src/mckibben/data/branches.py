"""Loading and unloading, told apart by the turns of what drives a test."""

from __future__ import annotations

import numpy as np

__all__ = ["LOADING", "UNKNOWN", "UNLOADING", "driven", "loading", "read_word"]

LOADING, UNLOADING, UNKNOWN = "loading", "unloading", "unknown"
_TURN = 0.02
"""A turn is one where it goes back by this part of its range: less is noise."""
_WORDS = {
    LOADING: ("loading", "load", "up", "inflation", "inflating", "filling", "fill", "extending", "forward"),
    UNLOADING: ("unloading", "unload", "down", "deflation", "deflating", "venting", "vent", "return", "back"),
}
"""What a column of branches says."""


def read_word(text: str) -> str | None:
    """The branch that a cell names, or None."""
    said = text.strip().lower()
    return next((branch for branch, words in _WORDS.items() if said in words), None)


def driven(pressure: np.ndarray, length: np.ndarray) -> np.ndarray:
    """What drives a test, rising where it is loaded: the length where the pressure is held, else the pressure."""
    held = np.ptp(pressure) <= 0.05 * np.max(np.abs(pressure), initial=0.0)
    return length if held and np.ptp(length) > 0.0 else pressure


def loading(values: np.ndarray) -> np.ndarray | None:
    """Per point whether the driven quantity (n) rises there, or None where the points come in no order.

    A point belongs to the way on which it is reached; a turning point ends its way. The first belongs to the second's.
    """
    count, threshold = len(values), _TURN * np.ptp(values)
    if threshold == 0.0:
        return np.ones(count, bool)
    rising = np.empty(count, bool)
    way, turn, begun = 0, 0, 0
    highest = lowest = 0
    turns = 0
    for k, value in enumerate(values.tolist()):
        if value > values[highest]:
            highest = k
        if value < values[lowest]:
            lowest = k
        if way == 0 and value >= values[lowest] + threshold:
            way, highest = 1, k
        elif way == 0 and value <= values[highest] - threshold:
            way, lowest = -1, k
        elif way == 1 and value <= values[highest] - threshold:
            turn, way, turns = highest, -1, turns + 1
            rising[begun : turn + 1], begun, lowest = True, turn + 1, k
        elif way == -1 and value >= values[lowest] + threshold:
            turn, way, turns = lowest, 1, turns + 1
            rising[begun : turn + 1], begun, highest = False, turn + 1, k
    rising[begun:] = way >= 0
    return None if turns > max(3, count // 4) else rising
