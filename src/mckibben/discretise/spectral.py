"""The spectral line: the slope psi as a Legendre series in a coordinate that crowds points into the end layers.

v = H0/2 (1 + tanh(b x)/tanh(b)), x in [-1, 1]. Symmetric shapes have psi odd about mid-length, so half the length and
the odd polynomials suffice; their small antisymmetric disturbances have psi even; the full line takes both.
"""

from functools import lru_cache
from typing import Any, Literal

import attrs
import numpy as np
from numpy.polynomial import legendre

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats, Form, Operators, Sampling, cosines
from mckibben.model.angle import radians
from mckibben.model.kinematics import angle_rate
from mckibben.model.parameters import Number, Parameters, functions
from mckibben.model.point import Point

__all__ = ["Line", "Modes"]

Modes = Literal["odd", "even", "all"]

FORM = Form(
    start=lambda p: radians(p.theta0),
    rate=lambda y, p: angle_rate(Point(None, *y), p),
    point=lambda x, p: Point(*x),
    orders=(0, 1),
    rated=(0,),
    angles=(True, True, False),
)
"""y = (psi, kappa); theta is integrated from theta' = rate(psi), Eq. (12)."""


@attrs.frozen
class Line:
    """A space of slopes psi: `size` modes, their symmetry about mid-length, and the ends they satisfy.

    The unknowns u are the coefficients of the modes and, where the radius of the ends is free, the change of the braid
    angle there.
    """

    size: int
    ends: str = "clamped"
    modes: Modes = "odd"

    @property
    def form(self) -> Form:
        """What the local variables mean."""
        return FORM

    @property
    def points(self) -> int:
        """Quadrature points: 1.5 m + 8 on the half line, a rule that was safe on hard cases."""
        return int(1.5 * self.size) + 8

    @property
    def half(self) -> bool:
        """Whether only half the length carries points."""
        return self.modes != "all"

    @property
    def unknowns(self) -> int:
        """Unknowns of the equilibrium: the modes, and theta at the end where the radius is free."""
        return self.size + (self.ends == "free")

    @property
    def closes(self) -> bool:
        """Whether equal end radii are a condition; odd slopes have them anyway, free ends do not need them."""
        return self.modes == "all" and self.ends != "free"

    def even(self) -> "Line":
        """The small antisymmetric disturbances of a symmetric shape, on the same points."""
        return attrs.evolve(self, modes="even")

    def operators(self) -> Operators:
        """Operators in the mapped coordinate x, which are the same for every muscle."""
        return _operators(self)

    def sampling(self, count: int) -> Sampling:
        """The space at `count` points uniform in x; of a half line on its half alone, the middle included."""
        return _sampling(self, count)

    def uniform(self, count: int) -> Floats:
        """`count` points uniform in x over the full length."""
        return np.linspace(-1.0, 1.0, count)

    def inner_integral(self) -> Floats:
        """Integral in x from the first end to each quadrature point."""
        return _operators(self).cumulate

    def harmonics(self) -> Floats:
        """From a smooth field at the quadrature points to c_k of sum c_k cos(k t), t = 0 at the last of x."""
        return _harmonics(self)

    def coordinate(self, x: Any, p: Parameters, b: Number) -> Any:
        """Material coordinate v [m] of the mapped coordinate x."""
        f = functions(x, b)
        return 0.5 * p.H0 * (1.0 + f.tanh(b * x) / f.tanh(b))

    def jacobian(self, x: Any, p: Parameters, b: Number) -> Any:
        """dv/dx [m] at x."""
        f = functions(x, b)
        return 0.5 * p.H0 * b / f.cosh(b * x) ** 2 / f.tanh(b)

    def slope_factor(self, p: Parameters) -> Number:
        """Small changes of psi over those of the first field: psi is the first field."""
        return 1.0

    def tail(self, u: Array) -> Any:
        """Largest of the last two coefficients over the largest (..., m): how well the series has converged."""
        size = abs(u[..., : self.size])
        return size[..., -2:].max(-1) / functions(u).maximum(size.max(-1), 1e-12)

    def embedded(self, other: Any, u: Floats) -> Floats:
        """Unknowns u (m) of another line, larger or smaller or half of it, as unknowns of this one."""
        found, shared = np.zeros(self.unknowns), min(self.size, other.size)
        if self.modes == other.modes:
            found[:shared] = u[:shared]
        else:  # the odd modes of all are the half line's odd ones, and so with the even ones
            place = found[: self.size][1 if other.modes == "odd" else 0 :: 2]
            shared = min(len(place), other.size)
            place[:shared] = u[:shared]
        if self.ends == "free":
            found[-1] = u[-1]
        return found


@lru_cache(maxsize=64)
def _operators(line: Line) -> Operators:
    xi, w = legendre.leggauss(line.points)
    length = 1.0 if line.half else 2.0
    x = (xi - 1.0) / 2.0 if line.half else xi
    shape, slope, lift = _at(line, x)
    copies = 2.0 if line.half else 1.0
    return Operators(x, copies * w * length / 2.0, (shape, slope), lift, cumulative(xi, w, xi) * length / 2.0)


@lru_cache(maxsize=64)
def _sampling(line: Line, count: int) -> Sampling:
    xi, w = legendre.leggauss(line.points)
    x = np.linspace(-1.0, 0.0 if line.half else 1.0, count)
    length, at = (0.5, 2.0 * x + 1.0) if line.half else (1.0, x)
    shape, slope, lift = _at(line, x)
    integral = length * cumulative(xi, w, at)
    return Sampling(x, (shape, slope), lift, integral, integral)


def _at(line: Line, x: Floats) -> tuple[Floats, Floats, Floats]:
    """psi, d psi/dx and the direct part of theta at x, by the unknowns."""
    series, spare = _modes(line), np.zeros((len(x), line.unknowns - line.size))
    shape, slope = legendre.legval(x, series).T, legendre.legval(x, legendre.legder(series)).T
    return np.hstack([shape, spare]), np.hstack([slope, spare]), np.hstack([np.zeros_like(shape), spare + 1.0])


def _modes(line: Line) -> Floats:
    """Legendre coefficients of the modes, one column each; clamped modes vanish at both ends."""
    step = 1 if line.modes == "all" else 2
    first = 1 if line.modes == "odd" else 0
    clamped = line.ends == "clamped"
    lead = 2 if clamped else 0
    series = np.zeros((first + step * (line.size - 1) + lead + 1, line.size))
    for k in range(line.size):
        n = first + step * k
        series[n + lead, k] = 1.0
        if clamped:  # P_{n+2} - P_n is zero at x = -1 and x = 1
            series[n, k] = -1.0
    return series


@lru_cache(maxsize=64)
def _harmonics(line: Line) -> Floats:
    """Barycentric interpolation at the midpoints of [0, pi]: through the Legendre series the ends lose four digits."""
    xi, w = legendre.leggauss(line.points)
    t = np.pi * (np.arange(line.points) + 0.5) / line.points
    apart = np.cos(t)[:, None] - xi
    same = np.abs(apart) < 1e-14
    share = np.where(np.arange(line.points) % 2, -1.0, 1.0) * np.sqrt((1.0 - xi**2) * w) / np.where(same, 1.0, apart)
    share = np.where(same.any(axis=1, keepdims=True), same, share)
    return cosines(t) @ (share / share.sum(axis=1, keepdims=True))


def cumulative(xi: Floats, w: Floats, at: Floats) -> Floats:
    """Matrix of the integrals from -1 to `at` of the polynomial through values at the Gauss points xi."""
    n = len(xi)
    degree = np.arange(n)
    project = (degree[:, None] + 0.5) * legendre.legvander(xi, n - 1).T * w
    below = legendre.legvander(at, n)
    # integral of P_k from -1 is (P_{k+1} - P_{k-1})/(2k + 1), and x + 1 for k = 0
    integrals = np.concatenate(
        [at[:, None] + 1.0, (below[:, 2:] - below[:, :-2])[:, : n - 1] / (2.0 * degree[1:] + 1.0)], axis=1
    )
    return np.asarray(integrals @ project)
