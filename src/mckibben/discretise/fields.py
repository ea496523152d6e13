"""From fields over the length to finitely many unknowns: what a discretisation says, and how others read it.

At every point the local variables are x = (i, y): the fields y and their derivatives by v are linear in the unknowns
u, and one variable i is linear in u plus the integral of a pointwise rate of the fields:

    y_k = O_k u / J^k,    i = start + lift u + C (J rate(y)),    J = dv/dx

A `Form` says what they mean: how x gives the named state of the energy. The spectral line has y = (psi, psi') and
integrates theta; the B-spline has theta itself and integrates nothing. Which unknowns belong to which field is known
to the discretisations alone; nobody else indexes into u.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from numpy.typing import NDArray

from mckibben.compiled.arrays import Array
from mckibben.model.angle import Known
from mckibben.model.energy import scales
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point

__all__ = [
    "Floats",
    "Form",
    "Operators",
    "Placed",
    "Sampling",
    "Variables",
    "cosines",
    "known",
    "place",
    "points_at",
    "variables",
]

Floats = NDArray[np.floating[Any]]

Variables = tuple[Any, ...]
"""Local variables (i, y_0, y_1 ...), each a number or an array over the points."""


class Form(NamedTuple):
    """What the local variables of a discretisation mean."""

    start: Callable[[Parameters], Number]
    """The integrated variable at the first end, without unknowns."""
    rate: Callable[[Variables, Parameters], Number]
    """(y, p) -> derivative by v of the integrated variable."""
    point: Callable[[Variables, Parameters], Point]
    """(x, p) -> the state of the energy."""
    orders: tuple[int, ...]  #: how often each field of y is differentiated by v
    rated: tuple[int, ...]  #: which fields the rate depends on; none where nothing is integrated
    angles: tuple[bool, ...]  #: which of x enter by their sine and cosine alone


class Operators(NamedTuple):
    """A discretisation at its quadrature points, the same for every muscle: q points, m unknowns."""

    x: Floats  #: coordinate of the points
    weights: Floats  #: quadrature in x over the full length
    fields: tuple[Floats, ...]  #: O_k (q, m)
    lift: Floats  #: the integrated variable by unknowns directly (q, m)
    cumulate: Floats  #: C: integral in x from the first end to each point (q, q)


class Sampling(NamedTuple):
    """A discretisation at n output points: constants, so they are made once."""

    x: Floats
    fields: tuple[Floats, ...]  #: O_k (n, m)
    lift: Floats  #: (n, m)
    sweep: Floats  #: integral in x of the rate, given at the quadrature points (n, q)
    integral: Floats  #: the same of what is even about mid-length, such as densities (n, q)


class Placed(NamedTuple):
    """A muscle on a discretisation: its numbers (the braid angle `Known`), units of the quantities, and dv/dx."""

    p: Parameters
    b: Number  #: how strongly points are crowded into the end layers
    unit: Float[Array, "4"]  #: of energy [J], length [m], volume [m^3] and closure [rad]
    jacobian: Float[Array, " q"]


def place(basis: Any, p: Parameters, b: Number) -> Placed:
    """A muscle on a discretisation, with points crowded by b."""
    with_angle = p._replace(theta0=Known.of(p.theta0))
    return Placed(with_angle, b, scales(p), jnp.asarray(basis.jacobian(basis.operators().x, p, b)))


def variables(basis: Any, on: Placed, u: Float[Array, " m"]) -> Variables:
    """x at the quadrature points (q each)."""
    form, operators = basis.form, basis.operators()
    fields = _fields(form, operators, on.jacobian, u)
    start = form.start(on.p) + jnp.asarray(operators.lift) @ u
    if not form.rated:
        return (start, *fields)
    return (start + operators.cumulate @ (on.jacobian * form.rate(known(form, fields, 1), on.p)), *fields)


def points_at(basis: Any, on: Placed, u: Float[Array, " m"], sampling: Sampling) -> Point:
    """The state at output points (n each), angles `Known`."""
    form = basis.form
    fields = _fields(form, sampling, jnp.asarray(basis.jacobian(sampling.x, on.p, on.b)), u)
    start = form.start(on.p) + jnp.asarray(sampling.lift) @ u
    if form.rated:
        inner = _fields(form, basis.operators(), on.jacobian, u)
        start = start + sampling.sweep @ (on.jacobian * form.rate(known(form, inner, 1), on.p))
    return form.point(known(form, (start, *fields)), on.p)


def _fields(form: Form, operators: Operators | Sampling, jacobian: Array, u: Array) -> Variables:
    parts = zip(operators.fields, form.orders, strict=True)
    return tuple(jnp.asarray(part) @ u / jacobian**order if order else jnp.asarray(part) @ u for part, order in parts)


def known(form: Form, x: Variables, first: int = 0) -> Variables:
    """Variables (from number `first` on) with sines and cosines computed where they enter by those alone."""
    return tuple(Known.of(one) if angle else one for one, angle in zip(x, form.angles[first:], strict=True))


def cosines(t: Floats) -> Floats:
    """From values at the n midpoints t of [0, pi] to the coefficients c_k of sum c_k cos(k t), k < n."""
    n = len(t)
    return np.asarray(np.cos(np.outer(np.arange(n), t)) * np.where(np.arange(n) > 0, 2.0, 1.0)[:, None] / n)
