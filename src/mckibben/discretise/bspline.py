"""The paper's own discretisation: theta as a clamped cubic B-spline on uniform elements, 3 Gauss points each.

43 control points are 40 elements and 120 Gauss points (Sec. II.F). The uniform mesh does not resolve thin end layers;
it is here for reproduction and comparison.
"""

from functools import lru_cache
from typing import Any

import attrs
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import legendre

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats, Form, Integral, Operators, Sampling, Variables, cosines
from mckibben.model.angle import radians, tan
from mckibben.model.parameters import Number, Parameters, functions
from mckibben.model.point import Point

__all__ = ["Spline"]


def _point(x: Variables, p: Parameters, made: Any) -> Point:
    """psi and kappa from y = (theta', theta''): Eq. (12) and its derivative; NaN at |psi| = 90 deg and beyond."""
    theta, rate, bend = x
    slope = -p.R0 * tan(p.theta0)
    sine = slope * rate
    return Point(theta, jnp.arcsin(sine), slope * bend / jnp.sqrt(1.0 - sine**2))


FORM = Form(
    integrals=(Integral(start=lambda p, made: radians(p.theta0), rate=lambda x, p, made: 0.0 * x[1], by=()),),
    point=_point,
    orders=(1, 2),
    angles=(True, False, False),
)
"""y = (theta', theta''); theta itself is linear in the unknowns and nothing is integrated."""


@attrs.frozen
class Spline:
    """Cubic B-splines for theta over the full length; `size` control points before the end conditions."""

    size: int = 43
    ends: str = "clamped"

    @property
    def form(self) -> Form:
        """What the local variables mean."""
        return FORM

    @property
    def half(self) -> bool:
        """Splines are over the full length."""
        return False

    @property
    def closes(self) -> bool:
        """Equal end radii need no condition: the control points at both ends are held, or free."""
        return False

    @property
    def held(self) -> int:
        """Control points fixed at each end: clamped holds theta and theta', pinned theta."""
        return {"clamped": 2, "pinned": 1, "free": 0}[self.ends]

    @property
    def points(self) -> int:
        """Quadrature points: three per element."""
        return 3 * (self.size - 3)

    @property
    def unknowns(self) -> int:
        """Free control points."""
        return self.size - 2 * self.held

    def operators(self) -> Operators:
        """Operators in x = v/H0."""
        return _operators(self)

    def sampling(self, count: int) -> Sampling:
        """The splines at `count` uniform points."""
        return _sampling(self, count)

    def even(self) -> "Spline":
        """Splines over the full length have antisymmetric disturbances among their own."""
        return self

    def inner_integral(self) -> Floats:
        """Integral in x from 0 to each quadrature point, through a cubic spline."""
        return _integral(self, _operators(self).x)

    def uniform(self, count: int) -> Floats:
        """`count` points uniform over the full length."""
        return np.linspace(0.0, 1.0, count)

    def harmonics(self) -> Floats:
        """From a field at the quadrature points to c_k of sum c_k cos(k t), t = 0 at the last of x."""
        return _harmonics(self)

    def coordinate(self, x: Any, p: Parameters, b: Number) -> Any:
        """Material coordinate v [m] of x; b is not used: the paper's mesh is uniform."""
        return x * p.H0

    def jacobian(self, x: Any, p: Parameters, b: Number) -> Any:
        """dv/dx [m] at x."""
        return functions(x, p.H0).full(np.shape(x), 1.0) * p.H0

    def slope_factor(self, p: Parameters) -> Number:
        """Small changes of psi over those of the first field, theta' (Eq. 12)."""
        return -p.R0 * tan(p.theta0)

    def tail(self, u: Array, varied: bool = False) -> Any:
        """Largest of the last two coefficients over the largest (..., m)."""
        size = abs(u)
        return size[..., -2:].max(-1) / functions(u).maximum(size.max(-1), 1e-12)

    def embedded(self, other: Any, u: Floats) -> Floats:
        """Unknowns of the same space; splines of other sizes are not nested."""
        return np.asarray(u)


@lru_cache(maxsize=8)
def _operators(spline: Spline) -> Operators:
    """x in [0, 1], weights, and the free splines with first and second derivative."""
    elements = spline.size - 3
    xi, w = legendre.leggauss(3)
    x = ((np.arange(elements)[:, None] + (xi + 1.0) / 2.0) / elements).ravel()
    value, *rates = _basis(spline, x)
    return Operators(x, np.tile(w / 2.0, elements) / elements, tuple(rates), (value,), np.zeros((len(x), len(x))))


@lru_cache(maxsize=8)
def _sampling(spline: Spline, count: int) -> Sampling:
    """Output points."""
    x = np.linspace(0.0, 1.0, count)
    value, *rates = _basis(spline, x)
    integral = _integral(spline, x)
    return Sampling(x, tuple(rates), (value,), np.zeros_like(integral), integral)


def _integral(spline: Spline, x: Floats) -> Floats:
    """Matrix of the integrals from 0 to x of the cubic spline through values at the quadrature points."""
    from scipy.interpolate import CubicSpline  # here, because few need what takes half a second to import

    at = _operators(spline).x
    antiderivative = CubicSpline(at, np.eye(len(at))).antiderivative()
    return np.asarray(antiderivative(x) - antiderivative(0.0))


@lru_cache(maxsize=8)
def _harmonics(spline: Spline) -> Floats:
    from scipy.interpolate import CubicSpline

    at = _operators(spline).x
    t = np.pi * (np.arange(len(at)) + 0.5) / len(at)
    return cosines(t) @ CubicSpline(at, np.eye(len(at)))(0.5 * (1.0 + np.cos(t)))


def _basis(spline: Spline, x: Floats) -> Floats:
    """Free splines and two derivatives at x in [0, 1]."""
    from scipy.interpolate import BSpline

    elements = spline.size - 3
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, elements + 1), np.ones(3)])
    every = BSpline(knots, np.eye(spline.size), 3)
    free = slice(spline.held, spline.size - spline.held)
    return np.stack([every(x, nu=order)[:, free] for order in range(3)])
