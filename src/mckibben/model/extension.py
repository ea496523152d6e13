"""Full extension: the longest admissible length of an inextensible braid. The force grows without bound towards it."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

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
    active = full_extension(float(braid.radius), float(braid.length), float(braid.angle), str(muscle.ends))
    return active + float(muscle.rest_length - braid.length)


def longest_of(p: "Parameters", ends: str) -> float:
    """The same from a muscle's numbers."""
    if p.endless:
        return math.inf
    return full_extension(float(p.R0), float(p.H0), float(p.theta0), ends) + float(p.rest - p.H0)


@lru_cache(maxsize=256)
def full_extension(R0: Number, H0: Number, theta0: Number, ends: str) -> float:
    """Longest admissible length [m] of a braid of radius R0 [m], length H0 [m] and angle theta0 [rad from parallels].

    Free ends: H0/sin(theta0), the length of a fibre. Ends held at R0 (clamped or pinned) keep the fibres from becoming
    straight. With x = cos(theta) and the fibre's arc length in units of R0/cos(theta0), the length is the integral of
    sqrt(1 - x^2 - x'^2), largest for x = cos(theta0) cosh(t)/cosh(T), -T < t < T (theory page, full extension).
    """
    radius, length, angle = float(R0), float(H0), float(theta0)
    fibre = length / math.sin(angle)
    if spec.Ends(ends) is spec.Ends.FREE:
        return fibre
    unit = radius / math.cos(angle)
    half = 0.5 * fibre / unit
    if half > LONG + math.log(2.0):  # T = half - ln(2/(1 + sin(theta0))); cosh(T) could overflow
        return fibre - 2.0 * unit * (1.0 - math.sin(angle))
    # Each half of the fibre lies between T and T/sin(theta0); the bracket is wider because of rounding.
    lowest, highest = 0.5 * math.sin(angle) * half, 2.0 * half
    found = _root(lambda T: _halves(T, angle)[0] - half, lowest, highest)
    return 2.0 * unit * _halves(found, angle)[1]


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
