"""Several tests in one table, told apart: by a column that names them, or by what each of them held."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mckibben.units import show

__all__ = ["by_label", "by_level", "levels"]

_SAME = 0.025
"""Readings of one level differ by less than this part of the largest."""
_ROUNDING = 1e-9
"""The same of levels that were set, such as those of a computed curve, which differ by rounding."""
_FEWEST = 3
"""Points of the smallest test."""
_VARIES = 0.1
"""Part of its whole range by which the other quantity varies within one test."""
_MOST = 200
"""Levels of which a quantity takes few."""


def by_label(cells: Sequence[object]) -> tuple[tuple[str, ...], np.ndarray]:
    """The names in a column, in their order, and which of them each row has."""
    said = [str(cell).strip() for cell in cells]
    names = tuple(dict.fromkeys(said))
    place = {name: k for k, name in enumerate(names)}
    return names, np.array([place[name] for name in said], int)


def levels(values: np.ndarray, nominal: bool, fewest: int = _FEWEST) -> np.ndarray | None:
    """Which level each value is of, or None where they are not a few levels that stand apart.

    Levels are what is left between gaps of the sorted values: `nominal` ones are equal, measured ones as wide as noise.
    """
    order = np.argsort(values, kind="stable")
    gaps, largest = np.diff(values[order]), np.max(np.abs(values))
    width = _SAME * largest
    which = np.empty(len(values), int)
    which[order] = np.concatenate([[0], np.cumsum(gaps > (_ROUNDING * largest if nominal else width))])
    counts = np.bincount(which)
    if len(counts) > _MOST or counts.min() < min(fewest, len(values)):
        return None
    return which if max(np.ptp(values[which == k]) for k in range(len(counts))) <= width else None


def by_level(
    pressure: np.ndarray | None, shape: np.ndarray | None, unit: str, asked: bool
) -> tuple[tuple[str, ...], np.ndarray, str] | None:
    """Tests that each held a pressure, or what was measured of the shape: names, which of them, and what was held.

    Unless it was `asked` for, what is held stays the same for several rows on end while the other varies: steps of
    pressure at which a muscle came to rest are one test. Where both take few levels, as on a grid, it is the one that
    changes more rarely from row to row.
    """
    found = []
    for what, values, other, kind in (("pressure", pressure, shape, "Pa"), ("length", shape, pressure, unit)):
        if values is None or not len(values):
            continue
        for nominal in (True, False):
            which = levels(values, nominal, 1 if asked and not nominal else _FEWEST)
            if which is not None and (asked or not which.any() or _stays(which, other)):
                found.append((np.count_nonzero(np.diff(which)), what, values, kind, which))
                break
    if not found:
        return None
    _, what, values, kind, which = min(found, key=lambda item: item[0])
    means = [float(np.median(values[which == k])) for k in range(which.max() + 1)]
    order = list(dict.fromkeys(which.tolist()))  # as they come in the table
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    names: tuple[str, ...] = ()
    for digits in range(3, 16):
        names = tuple(_name(means[k], kind, digits) for k in order)
        if len(set(names)) == len(names):
            break
    return names, place[which], what


def _stays(which: np.ndarray, other: np.ndarray | None) -> bool:
    """Whether the rows of a level come several on end, and the other quantity varies in them as it does in all."""
    if (np.count_nonzero(np.diff(which)) + 1) * _FEWEST > len(which):
        return False
    if other is None:
        return True
    within = [float(np.ptp(other[which == k])) for k in range(which.max() + 1)]
    return float(np.median(within)) >= _VARIES * float(np.ptp(other))


def _name(value: float, unit: str, digits: int) -> str:
    return f"{100.0 * value:.{digits}g} %" if unit == "1" else show(value, unit, digits)
