"""One point at a time, on plain floats: what a controller or an integrator in Python calls."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mckibben.potential.evaluate import Table, Values, evaluate

__all__ = ["scalar"]


def scalar(table: Table) -> Callable[[float, float], Values]:
    """A function of length [m] and pressure [Pa] that gives `Values` of floats, several times as fast as arrays."""
    n, m = table.series.shape[1:]
    stacked = np.ascontiguousarray(table.series[:6].reshape(6 * n, m))
    (h0, h1), (q0, q1) = table.length.tolist(), table.q.tolist()
    first, last, soft = float(table.first), float(table.last), float(table.soft)
    shortest, longest = float(table.low[:, 0].max()), float(table.high[:, 0].min())
    X, Y = [1.0] * n, [1.0] * m

    def at(length: float, pressure: float) -> Values:
        if not (first <= pressure <= last and shortest <= length <= longest):
            return _slowly(table, length, pressure)
        q = math.sqrt(pressure - first + soft)
        x, y = (length - h0) / h1, (q - q0) / q1
        X[1], Y[1] = x, y
        for k in range(2, n):
            X[k] = 2.0 * x * X[k - 1] - X[k - 2]
        for k in range(2, m):
            Y[k] = 2.0 * y * Y[k - 1] - Y[k - 2]
        W, Wh, Whh, Wq, Whq, Wqq = ((stacked @ np.array(Y)).reshape(6, n) @ np.array(X)).tolist()
        s1 = 0.5 / q
        return Values(Wh, -Wq * s1, Whh, -Whq * s1, -(Wqq - Wq / q) * s1 * s1, W, True)

    return at


def _slowly(table: Table, length: float, pressure: float) -> Values:
    found = evaluate(table, np.array([float(length)]), np.array([float(pressure)]))
    return Values(*(one.item() for one in found))
