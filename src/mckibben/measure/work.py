"""Work along a path of states: the integral of F dh + P dV through cubic splines over the states."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_X, _W = np.polynomial.legendre.leggauss(4)
POINTS, WEIGHTS = 0.5 * (_X + 1.0), 0.5 * _W
"""Gauss points and weights on [0, 1], exact to degree 7: the integrand has degree 5."""


def work(force: Floats, length: Floats, pressure: Floats, volume: Floats) -> Floats:
    """Work [J] done on the muscle from the first of n states to each, from F [N], h [m], P [Pa] and V [m^3] (n)."""
    if len(force) < 2:
        return np.zeros(len(force))
    columns = np.stack([force, length, pressure, volume], axis=1)
    (F, _, P, _), (_, h, _, V) = (np.moveaxis(part, 1, 0) for part in hermite(columns, slopes(columns), POINTS))
    return np.concatenate([[0.0], np.cumsum((F * h + P * V) @ WEIGHTS)])


def hermite(values: Floats, slope: Floats, t: Floats) -> tuple[Floats, Floats]:
    """Cubic through n equally spaced values (n, ...) with given slopes: value and derivative at t (k) in [0, 1] of each
    interval (n - 1, ..., k)."""
    y0, y1, d0, d1 = (part[..., None] for part in (values[:-1], values[1:], slope[:-1], slope[1:]))
    rise = y1 - y0
    bend, twist = 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise
    return y0 + t * (d0 + t * (bend + t * twist)), d0 + t * (2.0 * bend + 3.0 * t * twist)


def slopes(values: Floats) -> Floats:
    """Slopes at n equally spaced values (n, ...) of their cubic spline.

    Its third derivative does not jump next to the ends; a parabola for three values, a line for two. What
    `scipy.interpolate.CubicSpline` gives, without its import.
    """
    step = np.diff(values, axis=0)
    if len(values) == 2:
        return np.repeat(step, 2, axis=0)
    first, last = 0.5 * (5.0 * step[0] + step[1]), 0.5 * (step[-2] + 5.0 * step[-1])
    if len(values) == 3:
        middle = 0.5 * (step[0] + step[1])
        return np.stack([2.0 * step[0] - middle, middle, 2.0 * step[1] - middle])
    right = np.concatenate([first[None], 3.0 * (step[:-1] + step[1:]), last[None]])
    above = np.empty(len(values))  # elimination of (1, 2), (1, 4, 1) ... (2, 1), which is diagonally dominant
    above[0] = 2.0
    for k in range(1, len(values)):
        below, diagonal = (2.0, 1.0) if k == len(values) - 1 else (1.0, 4.0)
        pivot = diagonal - below * above[k - 1]
        above[k], right[k] = 1.0 / pivot, (right[k] - below * right[k - 1]) / pivot
    for k in range(len(values) - 2, -1, -1):
        right[k] -= above[k] * right[k + 1]
    return right
