"""The spectral line: the slope psi as a Legendre series in a coordinate that crowds points into the end layers.

v = H0/2 (1 + tanh(b x)/tanh(b)), x in [-1, 1]. Symmetric shapes have psi odd about mid-length, so half the length and
the odd polynomials suffice; their small antisymmetric disturbances have psi even; the full line takes both.
"""

from functools import lru_cache
from typing import Any, Literal, NamedTuple

import attrs
import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..lazy import jnp
from ..model.kinematics import angle_rate
from ..model.parameters import Number, Parameters, functions
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

    def constants(self) -> "Constants":
        """Operators in the mapped coordinate x, which are the same for every muscle."""
        return _operators(self)

    def sampling(self, count: int) -> "Sampling":
        """The space at `count` points uniform in x over the full length."""
        return _sampling(self, count)

    def jacobian(self, p: Parameters, b: Number) -> Any:
        """dv/dx [m] at the mesh's points."""
        return stretch(_operators(self).x, p, b)

    def slope_factor(self, p: Parameters) -> Number:
        """Small changes of psi over those of the first field: psi is the first field."""
        return 1.0

    def mesh(self, p: Parameters, b: Number) -> Mesh:
        """Operators of the space on a muscle, with points crowded by b (0.5: nearly uniform)."""
        x, w, shape, slope, cumulate = _operators(self)
        jac = self.jacobian(p, b)
        fields = jnp.stack([jnp.asarray(shape), slope / jac[:, None]], axis=1)
        free = jnp.zeros((len(x), self.unknowns))
        if self.ends == "free":
            fields = jnp.concatenate([fields, jnp.zeros((len(x), 2, 1))], axis=2)
            free = free.at[:, -1].set(1.0)
        copies = 2.0 if self.half else 1.0
        return Mesh(coordinate(x, p, b), copies * w * jac, fields, free, jnp.full(len(x), p.theta0), cumulate * jac)

    def nodes(self, p: Parameters, b: float, count: int) -> Floats:
        """Material coordinates v [m] of `count` output points, crowded like the mesh itself."""
        return np.asarray(coordinate(_sampling(self, count).x, p, b))

    def profile(
        self, p: Parameters, b: Number, u: Any, count: int | None = None, array: Any = np.asarray
    ) -> tuple[Any, Any, Any]:
        """(theta, psi, kappa) of solutions u (steps, m) at the nodes, or at the mesh's points: arrays (steps, points).

        Symmetric spaces are mirrored onto the other half. With `array=jnp.asarray` it can be differentiated.
        """
        at, c = _sampling(self, count), array(u)[:, : self.size]
        rate = array(angle_rate(c @ _operators(self).shape.T, p))
        start = array(p.theta0) + (u[:, -1:] if self.ends == "free" else 0.0)
        theta = start + (rate * array(self.jacobian(p, b))) @ at.odd_integral.T
        return theta, c @ at.shape.T, c @ at.slope.T / array(stretch(at.x, p, b))

    def integral(self, p: Parameters, b: Number, values: Any, count: int | None = None, array: Any = np.asarray) -> Any:
        """Integral from v = 0 to the nodes (or the mesh's points) of fields given at the mesh's points (steps, points).

        On the half line a field goes on as its mirror image. With `array=jnp.asarray` it can be differentiated.
        """
        return array(values * array(self.jacobian(p, b))) @ _sampling(self, count).even_integral.T


FORM = Form(state=lambda theta, y, p: (theta, y[0], y[1]), rate=lambda y, p: angle_rate(y[0], p))


class Constants(NamedTuple):
    """A space at the points of its quadrature rule."""

    x: Floats
    weights: Floats  #: in x, over the length that carries points
    shape: Floats  #: psi by coefficients (points, modes)
    slope: Floats  #: d psi/dx by coefficients
    cumulate: Floats  #: integral in x from the first end to each point (points, points)


@lru_cache(maxsize=64)
def _operators(line: Line) -> Constants:
    xi, w = legendre.leggauss(line.points)
    length = 1.0 if line.half else 2.0
    x = (xi - 1.0) / 2.0 if line.half else xi
    series = modes(line)
    shape, slope = legendre.legval(x, series).T, legendre.legval(x, legendre.legder(series)).T
    return Constants(x, w * length / 2.0, shape, slope, cumulative(xi, w, xi) * length / 2.0)


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


class Sampling(NamedTuple):
    """A space at output points over the full length: constants, so they are made once."""

    x: Floats
    shape: Floats  #: psi by coefficients
    slope: Floats  #: d psi/dx by coefficients
    even_integral: Floats  #: integral in x from -1 of values at the mesh's points, mirrored as they are
    odd_integral: Floats  #: the same for values that change sign at mid-length


@lru_cache(maxsize=64)
def _sampling(line: Line, count: int | None) -> Sampling:
    """Sampling at `count` points uniform in x over the full length, or at the mesh's points."""
    xi, w = legendre.leggauss(line.points)
    x = _operators(line).x if count is None else np.linspace(-1.0, 1.0, count)
    folded, length = (-np.abs(x), 0.5) if line.half else (x, 1.0)
    series = modes(line)
    shape, slope = legendre.legval(folded, series).T, legendre.legval(folded, legendre.legder(series)).T
    part = length * cumulative(xi, w, 2.0 * folded + 1.0 if line.half else folded)
    if not line.half:
        return Sampling(x, shape, slope, part, part)
    beyond, whole = (x > 0.0)[:, None], length * cumulative(xi, w, np.ones(1))
    return Sampling(x, np.where(beyond, -shape, shape), slope, np.where(beyond, 2.0 * whole - part, part), part)


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


def coordinate(x: Any, p: Parameters, b: Number) -> Any:
    """Material coordinate v [m] of the mapped coordinate x."""
    f = functions(x, b)
    return 0.5 * p.H0 * (1.0 + f.tanh(b * x) / f.tanh(b))


def stretch(x: Any, p: Parameters, b: Number) -> Any:
    """dv/dx [m]."""
    f = functions(x, b)
    return 0.5 * p.H0 * b / f.cosh(b * x) ** 2 / f.tanh(b)
