"""Friction in a map: half of what lies between its sliding branches, and how stiff crossings are that stick.

Both are Chebyshev series over length and pressure, on the axes of the potential. Outside of the range they are those of
its nearest edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mckibben.potential.evaluate import Table, across, chebyshev, edge

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LEAST", "FrictionAt", "Rubs", "rubbing", "rubbing_at", "rubs_of", "variables_of"]

LEAST = 1e-9
"""Least friction [N] and stiffness [N/m] of a map: a series may be below 0 where there is nearly none."""


class Rubs(NamedTuple):
    """The numbers of the friction in a map, SI; both series (n, m)."""

    friction: np.ndarray  #: half of what lies between the sliding branches [N]
    sticking: np.ndarray  #: what crossings that stick add to dF/dh [N/m]


class FrictionAt(NamedTuple):
    """Friction at lengths and pressures, in SI units; arrays as the points are.

    Crossings that stick pull with sqrt(sticking) e, where e^2 / 2 is the energy stored in them; at |e| = room all slip.
    """

    friction: Any  #: half of what lies between the sliding branches [N]
    sticking: Any  #: what crossings that stick add to dF/dh [N/m]
    room: Any  #: friction / sqrt(sticking) [sqrt(J)]
    room_by_length: Any  #: its slope at constant pressure [sqrt(J)/m]
    room_by_pressure: Any  #: at constant length [sqrt(J)/Pa]


At = Callable[[float, float], FrictionAt]
"""Length [m] and gauge pressure [Pa], both floats, to `FrictionAt` of floats."""


def variables_of(rubs: Rubs) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]:
    """The variables that hold them."""
    dims = ("i_friction", "j_friction")
    return {
        "friction": (dims, rubs.friction, {"units": "N", "long_name": "series of half of the force between branches"}),
        "sticking": (
            dims,
            rubs.sticking,
            {"units": "N/m", "long_name": "series of the stiffness of sticking crossings"},
        ),
    }


def rubs_of(data: xr.Dataset) -> Rubs | None:
    """The friction that a Dataset holds, if it does."""
    if "friction" not in data:
        return None
    return Rubs(*(np.asarray(data[name].values, float) for name in Rubs._fields))


def rubbing(rubs: Rubs, table: Table, length: np.ndarray, pressure: np.ndarray) -> FrictionAt:
    """Friction at points (N) each, without the slopes of the room: NaN for them."""
    y = across(table, pressure)
    h = np.clip(length, edge(table.low, y)[0], edge(table.high, y)[0])
    n, m = rubs.friction.shape
    X, Y = chebyshev((h - table.length[0]) / table.length[1], n), chebyshev(y, m)
    friction, sticking = (np.maximum((X * (one @ Y)).sum(0), LEAST) for one in rubs)
    unknown = np.full_like(friction, np.nan)
    return FrictionAt(friction, sticking, friction / np.sqrt(sticking), unknown, unknown)


def rubbing_at(rubs: Rubs, table: Table) -> At:
    """The quick way for one point, with slopes: they are 0 along what is outside of the range."""
    n, m = rubs.friction.shape
    stacked = np.concatenate(rubs)
    (h0, h1), (q0, q1) = table.length.tolist(), table.q.tolist()
    first, last, soft = float(table.first), float(table.last), float(table.soft)
    shortest, longest = float(table.low[:, 0].max()), float(table.high[:, 0].min())

    def held(length: float, y: float, y_P: float) -> tuple[float, float]:
        """A length outside of the range on its edge, and how that moves with the pressure."""
        if shortest <= length <= longest:
            return length, 0.0
        (low, low_y), (high, high_y) = (map(float, edge(knots, np.float64(y))[:2]) for knots in (table.low, table.high))
        if low <= length <= high:
            return length, 0.0
        return (low, low_y * y_P) if length < low else (high, high_y * y_P)

    def at(length: float, pressure: float) -> FrictionAt:
        P = min(max(pressure, first), last)
        q = math.sqrt(P - first + soft)
        y = (q - q0) / q1
        y_P = 0.5 / (q * q1) if pressure == P else 0.0
        h, h_P = held(length, y, y_P)
        inside = h == length
        X, Y = np.array(_polynomials((h - h0) / h1, n)), np.array(_polynomials(y, m))
        seen = (X @ (stacked @ Y.T).reshape(2, n, 2)).tolist()  # of each series: [[value, by y], [by x, both]]
        found = [_bounded(value, by_x / h1 if inside else 0.0, by_y * y_P + by_x / h1 * h_P)
                 for (value, by_y), (by_x, _) in seen]  # fmt: skip
        (friction, friction_h, friction_P), (sticking, sticking_h, sticking_P) = found
        root = math.sqrt(sticking)
        room, part = friction / root, 0.5 * friction / (root * sticking)
        return FrictionAt(friction, sticking, room, friction_h / root - part * sticking_h,
                       friction_P / root - part * sticking_P)  # fmt: skip

    return at


def _bounded(value: float, by_length: float, by_pressure: float) -> tuple[float, float, float]:
    return (value, by_length, by_pressure) if value > LEAST else (LEAST, 0.0, 0.0)


def _polynomials(x: float, n: int) -> tuple[list[float], list[float]]:
    """The first n Chebyshev polynomials at a point, and their slopes."""
    T, D = [1.0, x], [0.0, 1.0]
    for _ in range(n - 2):
        D.append(2.0 * T[-1] + 2.0 * x * D[-1] - D[-2])
        T.append(2.0 * x * T[-1] - T[-2])
    return T, D
