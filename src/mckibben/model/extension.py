"""Full extension: the longest admissible length of an inextensible braid. The force grows without bound towards it."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from mckibben import spec
from mckibben.model.elliptic import elliprd, elliprf
from mckibben.units import Number

if TYPE_CHECKING:  # what needs no solving, such as `mckibben check`, does not import JAX
    from mckibben.model.parameters import Parameters

LONG = 25.0
"""From this T on, the long muscle's limit is exact: what it leaves out is of order T exp(-2 T)."""


def longest(muscle: spec.Muscle) -> float:
    """Longest admissible length [m] of a muscle; infinite where its fibres stretch or its fittings give way."""
    braid = muscle.braid
    if braid.fibre.stretch or muscle.gives_way:
        return math.inf
    radii = tuple(map(float, muscle.end_radii or ()))
    active = full_extension(float(braid.radius), float(braid.length), float(braid.angle), str(muscle.ends), radii)
    return active + float(muscle.rest_length - braid.length)


def longest_of(p: "Parameters", ends: str) -> float:
    """The same from a muscle's numbers."""
    if p.endless:
        return math.inf
    radii = tuple(map(float, p.end_radii or ()))
    return full_extension(float(p.R0), float(p.H0), float(p.theta0), ends, radii) + float(p.rest - p.H0)


@lru_cache(maxsize=256)
def full_extension(R0: Number, H0: Number, theta0: Number, ends: str, radii: tuple[float, ...] = ()) -> float:
    """Longest admissible length [m] of a braid of radius R0 [m], length H0 [m] and angle theta0 [rad from parallels].

    Free ends: H0/sin(theta0), the length of a fibre. Ends held at R0, or at the one or two `radii` [m], (clamped or
    pinned) keep the fibres from becoming straight. With x = cos(theta) and the fibre's arc length in units of
    R0/cos(theta0), the length is the integral of sqrt(1 - x^2 - x'^2), largest for x = cos(theta1) cosh(t)/cosh(T),
    -T < t < T, with theta1 the angle at the ends (theory page, full extension).
    """
    radius, length, angle = float(R0), float(H0), float(theta0)
    fibre = length / math.sin(angle)
    if spec.Ends(ends) is spec.Ends.FREE:
        return fibre
    unit = radius / math.cos(angle)
    half = 0.5 * fibre / unit
    if radii and min(radii) != max(radii):
        return unit * between(math.acos(min(radii) / unit), math.acos(max(radii) / unit), 2.0 * half)
    angle = math.acos(radii[0] / unit) if radii else angle
    if half > LONG + math.log(2.0):  # T = half - ln(2/(1 + sin(theta0))); cosh(T) could overflow
        return fibre - 2.0 * unit * (1.0 - math.sin(angle))
    # Each half of the fibre lies between T and T/sin(theta1); the bracket is wider because of rounding.
    lowest, highest = 0.5 * math.sin(angle) * half, 2.0 * half
    found = _root(lambda T: _halves(T, angle)[0] - half, lowest, highest)
    return 2.0 * unit * _halves(found, angle)[1]


def between(narrow: float, wide: float, fibre: float) -> float:
    """The same between fittings of two radii, at which the braid angle is `narrow` and `wide` [rad], all lengths in
    units of R0/cos(theta0). NaN where the fibre is too short to reach from one radius to the other.

    The extremal x = xm cosh(t) has its waist between the two, or beyond the narrow one, at t = T < 0 from it; shorter
    ones have none.
    """
    if fibre <= narrow - wide:
        return math.nan
    if fibre > 2.0 * (LONG + math.log(2.0)):
        return fibre - 2.0 + math.sin(narrow) + math.sin(wide)

    def waisted(T: float) -> tuple[float, float]:
        far = math.acosh(max(1.0, math.cos(wide) / math.cos(narrow) * math.cosh(T)))
        near, rest = _halves(T, narrow), _halves(far, wide)  # odd in T
        return near[0] + rest[0], near[1] + rest[1]

    if waisted(-LONG)[0] >= fibre:
        return _steep(narrow, wide, fibre)
    return waisted(_root(lambda T: waisted(T)[0] - fibre, -LONG, fibre))[1]


def _steep(narrow: float, wide: float, fibre: float) -> float:
    """The same without a waist: fibre = sqrt(1 + k) integral of d theta/sqrt(cos^2(theta) + k), k > 0, and the length
    is that of sin^2(theta)/sqrt(...), both from wide to narrow."""
    points, weights = np.polynomial.legendre.leggauss(200)
    theta = 0.5 * (narrow + wide + (narrow - wide) * points)

    def at(k: float) -> tuple[float, float]:
        rate = 0.5 * (narrow - wide) * weights / np.sqrt(np.cos(theta) ** 2 + k)
        return math.sqrt(1.0 + k) * float(rate.sum()), float(rate @ np.sin(theta) ** 2)

    high = 1.0
    while at(high)[0] > fibre and high < 1e30:
        high *= 4.0
    return at(math.exp(_root(lambda log: fibre - at(math.exp(log))[0], -60.0, math.log(high))))[1]


def _halves(T: float, angle: float) -> tuple[float, float]:
    """Half of the fibre's length and half of the muscle's, in units of R0/cos(theta0), for the extremal of a given T.

    With xm = cos(theta0)/cosh(T): sqrt(1 - xm^2) integral_0^T dt/sqrt(1 - xm^2 cosh^2 t) and
    integral_0^T sqrt(1 - xm^2 cosh^2 t) dt, as Carlson's elliptic integrals in a form free of cancellation.
    """
    sine, cosine, tanh = math.sin(angle), math.cos(angle), math.tanh(T)
    q = math.cosh(T) ** -2
    k = sine**2 + (cosine * tanh) ** 2  # 1 - xm^2
    y = sine**2 * q / k
    fibre = tanh * elliprf(q, 1.0, y)
    return fibre, math.sqrt(k) * (fibre - cosine**2 * q / (3.0 * k) * tanh**3 * elliprd(1.0, y, q))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Zero of a rising function between low and high, to rounding: false position, where one end may not stay long."""
    below, above, last = function(low), function(high), 0.0
    while True:
        middle = low - below * (high - low) / (above - below)
        if not low < middle < high:
            return min(max(middle, low), high)
        value = function(middle)
        if value == 0.0 or high - low <= 1e-15 * high:
            return middle
        stays = 0.5 if value * last > 0.0 else 1.0  # the Illinois rule
        if value < 0.0:
            low, below, above = middle, value, stays * above
        else:
            high, above, below = middle, value, stays * below
        last = value
