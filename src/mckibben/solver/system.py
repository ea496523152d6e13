"""The equations of equilibrium, written once: for single states, paths, branches, derivatives, stability and batches.

The Lagrangian L of `model.energy` is differentiated at the points, by the local variables x = (i, y) of a
discretisation, and carried to the unknowns by the chain rule. With A = di/du, which is swept over the length:

    gradient = A^T (w L_i) + sum_k O_k^T (w L_k),   A = lift + C diag(J d(rate)/dx) dx/du

and its derivative likewise, plus costate times d2(rate)/dx2. The costate of an integral is C^T (w L_i), L_i with what
the rates of later integrals owe to it.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.once import once
from mckibben.discretise.fields import Form, Integral, Placed, Variables, known, variables
from mckibben.discretise.products import pairs, sandwich, swept
from mckibben.model.angle import Known
from mckibben.model.energy import remember, stored, works
from mckibben.model.gap import found_hoop, inflated, leaves
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.trust_region import FLOOR

__all__ = [
    "Local",
    "System",
    "Unknowns",
    "assemble",
    "closing",
    "convex",
    "localise",
    "remembered",
    "residual",
    "stiffness",
    "system",
]


FEW = 4
"""Local variables by which derivatives are taken one by one."""
PIVOT = 1e-6
"""What must be left of a second derivative, over itself, when the variables before it have adjusted."""


class Unknowns(NamedTuple):
    """Unknowns of equilibrium, all dimensionless: those of the shape, and the loads that are not known beforehand."""

    u: Float[Array, " m"]
    loads: Float[Array, " l"]  #: force, pressure and, where equal end radii are a condition, closing moment
    memory: Any = None  #: what the quadrature points keep of the state before, a leading dimension for the points


class Local(NamedTuple):
    """Pointwise derivatives times the quadrature weights: they serve every space on the same points."""

    value: Float[Array, " q"]  #: of L
    first: tuple[Array, ...]  #: of L by each local variable: (q) each
    second: tuple[tuple[Array, ...], ...]  #: of L by pairs of them, the upper triangle
    works: tuple[Array, ...]  #: densities of length, volume and closure: (q) each
    works_first: tuple[tuple[Array, ...], ...]  #: for each local variable, their derivatives by it
    turns: tuple[tuple[Array, ...], ...]  #: for each integral, J d(rate)/dx of what the rate depends on
    bends: tuple[tuple[tuple[Array, ...], ...], ...]  #: J d2(rate)/dx2, the upper triangle
    swells: Any = None  #: derivative of the volume's density by the pressure: (q); None where there is none


class System(NamedTuple):
    """Derivatives of the Lagrangian by the unknowns, and what the loads do work on."""

    stiffness: Float[Array, "m m"]
    rest: Float[Array, " m"]  #: imbalance: the gradient
    gradients: Float[Array, "l m"]  #: of length, volume (and closure)
    values: Float[Array, " l"]
    by_loads: Any = None  #: derivatives of the values by the loads (l, l), where a chamber has a gap to swell into


def by_each(change: Callable[..., Any], values: Variables) -> tuple[tuple[Array, ...], ...]:
    """For each variable, the derivatives that `change` gives of its direction.

    Few are asked for one by one, which is quickest; more at once, which takes two thirds of the time to compile.
    """
    count = len(values)
    if count <= FEW:
        return tuple(change(*(jnp.full_like(value, i == k) for k, value in enumerate(values))) for i in range(count))
    every = jax.vmap(change)(*jnp.eye(count))
    return tuple(tuple(one[i] for one in every) for i in range(count))


def upper(rows: tuple[tuple[Array, ...], ...]) -> tuple[tuple[Array, ...], ...]:
    """The upper triangle of a symmetric matrix."""
    return tuple(row[i:] for i, row in enumerate(rows))


def localise(basis: Any, on: Placed, state: Unknowns, share: Number = 1.0) -> Local:
    """Derivatives at the points of a state. `share` is that of the stored energy in the Lagrangian."""
    form, p, unit = basis.form, on.p, on.unit
    P = state.loads[1] * unit[0] / unit[2]
    near, made = known(form, variables(basis, on, state.u)), on.made
    hoops = jax.vmap(lambda near, made: found_hoop(form.point(near, p, made), P, p))(near, made) if leaves(p) else None

    def at_point(near: Variables, memory: Any, hoop: Any, made: Any) -> tuple[Any, ...]:
        found: tuple[Any, ...] = _at_point(form, near, memory, hoop, made, p, unit, state.loads, share)
        return found

    (value, first, second), (done, done_first), turned, swells = jax.vmap(at_point)(near, state.memory, hoops, made)
    weight = jnp.asarray(basis.operators().weights) * on.jacobian
    return Local(
        weight * value,
        tuple(weight * f for f in first),
        tuple(tuple(weight * f for f in row) for row in second),
        tuple(weight * f for f in done),
        tuple(tuple(weight * f for f in row) for row in done_first),
        tuple(tuple(on.jacobian * f for f in turns) for turns, _ in turned),
        tuple(tuple(tuple(on.jacobian * f for f in row) for row in bends) for _, bends in turned),
        None if swells is None else weight * swells,
    )


@partial(once, static=0)
def _at_point(
    form: Form, near: Variables, memory: Any, hoop: Any, made: Any, p: Parameters, unit: Array, loads: Array,
    share: Number,
) -> tuple[Any, ...]:  # fmt: skip
    """Derivatives at one point: of L, what loads do work on, the rates of integrals, and the volume by the pressure."""
    P = loads[1] * unit[0] / unit[2]
    count = len(near)
    values = tuple(one.value if isinstance(one, Known) else one for one in near)

    def at(values: Variables) -> Variables:
        """Local variables with other values, whose sines and cosines are known."""
        pairs_of = zip(values, near, strict=True)
        return tuple(one._replace(value=value) if isinstance(one, Known) else value for value, one in pairs_of)

    def density(*values: Number) -> Number:
        point = form.point(at(values), p, made)
        terms = zip(loads, works(point, p), unit[1:], strict=False)
        return share * stored(point, p, memory, P, hoop) / unit[0] - sum(
            load * work / size for load, work, size in terms
        )

    def densities(*values: Number) -> tuple[Number, ...]:
        point = inflated(form.point(at(values), p, made), P, p, hoop)
        return tuple(work / size for work, size in zip(works(point, p), tuple(unit[1:]), strict=True))

    def turning(one: Integral) -> tuple[tuple[Array, ...], tuple[tuple[Array, ...], ...]]:
        def rate(*some: Number) -> Number:
            every = list(values)
            for k, value in zip(one.by, some, strict=True):
                every[k] = value
            return one.rate(at(tuple(every)), p, made)

        some = tuple(values[k] for k in one.by)
        first, change = jax.linearize(jax.grad(rate, tuple(range(len(some)))), *some)
        return tuple(first), upper(by_each(change, some))

    (value, first), change = jax.linearize(jax.value_and_grad(density, tuple(range(count))), *values)
    slopes = value, tuple(first), upper(by_each(lambda *by: change(*by)[1], values))
    done, change_done = jax.linearize(densities, *values)
    turned = [turning(one) if one.by else ((), ()) for one in form.integrals]
    swells = None
    if leaves(p):  # by how much the volume of a chamber grows with the pressure while the mesh stays
        point = form.point(near, p, made)
        swells = jax.grad(lambda P: works(inflated(point, P, p, hoop), p)[1])(P) * unit[0] / unit[2] ** 2
    return slopes, (done, by_each(change_done, values)), turned, swells


def assemble(basis: Any, on: Placed, local: Local, count: int, together: bool = False) -> System:
    """The equations from their pointwise derivatives, with `count` loads."""
    rest = _gradient(basis, on, local, local.first)
    gradients = [_gradient(basis, on, local, tuple(f[k] for f in local.works_first)) for k in range(count)]
    values = jnp.stack([work.sum() for work in local.works[:count]])
    by_loads = None if local.swells is None else jnp.zeros((count, count)).at[1, 1].set(local.swells.sum())
    return System(stiffness(basis, on, local, together), rest, jnp.stack(gradients), values, by_loads)


def system(basis: Any, on: Placed, state: Unknowns, together: bool = False) -> System:
    """The equations at a state; `together` arranges them for many muscles in step."""
    return assemble(basis, on, localise(basis, on, state), len(state.loads), together)


def _costates(basis: Any, local: Local, first: tuple[Array, ...]) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Costate of each integral, and the derivatives `first` of a density with what the rates owe to each variable."""
    form, operators = basis.form, basis.operators()
    costates: list[Any] = [None] * len(form.integrals)
    owed = list(first)
    for k in reversed(range(len(form.integrals))):
        if form.integrals[k].by:
            costates[k] = owed[k] @ operators.cumulate
            for turn, j in zip(local.turns[k], form.integrals[k].by, strict=True):
                owed[j] = owed[j] + turn * costates[k]
    return tuple(costates), tuple(owed)


def _gradient(basis: Any, on: Placed, local: Local, first: tuple[Array, ...]) -> Float[Array, " m"]:
    """Gradient by the unknowns of a total whose densities have the weighted derivatives `first`."""
    operators, form, n = basis.operators(), basis.form, len(basis.form.integrals)
    _, owed = _costates(basis, local, first)
    scaled = [f / on.jacobian**order if order else f for f, order in zip(owed[n:], form.orders, strict=True)]
    parts = [f @ jnp.asarray(part) for f, part in zip(scaled, operators.fields, strict=True)]
    first_of_all, *more = [owed[k] @ jnp.asarray(lift) for k, lift in enumerate(operators.lifts)]
    return sum([*parts, *more], first_of_all)


def stiffness(basis: Any, on: Placed, local: Local, together: bool = False) -> Float[Array, "m m"]:
    """Second derivatives of the Lagrangian by the unknowns of a space, which need not be that of the state."""
    operators, form, n = basis.operators(), basis.form, len(basis.form.integrals)
    second = _second(basis, local)
    scaled = [on.jacobian**-order if order else None for order in form.orders]

    def over(number: Array, k: int) -> Array:
        scale = scaled[k]
        return number if scale is None else number * scale

    tables = swept(basis, local.turns, on.jacobian, together)
    coupled = []
    for i, A in enumerate(tables):
        side = 0.5 * second[i, i][:, None] * A
        for j in range(i + 1, n):
            side = side + second[i, j][:, None] * tables[j]
        for k, part in enumerate(operators.fields):
            side = side + over(second[i, n + k], k)[:, None] * part
        coupled.append(A.T @ side)
    mixed = sum(coupled[1:], coupled[0])
    squares = [over(over(second[n + i, n + j], i), j) for i, j in pairs(len(form.orders))]
    return sandwich(basis, squares, together) + mixed + mixed.T


def _second(basis: Any, local: Local) -> dict[tuple[int, int], Array]:
    """Second derivatives of the Lagrangian at the points by variables i <= j, and of the rates times costates."""
    costates, _ = _costates(basis, local, local.first)
    second = {(i, i + k): f for i, row in enumerate(local.second) for k, f in enumerate(row)}
    for one, bends, costate in zip(basis.form.integrals, local.bends, costates, strict=True):
        for a, i in enumerate(one.by):
            for b, j in enumerate(one.by[a:]):
                second[i, j] = second[i, j] + bends[a][b] * costate
    return second


def convex(basis: Any, local: Local) -> Bool[Array, ""]:
    """Whether the second derivatives of the Lagrangian are positive definite at every point.

    Then so is the stiffness on every space of those points, whatever is held; where not, it may be so all the same.
    """
    left, good = _second(basis, local), jnp.array(True)
    size = {i: value for (i, j), value in left.items() if i == j}
    for k in size:
        good = good & (left[k, k] > PIVOT * size[k]).all() & (size[k] > 0.0).all()
        for i, j in ((i, j) for i, j in left if i > k):
            left[i, j] = left[i, j] - left[k, i] * left[k, j] / left[k, k]
    return good


def closing(basis: Any, on: Placed, local: Local) -> Float[Array, "c a"]:
    """Conditions on antisymmetric disturbances of a half line: what is integrated does not change at mid-length.

    The braid angle there changes by its turn at the first end and by its rate over half the length. Where fibres
    stretch, the radius does not change there either, which is held at the first end; at a free one it is the stretch
    that is told by its turn and its rate.
    """
    even = basis.even()
    form, lifts = even.form, even.operators().lifts
    half = jnp.asarray(even.operators().weights) / 2.0

    def at_middle(k: int) -> Array:
        turns = dict(zip(form.integrals[k].by, local.turns[k], strict=True))
        first = tuple(half * turns[j] if j in turns else 0.0 * half for j in range(len(local.first)))
        return _gradient(even, on, local, first) + jnp.asarray(lifts[k][0])

    closure = 0.5 * _gradient(even, on, local, tuple(f[2] for f in local.works_first))
    if len(form.integrals) == 1:
        return (closure + jnp.asarray(lifts[0][0]))[None]
    return jnp.stack([at_middle(0), at_middle(1) if even.ends == "free" else closure])


def remembered(basis: Any, on: Placed, state: Unknowns) -> Unknowns:
    """A state that has been reached, with what its points keep of it for the next one."""
    if state.memory is None:
        return state
    x = variables(basis, on, state.u)
    at = basis.form.point(x, on.p, on.made)  # what crossings keep knows nothing of the chamber
    return state._replace(memory=jax.vmap(lambda at, kept: remember(at, on.p, kept))(at, state.memory))


def residual(s: System, loads: Array) -> Array:
    """Imbalance over the size of its terms, as in the search; the compiler leaves out the unused stiffness."""
    energy = s.rest + loads @ s.gradients
    size = jnp.linalg.norm(energy) + jnp.abs(loads) @ jnp.linalg.norm(s.gradients, axis=1)
    return jnp.linalg.norm(s.rest) / (size + FLOOR)
