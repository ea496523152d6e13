"""The potential's series by least squares, from forces, volumes and energies together; the series of the radius.

With dW = F dh - V dP every state says three things of W: its slopes F and -V, and W = energy - P V itself.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np
from numpy.polynomial import chebyshev

from mckibben.charts.sample import Samples
from mckibben.potential.evaluate import Table, across, edge, evaluate, unbounded
from mckibben.potential.table import derived

__all__ = ["Edges", "Scales", "fitted", "scales_of", "springs_of"]

SOFT = (1 / 1000, 1 / 300, 1 / 60, 1 / 10, 1.0, 10.0)
"""Pressures under the root that are tried, over the range of pressures: a soft muscle changes most near the lowest."""
SIZES = (6, 8, 10, 12, 14, 17, 20, 24, 28, 34, 40, 48)
"""Terms in length that are tried; in q half as many and two."""
FIRST = 12
"""Terms at which the pressure under the root is chosen."""
SURE = 0.3
"""Part of the tolerance by which the states may be missed that make the map."""
RANK = 1e-13
"""Singular values over the largest below which a combination of terms is left out."""
FLAT = 1e-9
"""Part of the radius within which two largest ones count as the same."""
WIDEST = (14, 9)
"""Terms of the radius at most."""
SMOOTH = 1e-4
"""Weight of the roughness of the radius where it is not known."""
ROUNDS = 4
"""How often the radius is fitted where it does not fall below the least one."""
ENDS = 129
"""Points along each edge at which the springs beyond are sized."""


@attrs.frozen(eq=False)
class Edges:
    """The range of a map: lengths over pressures."""

    first: float  #: lowest pressure [Pa]
    last: float  #: highest
    low: np.ndarray  #: (k) shortest length [m], at pressures even in the root of `soft`
    high: np.ndarray  #: (k) longest
    soft: float  #: [Pa]

    @property
    def q(self) -> tuple[float, float]:
        """Middle and half of the values of q."""
        return q_of(self.first, self.last, self.soft)

    def across(self, pressure: np.ndarray) -> np.ndarray:
        """Where pressures of the range lie on the axis of q, from -1 to 1."""
        middle, half = self.q
        return np.asarray((np.sqrt(pressure - self.first + self.soft) - middle) / half)


def q_of(first: float, last: float, soft: float) -> tuple[float, float]:
    """Middle and half of the values of q = sqrt(P - first + soft)."""
    ends = np.sqrt(soft), np.sqrt(last - first + soft)
    return float(0.5 * (ends[1] + ends[0])), float(0.5 * (ends[1] - ends[0]))


@attrs.frozen
class Scales:
    """What errors are compared with: the largest force [N], volume [m^3], potential [J] and radius [m]."""

    force: float
    volume: float
    potential: float
    radius: float


def scales_of(seen: Samples) -> Scales:
    """The largest of the states."""
    W = seen.numbers["energy"] - seen.pressure * seen.numbers["volume"]
    known = seen.numbers["force"], seen.numbers["volume"], W, seen.numbers["largest_radius"]
    force, volume, potential, radius = (float(np.nanmax(np.abs(values))) for values in known)
    return Scales(force, volume, potential, radius)


def fitted(
    seen: Samples,
    edges: Edges,
    length: tuple[float, float],
    tolerance: float,
    most: tuple[int, int],
    missed: Callable[[Table], float],
) -> Table:
    """The map through good states (points), of as few terms as the tolerance needs and at most `most`.

    `length` is middle and half of the lengths; `missed` says by how much a map misses the states, over their scales.
    """
    good = seen.take(np.flatnonzero(seen.good))
    scales = scales_of(good)
    tried = [(n, max(4, n // 2 + 2)) for n in SIZES]
    sizes = [size for size in tried if size[0] <= most[0] and size[1] <= most[1]] or [most]
    span, first = edges.last - edges.first, min(sizes, key=lambda size: abs(size[0] - FIRST))

    def missed_by(share: float) -> float:
        return missed(_table(good, edges, share * span, length, first, scales))

    # where an edge moves, its knots are even in the root that it was found by
    plain = len(edges.low) == 1
    best = min(SOFT, key=missed_by) * span if plain else edges.soft
    for size in sizes:
        made = _table(good, edges, best, length, size, scales)
        if missed(made) <= SURE * tolerance:
            break
    return made._replace(radius=_radius(good, made, size), least=_least(good))


def _table(
    good: Samples, edges: Edges, soft: float, length: tuple[float, float], size: tuple[int, int], scales: Scales
) -> Table:
    """A map with series of one size."""
    (n, m), q = size, q_of(edges.first, edges.last, soft)
    x = (good.length - length[0]) / length[1]
    root = np.sqrt(good.pressure - edges.first + soft)
    y = (root - q[0]) / q[1]
    X, Y = chebyshev.chebvander(x, n - 1), chebyshev.chebvander(y, m - 1)
    X1, Y1 = _slopes(x, n) / length[1], _slopes(y, m) * (0.5 / (root * q[1]))[:, None]
    F, V = good.numbers["force"], good.numbers["volume"]
    W = good.numbers["energy"] - good.pressure * V
    parts = ((X1, Y, F, scales.force), (X, Y1, -V, scales.volume), (X, Y, W, scales.potential))
    rows = np.concatenate([(a[:, :, None] * b[:, None, :]).reshape(len(x), -1) / s for a, b, _, s in parts])
    c = np.linalg.lstsq(rows, np.concatenate([value / s for _, _, value, s in parts]), RANK)[0].reshape(n, m)
    blank = np.zeros((1, 1))
    ends = [np.stack([one, _slopes_of(one)], axis=1) for one in (edges.low, edges.high)]
    made = Table(
        derived(c, length[1], q[1]), np.array(length), edges.first, edges.last, soft, np.array(q), ends[0], ends[1],
        0.01 * 2.0 * length[1], np.zeros((2, 2)), blank, 0.0,
    )  # fmt: skip
    return made._replace(springs=springs_of(made))


def _slopes(x: np.ndarray, n: int) -> np.ndarray:
    """Derivatives of the first n polynomials at points (N), as (N, n)."""
    return np.stack([chebyshev.chebval(x, chebyshev.chebder(np.eye(n)[k])) if k else 0.0 * x for k in range(n)], -1)


def _slopes_of(knots: np.ndarray) -> np.ndarray:
    """Slopes of a monotone cubic through values at knots even from -1 to 1."""
    if len(knots) == 1:
        return np.zeros(1)
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(np.linspace(-1.0, 1.0, len(knots)), knots).derivative()(
        np.linspace(-1.0, 1.0, len(knots))))  # fmt: skip


def springs_of(table: Table) -> np.ndarray:
    """Force and stiffness of the springs beyond both edges: enough for the force not to fall back outside."""
    y = np.linspace(-1.0, 1.0, ENDS)
    P = np.clip((table.q[0] + table.q[1] * y) ** 2 - table.soft + table.first, table.first, table.last)
    y, free = across(table, P), unbounded(table)
    found = []
    for side, knots in ((-1.0, table.low), (1.0, table.high)):
        lengths = edge(knots, y)[0][:, None] + side * table.width * np.linspace(0.0, 2.0, 9)
        values = evaluate(free, lengths.ravel(), np.repeat(P, lengths.shape[1]))
        found.append((float((side * values.force).max()), float(np.abs(values.stiffness).max())))
    return np.array(found)


def _least(good: Samples) -> float:
    """The least of the largest radii where several states have it, as where the fittings are the widest place; or 0."""
    radius = good.numbers["largest_radius"]
    least = float(radius.min())
    return least if (radius <= least * (1.0 + FLAT)).sum() > max(2, 0.005 * len(radius)) else 0.0


def _radius(good: Samples, made: Table, size: tuple[int, int]) -> np.ndarray:
    """The series of the largest radius, as smooth as can be; where it is the least one, the series may be below it."""
    n, m = min(size[0], WIDEST[0]), min(size[1], WIDEST[1])
    x = (good.length - made.length[0]) / made.length[1]
    y = across(made, good.pressure)
    X, Y = chebyshev.chebvander(x, n - 1), chebyshev.chebvander(y, m - 1)
    rows = (X[:, :, None] * Y[:, None, :]).reshape(len(x), -1)
    radius, least = good.numbers["largest_radius"], _least(good)
    rough = SMOOTH * np.diag(np.add.outer(np.arange(n) ** 2.0, 1.0 * np.arange(m) ** 2.0).ravel())
    free = radius > least * (1.0 + FLAT)
    some, c = free, np.zeros(rows.shape[1])
    for _ in range(ROUNDS):
        known = np.concatenate([radius[some], np.zeros(len(rough))])
        c = np.linalg.lstsq(np.concatenate([rows[some], rough]), known, RANK)[0]
        above = free | (rows @ c > least)
        if (above == some).all():
            break
        some = above
    return c.reshape(n, m)
