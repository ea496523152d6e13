"""The paper's own discretisation: theta as a clamped cubic B-spline on uniform elements, 3 Gauss points each.

43 control points are 40 elements and 120 Gauss points (Sec. II.F). The uniform mesh does not resolve thin end layers;
it is here for reproduction and comparison.
"""

from functools import lru_cache
from typing import Any

import attrs
import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..lazy import jnp
from ..model.parameters import Number, Parameters
from .mesh import Form, Mesh

Floats = NDArray[np.floating[Any]]


def _state(theta: Number, y: Number, p: Parameters) -> tuple[Number, Number, Number]:
    """psi and kappa from y = (theta', theta''): Eq. (12) and its derivative; NaN at |psi| = 90 deg and beyond."""
    slope = -p.R0 * jnp.tan(p.theta0)
    sine = slope * y[0]
    return theta, jnp.arcsin(sine), slope * y[1] / jnp.sqrt(1.0 - sine**2)


FORM = Form(state=_state, rate=lambda y, p: 0.0 * y[0])


@attrs.frozen
class Spline:
    """Cubic B-splines for theta over the full length; `size` control points before the end conditions."""

    size: int = 43
    ends: str = "clamped"

    @property
    def form(self) -> Form:
        """y = (theta', theta''); nothing is integrated."""
        return FORM

    @property
    def closes(self) -> bool:
        """Both end angles are unknowns' business: no constraint is needed."""
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

    def slope_factor(self, p: Parameters) -> Number:
        """Small changes of psi over those of the first field, theta' (Eq. 12)."""
        return -p.R0 * jnp.tan(p.theta0)

    def mesh(self, p: Parameters, b: Number) -> Mesh:
        """Operators on a muscle; b is not used: the paper's mesh is uniform."""
        x, w, basis = _operators(self)
        angle, fields = jnp.asarray(basis[0]), jnp.stack([basis[1] / p.H0, basis[2] / p.H0**2], axis=1)
        none = jnp.zeros((len(x), len(x)))
        return Mesh(x * p.H0, w * p.H0, fields, angle, jnp.full(len(x), p.theta0), none)

    def nodes(self, p: Parameters, b: float, count: int | None = None) -> Floats:
        """Material coordinates v [m] of `count` uniform output points, or of the mesh's points."""
        x = _operators(self)[0] if count is None else np.linspace(0.0, 1.0, count)
        return np.asarray(x * float(p.H0))

    def profile(self, p: Parameters, b: float, u: Floats, count: int | None = None) -> tuple[Floats, Floats, Floats]:
        """(theta, psi, kappa) of solutions u (steps, m) at the nodes or the mesh points: arrays (steps, points)."""
        H0 = float(p.H0)
        value, slope, bend = (u @ part.T for part in _basis(self, self.nodes(p, b, count) / H0))
        rates = jnp.stack([jnp.asarray(slope) / H0, jnp.asarray(bend) / H0**2])
        theta, psi, kappa = _state(jnp.asarray(float(p.theta0) + value), rates, p)
        return np.asarray(theta), np.asarray(psi), np.asarray(kappa)

    def integral(self, p: Parameters, b: float, values: Floats, count: int | None = None) -> Floats:
        """Integral from v = 0 of fields given at the mesh's points (steps, points), through a cubic spline."""
        from scipy.interpolate import CubicSpline  # here, because few need what takes half a second to import

        antiderivative = CubicSpline(self.nodes(p, b), values, axis=1).antiderivative()
        return np.asarray(antiderivative(self.nodes(p, b, count)) - antiderivative(0.0))


@lru_cache(maxsize=8)
def _operators(spline: Spline) -> tuple[Floats, Floats, Floats]:
    """x in [0, 1], weights, and the free splines with first and second derivative (3, points, unknowns)."""
    elements = spline.size - 3
    xi, w = legendre.leggauss(3)
    x = ((np.arange(elements)[:, None] + (xi + 1.0) / 2.0) / elements).ravel()
    return x, np.tile(w / 2.0, elements) / elements, _basis(spline, x)


def _basis(spline: Spline, x: Floats) -> Floats:
    """Free splines and two derivatives at x in [0, 1]."""
    from scipy.interpolate import BSpline

    elements = spline.size - 3
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, elements + 1), np.ones(3)])
    every = BSpline(knots, np.eye(spline.size), 3)
    free = slice(spline.held, spline.size - spline.held)
    return np.stack([every(x, nu=order)[:, free] for order in range(3)])
