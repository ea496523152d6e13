"""The equations of equilibrium, written once: for single states, paths, branches, derivatives, stability and batches.

The Lagrangian L of `model.energy` is differentiated at the points, by the local variables x = (i, y) of a
discretisation, and carried to the unknowns by the chain rule. With A = di/du, which is swept over the length:

    gradient = A^T (w L_i) + sum_k O_k^T (w L_k),   A = lift + C diag(J d(rate)/dy) O

and its derivative likewise, plus costate times d2(rate)/dy2, costate = C^T (w L_i).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Placed, Variables, known, variables
from mckibben.discretise.products import pairs, sandwich, swept
from mckibben.model.angle import Known
from mckibben.model.energy import remember, stored, works
from mckibben.model.parameters import Number
from mckibben.solver.trust_region import FLOOR

__all__ = [
    "Local",
    "System",
    "Unknowns",
    "assemble",
    "closing",
    "localise",
    "remembered",
    "residual",
    "stiffness",
    "system",
]


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
    turns: tuple[Array, ...]  #: J d(rate)/dy of the fields on which the rate depends
    bends: tuple[tuple[Array, ...], ...]  #: J d2(rate)/dy2, the upper triangle


class System(NamedTuple):
    """Derivatives of the Lagrangian by the unknowns, and what the loads do work on."""

    stiffness: Float[Array, "m m"]
    rest: Float[Array, " m"]  #: imbalance: the gradient
    gradients: Float[Array, "l m"]  #: of length, volume (and closure)
    values: Float[Array, " l"]


def localise(basis: Any, on: Placed, state: Unknowns, share: Number = 1.0) -> Local:
    """Derivatives at the points of a state. `share` is that of the stored energy in the Lagrangian."""
    form, p, unit = basis.form, on.p, on.unit
    x = variables(basis, on, state.u)
    weight = jnp.asarray(basis.operators().weights) * on.jacobian
    count, rated = len(x), form.rated

    def at(values: Variables, near: Variables) -> Variables:
        """Local variables with other values, whose sines and cosines are known."""
        pairs_of = zip(values, near, strict=True)
        return tuple(one._replace(value=value) if isinstance(one, Known) else value for value, one in pairs_of)

    def plain(near: Variables) -> Variables:
        return tuple(one.value if isinstance(one, Known) else one for one in near)

    def density(values: Variables, near: Variables, memory: Any) -> Number:
        point = form.point(at(values, near), p)
        loads = zip(state.loads, works(point, p), unit[1:], strict=False)
        return share * stored(point, p, memory) / unit[0] - sum(load * work / size for load, work, size in loads)

    def slopes(near: Variables, memory: Any) -> tuple[Any, Any, Any]:
        values = plain(near)
        derived = jax.value_and_grad(lambda *v: density(v, near, memory), tuple(range(count)))
        (value, first), change = jax.linearize(derived, *values)
        second = [change(*(jnp.full_like(value, i == k) for k, value in enumerate(values)))[1] for i in range(count)]
        return value, tuple(first), tuple(tuple(row[i:]) for i, row in enumerate(second))

    def working(near: Variables) -> tuple[tuple[Array, ...], tuple[tuple[Array, ...], ...]]:
        """What loads do work on, and its derivatives by each local variable."""

        def densities(*values: Number) -> tuple[Number, ...]:
            return tuple(
                work / size for work, size in zip(works(form.point(at(values, near), p), p), sizes, strict=True)
            )

        values, sizes = plain(near), tuple(unit[1:])
        found, change = jax.linearize(densities, *values)
        return found, tuple(change(*(jnp.full_like(v, i == k) for k, v in enumerate(values))) for i in range(count))

    def turning(near: Variables) -> tuple[tuple[Array, ...], tuple[tuple[Array, ...], ...]]:
        values = plain(near)

        def rate(*some: Number) -> Number:
            every = list(values)
            for k, value in zip(rated, some, strict=True):
                every[k] = value
            return form.rate(at(tuple(every), near), p)

        some = tuple(values[k] for k in rated)
        first, change = jax.linearize(jax.grad(rate, tuple(range(len(rated)))), *some)
        second = [change(*(jnp.full_like(value, i == k) for k, value in enumerate(some))) for i in range(len(some))]
        return tuple(first), tuple(tuple(row[i:]) for i, row in enumerate(second))

    near = known(form, x)
    value, first, second = jax.vmap(slopes)(near, state.memory)
    done, done_first = jax.vmap(working)(near)
    turns, bends = jax.vmap(turning)(near[1:]) if rated else ((), ())
    return Local(
        weight * value,
        tuple(weight * f for f in first),
        tuple(tuple(weight * f for f in row) for row in second),
        tuple(weight * f for f in done),
        tuple(tuple(weight * f for f in row) for row in done_first),
        tuple(on.jacobian * f for f in turns),
        tuple(tuple(on.jacobian * f for f in row) for row in bends),
    )


def assemble(basis: Any, on: Placed, local: Local, count: int, together: bool = False) -> System:
    """The equations from their pointwise derivatives, with `count` loads."""
    rest = _gradient(basis, on, local, local.first)
    gradients = [_gradient(basis, on, local, tuple(f[k] for f in local.works_first)) for k in range(count)]
    values = jnp.stack([work.sum() for work in local.works[:count]])
    return System(stiffness(basis, on, local, together), rest, jnp.stack(gradients), values)


def system(basis: Any, on: Placed, state: Unknowns, together: bool = False) -> System:
    """The equations at a state; `together` arranges them for many muscles in step."""
    return assemble(basis, on, localise(basis, on, state), len(state.loads), together)


def _gradient(basis: Any, on: Placed, local: Local, first: tuple[Array, ...]) -> Float[Array, " m"]:
    """Gradient by the unknowns of a total whose densities have the weighted derivatives `first`."""
    operators, form = basis.operators(), basis.form
    integrated, *fields = first
    by_fields = [f / on.jacobian**order if order else f for f, order in zip(fields, form.orders, strict=True)]
    if form.rated:
        back = integrated @ operators.cumulate
        for turn, k in zip(local.turns, form.rated, strict=True):
            by_fields[k] = by_fields[k] + turn * back
    parts = [f @ jnp.asarray(part) for f, part in zip(by_fields, operators.fields, strict=True)]
    return sum(parts, integrated @ jnp.asarray(operators.lift))


def stiffness(basis: Any, on: Placed, local: Local, together: bool = False) -> Float[Array, "m m"]:
    """Second derivatives of the Lagrangian by the unknowns of a space, which need not be that of the state."""
    operators, form = basis.operators(), basis.form
    across, *own = local.second
    scaled = [on.jacobian**-order if order else None for order in form.orders]

    def over(number: Array, k: int) -> Array:
        scale = scaled[k]
        return number if scale is None else number * scale

    squares = {(i, j): over(over(own[i][j - i], i), j) for i, j in pairs(len(own))}
    if form.rated:
        costate = local.first[0] @ operators.cumulate
        for a, i in enumerate(form.rated):
            for b, j in enumerate(form.rated[a:]):
                squares[i, j] = squares[i, j] + local.bends[a][b] * costate
    A = swept(basis, list(local.turns), together)
    side = 0.5 * across[0][:, None] * A
    for k, part in enumerate(operators.fields):
        side = side + over(across[1 + k], k)[:, None] * part
    mixed = A.T @ side
    return sandwich(basis, [squares[pair] for pair in pairs(len(own))], together) + mixed + mixed.T


def closing(basis: Any, on: Placed, local: Local) -> Float[Array, " a"]:
    """Condition on antisymmetric disturbances of a half line: the radius at its end is that of the other end.

    The integrated variable is zero at mid-length, so its change over half the length, and that at a free end, vanish.
    """
    even = basis.even()
    change = 0.5 * _gradient(even, on, local, tuple(f[2] for f in local.works_first))
    return change + jnp.asarray(even.operators().lift[0])


def remembered(basis: Any, on: Placed, state: Unknowns) -> Unknowns:
    """A state that has been reached, with what its points keep of it for the next one."""
    if state.memory is None:
        return state
    at = basis.form.point(variables(basis, on, state.u), on.p)
    return state._replace(memory=jax.vmap(lambda at, kept: remember(at, on.p, kept))(at, state.memory))


def residual(s: System, loads: Array) -> Array:
    """Imbalance over the size of its terms, as in the search; the compiler leaves out the unused stiffness."""
    energy = s.rest + loads @ s.gradients
    size = jnp.linalg.norm(energy) + jnp.abs(loads) @ jnp.linalg.norm(s.gradients, axis=1)
    return jnp.linalg.norm(s.rest) / (size + FLOOR)
