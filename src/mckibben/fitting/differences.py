"""Derivatives of values that a search sees, by differences, where no exact ones are to be had."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mckibben.fitting.free import Free
from mckibben.spec import SpecError

__all__ = ["by_differences"]

STEP = 1e-3
"""Half of what a number is moved by, in parts of its range; smaller where nothing is found so near."""
SMALLEST = 1e-5
"""The same at least."""

At = Callable[[np.ndarray], np.ndarray]


def by_differences(at: At, free: tuple[Free, ...], x: np.ndarray, here: np.ndarray, step: float = STEP) -> np.ndarray:
    """Derivatives (n, k) of what `at` gives (n, NaN where there is nothing) at x, where it is `here`.

    Central, or to one side at a bound and where the other side has a gap that `here` has not; of second order in both.
    """
    columns = []
    for k, one in enumerate(free):
        size = step
        while True:
            column = _difference(at, x, here, np.arange(len(x)) == k, size)
            if np.isfinite(column[np.isfinite(here)]).all():
                break
            size /= 4.0
            if size < SMALLEST:
                said = f"are beyond reach beside {one.name} = {one.text(one.value(float(x[k])))}, to both sides"
                raise SpecError("data", allowed=f"{said}: no derivative can be had", advice="narrow the ranges")
        columns.append(column)
    return np.stack(columns, axis=1)


def _difference(at: At, x: np.ndarray, here: np.ndarray, unit: np.ndarray, step: float) -> np.ndarray:
    known, place = np.isfinite(here), float(x[unit][0])
    sides = {}
    for way in (-1.0, 1.0):
        if 0.0 <= place + way * step <= 1.0:
            found = at(x + way * step * unit)
            if np.isfinite(found[known]).all():
                sides[way] = found
    if len(sides) == 2:
        return np.asarray((sides[1.0] - sides[-1.0]) / (2.0 * step))
    if not sides:
        return np.full(len(here), np.nan)
    ((way, near),) = sides.items()
    return np.asarray(way * (4.0 * near - 3.0 * here - at(x + 2.0 * way * step * unit)) / (2.0 * step))
