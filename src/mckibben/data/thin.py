"""Local means of a branch: fewer points on the same curve."""

from __future__ import annotations

import numpy as np

from mckibben.data.branches import UNKNOWN, driven

__all__ = ["ARRAYS", "Arrays", "thinned"]

ARRAYS = ("which", "branches", "rows", "pressure", "force", "shape", "rest_length", "free_length")
"""What a dataset has per point."""
_MEANT = ("pressure", "force", "shape", "rest_length", "free_length")
Arrays = dict[str, np.ndarray | None]


def thinned(arrays: Arrays, longer: np.ndarray, points: int) -> Arrays:
    """The arrays of a dataset with at most `points` for each branch of each test.

    `longer` (n) grows with the length of the muscle.
    """
    which, branches, pressure = (np.asarray(arrays[name]) for name in ("which", "branches", "pressure"))
    kept: list[dict[str, np.ndarray]] = []
    for test in range(int(which.max(initial=-1)) + 1):
        for branch in dict.fromkeys(branches[which == test].tolist()):
            chosen = np.flatnonzero((which == test) & (branches == branch))
            x = driven(pressure[chosen], longer[chosen])
            if branch == UNKNOWN:
                order = np.argsort(x, kind="stable")
                chosen, x = chosen[order], x[order]
            picked = {name: values[chosen] for name, values in arrays.items() if values is not None}
            kept.append(picked if len(chosen) <= points else _means(picked, x, points))
    joined: Arrays = {name: np.concatenate([part[name] for part in kept]) for name in kept[0]} if kept else {}
    return {name: joined.get(name, values) for name, values in arrays.items()}


def _means(arrays: dict[str, np.ndarray], x: np.ndarray, points: int) -> dict[str, np.ndarray]:
    """The first and the last point, and between them the means of the points in each of `points` - 2 parts."""
    inner, low, high = x[1:-1], x[1:-1].min(), x[1:-1].max()
    parts = points - 2
    part = np.minimum((parts * (inner - low) / (high - low or 1.0)).astype(int), parts - 1)
    if x[-1] < x[0]:
        part = parts - 1 - part
    count = np.bincount(part, minlength=parts)
    filled = count > 0
    order = np.argsort(part, kind="stable")
    middle = order[(np.cumsum(count) - (count + 1) // 2)[filled]]
    found = {}
    for name, values in arrays.items():
        within = values[1:-1]
        if name in _MEANT:
            middles = np.bincount(part, within, minlength=parts)[filled] / count[filled]
        else:
            middles = within[middle]
        found[name] = np.concatenate([values[:1], middles, values[-1:]])
    return found
