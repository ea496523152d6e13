"""Many states of many muscles at once: a last Newton step, what they are worth, and the numbers that a sweep keeps."""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.compiled.rows import filled
from mckibben.discretise.fields import Placed
from mckibben.measure.kink import Missed
from mckibben.measure.read import Reading, read, stable, with_kinks, with_unresolved
from mckibben.solver.batch import moved, newton
from mckibben.solver.problem import Basis
from mckibben.solver.system import Local, Unknowns, assemble, localise, residual

__all__ = ["Appraised", "Polished", "appraised", "polished", "stiffnesses"]


class Appraised(NamedTuple):
    """One state, in SI units."""

    numbers: dict[str, Array]  #: by the names of a sweep's variables
    largest_slope: Array  #: of the meridian [rad]
    length: Bool[Array, ""]  #: stable with the length held
    force: Bool[Array, ""]  #: stable with the force held
    antisymmetric: Bool[Array, ""]  #: stable against antisymmetric disturbances
    missed: Missed | None  #: what kinks (gaps, slack fibres) and a varying angle add to the error


@kernel
def appraised(basis: Basis, on: Placed, states: Unknowns, count: Int[Array, ""]) -> Appraised:
    """The first `count` states (n, batch, ...) of every muscle, as they are; leaves lead with (n, batch), and are zero
    beyond."""

    def one(on: Placed, state: Unknowns) -> tuple[Reading, Array, Local, Array]:
        local = localise(basis, on, state)
        s = assemble(basis, on, local, len(state.loads), together=True)
        seen = with_kinks(read(basis, on, state), basis, on, state, s)
        return seen, residual(s, state.loads), local, s.values

    def at(k: Array) -> Appraised:
        some = jax.tree.map(lambda rows: rows[k], states)
        seen, off, local, values = jax.vmap(one)(on, some)
        seen = with_unresolved(seen, basis, on, some, values, each=0)
        under = stable(basis, on, local, some.loads.shape[1], jnp.array(False), each=0, together=True)
        numbers = seen.numbers | {
            "peak_fibre_tension": seen.fields["fibre_tension"].max(axis=1),
            "largest_radius": seen.fields["r"].max(axis=1),
            "residual": off, "conserved_variation": seen.conserved_variation, "coefficient_tail": seen.coefficient_tail,
        }  # fmt: skip
        return jax.tree.map(lambda row: row[None], Appraised(numbers, seen.largest_slope, *under, seen.missed))

    return filled(at, count, len(states.u))


class Polished(NamedTuple):
    """States (n, batch, ...) after Newton's last step, and how large it was."""

    states: Unknowns
    change: Float[Array, "n batch"]  #: largest change of psi [rad]


@partial(kernel, static_argnames=("most",))
def polished(
    basis: Basis,
    on: Placed,
    states: Unknowns,
    change: Float[Array, "n batch"],
    which: Int[Array, " l"],
    targets: Float[Array, "n batch l"],
    count: Int[Array, ""],
    close: Float[Array, ""],
    good: Bool[Array, " batch"],
    *,
    most: int = 3,
) -> Polished:
    """Newton steps, state by state, until the last one is `close` for every good muscle; at most `most`.

    Where it is so already nothing is done: the error that is left is about the square of the last step.
    """

    def step(now: tuple[Unknowns, Array, Array], target: Array) -> tuple[Unknowns, Array, Array]:
        state, _, tries = now
        by = jax.vmap(lambda on, state, target: newton(basis, on, which, state, target).step)(on, state, target)
        far = jax.vmap(lambda on, du: moved(basis, on, du))(on, by.u)
        return jax.tree.map(jnp.add, state, by), far, tries + 1

    def at(k: Any, rows: Polished) -> Polished:
        now = (jax.tree.map(lambda row: row[k], rows.states), rows.change[k], jnp.zeros((), int))
        state, change, _ = jax.lax.while_loop(
            lambda now: (now[2] < most) & (jnp.where(good, now[1], 0.0) > close).any(),
            lambda now: step(now, targets[k]),
            now,
        )
        states = jax.tree.map(lambda row, one: row.at[k].set(one), rows.states, state)
        return Polished(states, rows.change.at[k].set(change))

    return jax.lax.fori_loop(0, count, at, Polished(states, change))


@kernel
def stiffnesses(basis: Basis, on: Placed, states: Unknowns, which: Int[Array, " l"]) -> Float[Array, " batch"]:
    """dF/dh [N/m] at one state (batch, ...) of every muscle; the first row that holds is the length, the next another.

    It is the change of the force by the target of the length, which a Newton step has anyway (implicit function
    theorem).
    """

    def one(on: Placed, state: Unknowns) -> Array:
        by = newton(basis, on, which, state, jnp.zeros(len(state.loads))).tangents.loads
        return by[0, 0] * on.unit[0] / on.unit[1] ** 2

    return jax.vmap(one)(on, states)
