"""From fields over the length to finitely many unknowns: what a discretisation says, and how others read it.

At every point the local variables are x = (i, y): the fields y and their derivatives by v are linear in the unknowns u,
and each variable i is linear in u plus the integral of a pointwise rate of the fields and of the variables before it:

    y_k = O_k u / J^order,    i = start + lift u + C (J rate(x)),    J = dv/dx

A `Form` says what they mean: how x gives the named state of the energy. The spectral line has y = (psi, psi') and
integrates theta; where fibres stretch it integrates their stretch too. The B-spline has theta itself and integrates
nothing. Which unknowns belong to which field is known to the discretisations alone; nobody else indexes into u.
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
from mckibben.model.point import Made, Point
from mckibben.model.profile import made_at

__all__ = [
    "Floats",
    "Form",
    "Integral",
    "Operators",
    "Placed",
    "Sampling",
    "Variables",
    "cosines",
    "known",
    "place",
    "placed_on",
    "points_at",
    "states",
    "variables",
]

Floats = NDArray[np.floating[Any]]

Variables = tuple[Any, ...]
"""Local variables (i, y_0, y_1 ...), each a number or an array over the points."""


class Integral(NamedTuple):
    """An integrated variable."""

    start: Callable[[Parameters, Any], Number]
    """(p, made) -> its value as made, without unknowns: that at the first end, or at the points where that varies."""
    rate: Callable[[Variables, Parameters, Any], Number]
    """(x, p, made) -> its derivative by v, beyond that of its value as made."""
    by: tuple[int, ...]  #: which of x the rate depends on: fields, integrals before it; none if it is none


class Form(NamedTuple):
    """What the local variables of a discretisation mean."""

    integrals: tuple[Integral, ...]
    point: Callable[[Variables, Parameters, Any], Point]
    """(x, p, made) -> the state of the energy; `made` is a `Made`, or None for a braid of one angle."""
    orders: tuple[int, ...]  #: how often each field of y is differentiated by v
    angles: tuple[bool, ...]  #: which of x enter by their sine and cosine alone


class Operators(NamedTuple):
    """A discretisation at its quadrature points, the same for every muscle: q points, m unknowns."""

    x: Floats  #: coordinate of the points
    weights: Floats  #: quadrature in x over the full length
    fields: tuple[Floats, ...]  #: O_k (q, m)
    lifts: tuple[Floats, ...]  #: each integrated variable by unknowns directly (q, m)
    cumulate: Floats  #: C: integral in x from the first end to each point (q, q)


class Sampling(NamedTuple):
    """A discretisation at n output points: constants, so they are made once."""

    x: Floats
    fields: tuple[Floats, ...]  #: O_k (n, m)
    lifts: tuple[Floats, ...]  #: (n, m)
    sweep: Floats  #: integral in x of the rate, given at the quadrature points (n, q)
    integral: Floats  #: the same of what is even about mid-length, such as densities (n, q)


class Placed(NamedTuple):
    """A muscle on a discretisation: its numbers (the braid angle `Known`), units of the quantities, and dv/dx."""

    p: Parameters
    b: Number  #: how strongly points are crowded into the end layers
    unit: Float[Array, "4"]  #: of energy [J], length [m], volume [m^3] and closure [rad]
    jacobian: Float[Array, " q"]
    made: Made | None = None  #: how the braid is made at the points; None where it has one angle


def place(basis: Any, p: Parameters, b: Number) -> Placed:
    """A muscle on a discretisation, with points crowded by b."""
    with_angle = p._replace(theta0=Known.of(p.theta0))
    x = basis.operators().x
    return Placed(with_angle, b, scales(p), jnp.asarray(basis.jacobian(x, p, b)), _made(basis, p, b, x))


def placed_on(basis: Any, on: Placed) -> Placed:
    """The same muscle, crowded as much, on another discretisation."""
    x = basis.operators().x
    jacobian = jnp.asarray(basis.jacobian(x, on.p, on.b))
    return on._replace(jacobian=jacobian, made=_made(basis, on.p, on.b, x))


def _made(basis: Any, p: Parameters, b: Number, x: Floats) -> Made | None:
    return None if p.profile is None else made_at(basis.coordinate(x, p, b) / p.H0, p)


def states(basis: Any, on: Placed, u: Float[Array, " m"]) -> Point:
    """The state at the quadrature points, angles `Known`."""
    return basis.form.point(known(basis.form, variables(basis, on, u)), on.p, on.made)


def variables(basis: Any, on: Placed, u: Float[Array, " m"]) -> Variables:
    """x at the quadrature points (q each)."""
    operators = basis.operators()
    fields = _fields(basis.form, operators, on.jacobian, u)
    found: Variables = ()
    for k, one in enumerate(basis.form.integrals):
        value = one.start(on.p, on.made) + jnp.asarray(operators.lifts[k]) @ u
        if one.by:
            value = value + operators.cumulate @ (on.jacobian * _rate(basis.form, k, found, fields, on))
        found = (*found, value)
    return (*found, *fields)


def _rate(form: Form, k: int, before: Variables, fields: Variables, on: Placed) -> Number:
    """Rate of integral k at the quadrature points, from the integrals before it and the fields."""
    one, unknown = form.integrals[k], (None,) * (len(form.integrals) - len(before[:k]))
    return one.rate(known(form, (*before[:k], *unknown, *fields)), on.p, on.made)


def points_at(basis: Any, on: Placed, u: Float[Array, " m"], sampling: Sampling) -> Point:
    """The state at output points (n each), angles `Known`."""
    form, n = basis.form, len(basis.form.integrals)
    fields = _fields(form, sampling, jnp.asarray(basis.jacobian(sampling.x, on.p, on.b)), u)
    made = _made(basis, on.p, on.b, sampling.x)
    inner, found = variables(basis, on, u), []
    for k, one in enumerate(form.integrals):
        value = one.start(on.p, made) + jnp.asarray(sampling.lifts[k]) @ u
        if one.by:
            value = value + sampling.sweep @ (on.jacobian * _rate(form, k, inner, inner[n:], on))
        found.append(value)
    return form.point(known(form, (*found, *fields)), on.p, made)


def _fields(form: Form, operators: Operators | Sampling, jacobian: Array, u: Array) -> Variables:
    parts = zip(operators.fields, form.orders, strict=True)
    return tuple(jnp.asarray(part) @ u / jacobian**order if order else jnp.asarray(part) @ u for part, order in parts)


def known(form: Form, x: Variables) -> Variables:
    """Variables with sines and cosines computed where they enter by those alone; None stays None."""
    return tuple(Known.of(one) if angle and one is not None else one for one, angle in zip(x, form.angles, strict=True))


def cosines(t: Floats) -> Floats:
    """From values at the n midpoints t of [0, pi] to the coefficients c_k of sum c_k cos(k t), k < n."""
    n = len(t)
    return np.asarray(np.cos(np.outer(np.arange(n), t)) * np.where(np.arange(n) > 0, 2.0, 1.0)[:, None] / n)
