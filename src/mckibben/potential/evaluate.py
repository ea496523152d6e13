"""Force, volume and their slopes from the potential of a muscle, by NumPy alone (or JAX in its place).

The potential W(h, P) is a Chebyshev series in the length h and in q = sqrt(P - first + soft). Its slopes are the force
F = dW/dh and the volume V = -dW/dP, so that these and theirs agree to the last digits. Outside of the range

    h' = edge + side * width * s(t),   t = |h - edge| / width,   ds/dt = (1 + t) exp(-t),

takes the place of the length, which goes on by no more than two widths, and a spring is added that is straight far
away: the force goes on smoothly, without falling back. Beyond the pressures it is straight in pressure. This file needs
nothing else of the package, because it is what an exported evaluator consists of.
"""

from typing import Any, NamedTuple

import numpy as np

ORDERS = ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (0, 2), (3, 0), (2, 1))
"""Derivatives of the potential by length and by q, in the order of `Table.series`."""
BLOCK = 4096
"""Points at a time: what is in between stays in the processor's cache."""


class Table(NamedTuple):
    """The numbers of a map, SI. The series have n terms in length and m in q; an edge has k knots."""

    series: Any  #: (8, n, m) of the potential [J] and its derivatives by length and by q
    length: Any  #: (2) middle and half of the lengths [m] on which the series are
    first: Any  #: lowest pressure [Pa]
    last: Any  #: highest
    soft: Any  #: added to the pressure under the root [Pa]
    q: Any  #: (2) middle and half of the values of q
    low: Any  #: (k, 2) shortest length [m] and its slope by y = (q - middle) / half, at knots even in y
    high: Any  #: (k, 2) longest length, likewise
    width: Any  #: [m] within which the length goes over
    springs: Any  #: (2, 2) force [N] and stiffness [N/m] of the springs: beyond the shortest, beyond the longest length
    radius: Any  #: (n, m) of the largest radius [m]
    least: Any  #: radius [m] below which the largest one does not go


class Values(NamedTuple):
    """What a muscle does at lengths and pressures, in SI units; arrays as the points are."""

    force: Any  #: [N] positive where the muscle pulls
    volume: Any  #: [m^3] inside the braid
    stiffness: Any  #: dF/dh [N/m] at constant pressure
    volume_by_length: Any  #: dV/dh [m^2], which is -dF/dP
    volume_by_pressure: Any  #: dV/dP [m^3/Pa] at constant length
    potential: Any  #: [J] stored energy less pressure times volume
    inside: Any  #: whether the point is in the range of the map


def chebyshev(x: Any, n: int, xp: Any = np) -> Any:
    """The first n Chebyshev polynomials at points x (N), as (n, N)."""
    if hasattr(xp, "chebyshev"):  # one that compiles faster than a long chain
        return xp.chebyshev(x, n)
    found = [xp.ones_like(x), x]
    for _ in range(n - 2):
        found.append(2.0 * x * found[-1] - found[-2])
    return xp.stack(found[:n])


def edge(knots: Any, y: Any, xp: Any = np) -> tuple[Any, Any, Any]:
    """A cubic through knots even in y from -1 to 1: its value and two derivatives by y."""
    if len(knots) == 1:
        return knots[0, 0] + 0.0 * y, 0.0 * y, 0.0 * y
    step = 2.0 / (len(knots) - 1)
    k = xp.clip(xp.floor((y + 1.0) / step), 0, len(knots) - 2).astype(int)
    t = (y + 1.0) / step - k
    f0, d0, f1, d1 = knots[k, 0], step * knots[k, 1], knots[k + 1, 0], step * knots[k + 1, 1]
    c2, c3 = 3.0 * (f1 - f0) - 2.0 * d0 - d1, 2.0 * (f0 - f1) + d0 + d1
    value = f0 + t * (d0 + t * (c2 + t * c3))
    return value, (d0 + t * (2.0 * c2 + 3.0 * t * c3)) / step, (2.0 * c2 + 6.0 * t * c3) / step**2


def spring(t: Any, width: Any, force: Any, stiffness: Any, xp: Any = np) -> tuple[Any, ...]:
    """Energy of a spring beyond an edge, and three derivatives by how far it is: straight far away, from nothing."""
    e = xp.exp(-t)
    return (
        force * width * (t - 2.0 + (2.0 + t) * e) + stiffness * width**2 * (0.5 * t**2 - 2.0 * t + 3.0 - (3.0 + t) * e),
        force * (1.0 - (1.0 + t) * e) + stiffness * width * (t - 2.0 + (2.0 + t) * e),
        force * t * e / width + stiffness * (1.0 - (1.0 + t) * e),
        (force * (1.0 - t) * e / width + stiffness * t * e) / width,
    )


def across(table: Table, pressure: Any, xp: Any = np) -> Any:
    """Where pressures lie on the axis of q, from -1 at the lowest to 1 at the highest; at an end beyond them."""
    P = xp.clip(pressure, table.first, table.last)
    return (xp.sqrt(P - table.first + table.soft) - table.q[0]) / table.q[1]


def unbounded(table: Table) -> Table:
    """The series alone, without edges in length."""
    return table._replace(low=np.array([[-np.inf, 0.0]]), high=np.array([[np.inf, 0.0]]))


def evaluate(table: Table, length: Any, pressure: Any, xp: Any = np) -> Values:
    """All that a map tells, at points (N) each; with `xp=jax.numpy` inside compiled and differentiated functions."""
    P = xp.clip(pressure, table.first, table.last)
    over = pressure - P
    q = xp.sqrt(P - table.first + table.soft)
    y = (q - table.q[0]) / table.q[1]
    q1 = 0.5 / q
    q2 = -0.5 * q1 / q**2
    (low, high), (low1, high1), (low2, high2) = zip(*(edge(one, y, xp) for one in (table.low, table.high)))  # noqa: B905
    h = xp.clip(length, low, high)
    beyond = length - h
    inside = (beyond == 0.0) & (over == 0.0)
    plain = xp is np and bool(inside.all())
    t = xp.abs(beyond) / table.width
    if not plain:
        e = xp.exp(-t)
        side = xp.where(beyond < 0.0, -1.0, 1.0)
        h = h + side * table.width * (2.0 - (2.0 + t) * e)
    x = (h - table.length[0]) / table.length[1]
    n, m = table.series.shape[1:]
    X, Y = chebyshev(x, n, xp), chebyshev(y, m, xp)
    series = table.series[:6] if plain else table.series  # the last two serve outside alone
    W, Wh, Whh, Wq, Whq, Wqq, *more = ((X * (one @ Y)).sum(0) for one in series)
    WP, WhP, WPP = Wq * q1, Whq * q1, Wqq * q1**2 + Wq * q2
    if plain:
        return Values(Wh, -WP, Whh, -WhP, -WPP, W, inside)
    below = beyond < 0.0
    Whhh, WhhP = more[0], more[1] * q1
    y1, y2 = q1 / table.q[1], q2 / table.q[1]
    e1 = xp.where(below, low1, high1) * y1
    e2 = xp.where(below, low2, high2) * y1**2 + xp.where(below, low1, high1) * y2
    # h' and its derivatives; D, E by length once and twice, p by pressure
    s1, s2, s3 = (1.0 + t) * e, -t * e, (t - 1.0) * e
    D, E = s1, side * s2 / table.width
    p, p_P = e1 * (1.0 - s1), e2 * (1.0 - s1) + side * s2 * e1**2 / table.width
    D_P, E_P = -E * e1, -s3 * e1 / table.width**2
    force, stiffness = (xp.where(below, table.springs[0, k], table.springs[1, k]) for k in range(2))
    S, S1, S2, S3 = spring(t, table.width, force, stiffness, xp)
    outside = beyond != 0.0
    p, p_P, D_P, E_P, e1, e2 = (xp.where(outside, one, 0.0) for one in (p, p_P, D_P, E_P, e1, e2))
    w = W + S
    w_P = WP + Wh * p - side * S1 * e1
    w_h = Wh * D + side * S1
    w_hP = (WhP + Whh * p) * D + Wh * D_P - S2 * e1
    w_hh = Whh * D**2 + Wh * E + S2
    w_PP = WPP + 2.0 * WhP * p + Whh * p**2 + Wh * p_P + S2 * e1**2 - side * S1 * e2
    w_hhP = (WhhP + Whhh * p) * D**2 + 2.0 * Whh * D * D_P + (WhP + Whh * p) * E + Wh * E_P - side * S3 * e1
    return Values(
        w_h + w_hP * over, -w_P, w_hh + w_hhP * over, -w_hP, xp.where(over == 0.0, -w_PP, 0.0), w + w_P * over, inside
    )


def largest_radius(table: Table, length: Any, pressure: Any, xp: Any = np) -> Any:
    """Largest radius [m] along the muscle, at points (N) each; outside of the range that of the nearest edge."""
    y = across(table, pressure, xp)
    h = xp.clip(length, edge(table.low, y, xp)[0], edge(table.high, y, xp)[0])
    n, m = table.radius.shape
    found = (chebyshev((h - table.length[0]) / table.length[1], n, xp) * (table.radius @ chebyshev(y, m, xp))).sum(0)
    return xp.maximum(found, table.least)


def in_blocks(table: Table, length: Any, pressure: Any) -> Values:
    """`evaluate` for points of any shape, some at a time."""
    length, pressure = np.broadcast_arrays(np.asarray(length, float), np.asarray(pressure, float))
    h, P = length.ravel(), pressure.ravel()
    parts = [evaluate(table, h[k : k + BLOCK], P[k : k + BLOCK]) for k in range(0, max(len(h), 1), BLOCK)]
    return Values(*(np.concatenate(some).reshape(length.shape) for some in zip(*parts)))  # noqa: B905
