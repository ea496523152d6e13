"""The length or the pressure at which a map has a force, by bracketing: NaN where no length or pressure of it does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mckibben.potential.evaluate import Table, across, edge, in_blocks

__all__ = ["length_for", "pressure_for"]

LOOKED_AT = 65
"""Places between which a change of sign is looked for."""


def length_for(table: Table, pressure: np.ndarray, force: np.ndarray) -> np.ndarray:
    """The longest length [m] of the range at which a muscle pulls a force [N] at a pressure [Pa]."""
    P = np.clip(pressure, table.first, table.last)
    y = across(table, P)

    def residue(h: np.ndarray, P: np.ndarray, force: np.ndarray) -> np.ndarray:
        return in_blocks(table, h, P).force - force

    found = _crossing(residue, edge(table.high, y)[0], edge(table.low, y)[0], (P, force))
    return np.where(pressure == P, found, np.nan)


def pressure_for(table: Table, length: np.ndarray, force: np.ndarray) -> np.ndarray:
    """The lowest pressure [Pa] of the range at which a muscle of a length [m] pulls a force [N]."""

    def residue(P: np.ndarray, length: np.ndarray, force: np.ndarray) -> np.ndarray:
        seen = in_blocks(table, length, P)
        return np.where(seen.inside, seen.force - force, np.nan)

    first, last = (np.full(length.shape, end) for end in (table.first, table.last))
    return _crossing(residue, first, last, (length, force))


def _crossing(
    residue: Callable[..., np.ndarray], begin: np.ndarray, end: np.ndarray, given: tuple[np.ndarray, ...]
) -> np.ndarray:
    """The first root of residue(x, *given) from `begin` on to `end`, all of them arrays of points."""
    from scipy.optimize.elementwise import find_root

    shares = np.linspace(0.0, 1.0, LOOKED_AT)
    places = begin + shares.reshape(-1, *(1,) * begin.ndim) * (end - begin)
    seen = residue(places, *(np.broadcast_to(one, places.shape) for one in given))
    with np.errstate(invalid="ignore"):
        crossed = seen[:-1] * seen[1:] <= 0.0
    k = crossed.argmax(axis=0)[None]
    low, high = (np.take_along_axis(places, at, axis=0)[0] for at in (k, k + 1))
    found = np.asarray(find_root(residue, (low, high), args=given).x)
    return np.where(crossed.any(axis=0), found, np.nan)
