"""The spectral line: the slope psi as a Legendre series in a coordinate that crowds points into the end layers.

v = H0/2 (1 + tanh(b x)/tanh(b)), x in [-1, 1]. Symmetric shapes have psi odd about mid-length, so half the length and
the odd polynomials suffice; their small antisymmetric disturbances have psi even; the full line takes both.
"""

from functools import lru_cache
from typing import Any, Literal

import attrs
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..model.kinematics import angle_rate
from ..model.parameters import Number, Parameters
from .mesh import Form, Mesh

Modes = Literal["odd", "even", "all"]
Floats = NDArray[np.floating[Any]]


@attrs.frozen
class Line:
    """A space of slopes psi: `size` modes, their symmetry about mid-length, and the ends they satisfy."""

    size: int
    ends: str = "clamped"
    modes: Modes = "odd"

    @property
    def form(self) -> Form:
        """y = (psi, kappa); theta' = rate(psi) is integrated."""
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
        """Whether equal end radii are a constraint; odd slopes have them anyway, free ends do not need them."""
        return self.modes == "all" and self.ends != "free"

    def mesh(self, p: Parameters, b: Number) -> Mesh:
        """Operators of the space on a muscle, with points crowded by b (0.5: nearly uniform)."""
        x, w, shape, slope, cumulate = _operators(self)
        jac = _stretch(x, p, b)
        fields = jnp.stack([jnp.asarray(shape), slope / jac[:, None]], axis=1)
        free = jnp.zeros((len(x), self.unknowns))
        if self.ends == "free":
            fields = jnp.concatenate([fields, jnp.zeros((len(x), 2, 1))], axis=2)
            free = free.at[:, -1].set(1.0)
        copies = 2.0 if self.half else 1.0
        return Mesh(coordinate(x, p, b), copies * w * jac, fields, free, jnp.full(len(x), p.theta0), cumulate * jac)

    def profile(self, p: Parameters, b: float, u: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
        """(theta, psi, kappa) of solutions u (steps, m) at any v in [0, H0]: three arrays (steps, points).

        Symmetric spaces are mirrored onto the other half.
        """
        x, series, c = self._inverse(p, b, v), modes(self), np.asarray(u)[:, : self.size]
        folded = -np.abs(x) if self.half else x
        psi = c @ legendre.legval(folded, series)
        kappa = c @ legendre.legval(folded, legendre.legder(series)) / np.asarray(_stretch(folded, p, b))
        rate = np.asarray(angle_rate(c @ _operators(self)[2].T, p))
        start = float(p.theta0) + (u[:, -1:] if self.ends == "free" else 0.0)
        theta = start + self.integral(p, b, rate, v, mirror=-1.0)
        return theta, np.where(self.half & (x > 0.0), -1.0, 1.0) * psi, kappa

    def integral(self, p: Parameters, b: float, values: Floats, v: Floats, mirror: float = 1.0) -> Floats:
        """Integral from 0 to v [m] of fields given at the mesh's points (steps, points).

        On the half line a field goes on as its mirror image, times `mirror`.
        """
        xi, weights = legendre.leggauss(self.points)
        x_points = _operators(self)[0]
        x = self._inverse(p, b, v)
        at, length = (1.0 - 2.0 * np.abs(x), 0.5) if self.half else (x, 1.0)
        density = values * np.asarray(_stretch(x_points, p, b))
        part: Floats = length * density @ cumulative(xi, weights, at).T
        if not self.half:
            return part
        whole = length * density @ cumulative(xi, weights, np.ones(1)).T
        return np.asarray(np.where(x <= 0.0, part, whole + mirror * (whole - part)))

    def _inverse(self, p: Parameters, b: float, v: Floats) -> Floats:
        end = float(np.tanh(b))
        x: Floats = np.arctanh(np.clip((2.0 * v / float(p.H0) - 1.0) * end, -end, end)) / b
        return np.clip(x, -1.0, 1.0)


FORM = Form(state=lambda theta, y, p: (theta, y[0], y[1]), rate=lambda y, p: angle_rate(y[0], p))


@lru_cache(maxsize=64)
def _operators(line: Line) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """x, weights, modes, their x-derivatives and the cumulative integral in x: constants of the space."""
    xi, w = legendre.leggauss(line.points)
    length = 1.0 if line.half else 2.0
    x = (xi - 1.0) / 2.0 if line.half else xi
    series = modes(line)
    shape, slope = legendre.legval(x, series).T, legendre.legval(x, legendre.legder(series)).T
    return x, w * length / 2.0, shape, slope, cumulative(xi, w, xi) * length / 2.0


@lru_cache(maxsize=64)
def modes(line: Line) -> Floats:
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


def cumulative(xi: Floats, w: Floats, at: Floats) -> Floats:
    """Matrix of the integrals from -1 to `at` of the polynomial through values at the Gauss points xi."""
    n = len(xi)
    degree = np.arange(n)
    project = (degree[:, None] + 0.5) * legendre.legvander(xi, n - 1).T * w
    integrals: Floats = legendre.legval(at, legendre.legint(np.eye(n), lbnd=-1)).T @ project
    return integrals


def coordinate(x: Any, p: Parameters, b: Number) -> Any:
    """Material coordinate v [m] of the mapped coordinate x."""
    return 0.5 * p.H0 * (1.0 + jnp.tanh(b * x) / jnp.tanh(b))


def _stretch(x: Any, p: Parameters, b: Number) -> Any:
    """dv/dx [m]."""
    return 0.5 * p.H0 * b / jnp.cosh(b * x) ** 2 / jnp.tanh(b)
