"""What a state owes to its number of unknowns: a step towards that on twice as many. For programmed braids.

Along them nothing is conserved, and the error falls with a power of the unknowns alone, so that the last
coefficients tell little of it (theory page). On the finer space, whose points are others too, the state is out of
balance by a little; the step that mends it changes force and length by what the coarse state is wrong, but for what
the finer one is.
"""

from functools import lru_cache
from typing import Any

import attrs
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats, Placed, placed_on
from mckibben.discretise.spectral import Line
from mckibben.measure.kink import Missed
from mckibben.model.parameters import Parameters
from mckibben.solver.newton import batch_size
from mckibben.solver.system import System, Unknowns, system
from mckibben.spec.angle_profile import Between

__all__ = ["asks_for_step", "unresolved", "unresolved_all"]

SAFE, LUCKY = 2.0, 8.0
"""Error over the change by the step, to be safe. Of splines it was 1.0 in validation/programmed.md, and 1.4 at most. A
monotone profile has kinks between the points, which cost little on both spaces by chance: there it was up to 7."""
NOISE, LEAST, SMALL = 1e-13, 1e-6, 1e-3
"""Of the axial stiffness, what rounding changes a force by, and below what a load is none to compare with, as at rest;
share of the load below which a pressure is none."""


def asks_for_step(basis: Any, p: Parameters) -> bool:
    """Whether what is conserved along the length tells too little: in a programmed braid, and where fibres stretch
    between fittings of another radius. The excess varies there within a short way of the fittings, of which the
    conserved quantity hardly knows: an error of a small force was seen to be 400 times the estimate by it."""
    return p.profile is not None or (p.end_radii is not None and isinstance(basis, Line) and basis.stretch)


def finer(basis: Line) -> Line:
    """The space with twice as many modes."""
    return attrs.evolve(basis, size=basis.size * 2)


@lru_cache(maxsize=64)
def _embedding(basis: Line) -> Floats:
    """From unknowns to the same shape on the finer space."""
    return np.stack([finer(basis).embedded(basis, one) for one in np.eye(basis.unknowns)], axis=1)


def unresolved_all(basis: Line, on: Placed, states: Unknowns, values: Float[Array, "n l"], each: int | None) -> Missed:
    """`unresolved` of n states; `on` is one muscle, or with each=0 n of them."""
    few = min(batch_size(finer(basis).unknowns), len(states.u))

    def one(row: tuple[Any, Unknowns, Array]) -> Missed:
        made, state, its = row
        return unresolved(basis, on if each is None else made, state, its)

    found: Missed = jax.lax.map(one, (None if each is None else on, states, values), batch_size=few)
    return found


def unresolved(basis: Line, on: Placed, state: Unknowns, values: Float[Array, " l"]) -> Missed:
    """By how much a state is wrong, by what was held; `values` are its length, volume (and closure) as it has them."""
    p, unit = on.p, on.unit
    off, slopes = changes(finer(basis), on, Unknowns(jnp.asarray(_embedding(basis)) @ state.u, state.loads), values)
    area = jnp.pi * p.R0**2 * unit[1] / unit[2]
    load = jnp.abs(state.loads[0]) + area * jnp.abs(state.loads[1])
    stiff = jnp.abs(slopes[0, 0] * values[0])
    load = jnp.maximum(load, LEAST * stiff)
    safe = LUCKY if p.profile is not None and p.profile.between == Between.MONOTONE else SAFE

    def of_loads(change: Array, of: Array = load) -> Array:
        return safe * jnp.maximum(jnp.abs(change) - NOISE * stiff, 0.0) / of

    def of_pressure(change: Array) -> Array:
        return of_loads(area * change, jnp.maximum(area * jnp.abs(state.loads[1]), SMALL * load))

    def of_length(change: Array) -> Array:
        return safe * jnp.abs(change) / values[0]

    force, volume = off
    pressure = -volume / slopes[1, 1]  # that holds the volume, with the length held
    length, other = -jnp.linalg.solve(slopes, off)
    return Missed(
        of_loads(force),
        of_length(force / slopes[0, 0]),
        jnp.maximum(of_loads(force + slopes[0, 1] * pressure), of_pressure(pressure)),
        jnp.maximum(of_length(length), of_pressure(other)),
    )


def changes(basis: Line, on: Placed, state: Unknowns, values: Array) -> tuple[Array, Array]:
    """By how much force and volume change (2) from a state to the equilibrium beside it, with length and pressure held
    at theirs; and their slopes by these two (2, 2).

    The force changes by the square of the step, and so by what the balance is off after it, which counts by how the
    state follows the length: the table is symmetric.
    """
    on = placed_on(basis, on)
    at = jax.jit(lambda state: system(basis, on, state), inline=True)  # traced once, though asked for twice
    s, n, count = at(state), len(state.u), len(values)
    held = jnp.array([0, *range(2, count)])  # length, and equal end radii where they are a condition
    aim = values.at[2:].set(0.0)
    G = s.gradients[held]
    table = jnp.block([[s.stiffness, -G.T], [-G, jnp.zeros((len(held), len(held)))]])

    def imbalance(s: System) -> Array:
        return jnp.concatenate([-s.rest, (s.values - aim)[held]])

    sides = jnp.stack([imbalance(s), jnp.zeros(len(table)), jnp.zeros(len(table))], axis=1)
    sides = sides.at[n, 1].set(-1.0).at[:n, 2].set(s.gradients[1])  # a unit more of length, and of pressure
    step, by_length, by_pressure = jnp.linalg.solve(table, sides).T
    after = at(Unknowns(state.u + step[:n], state.loads.at[held].add(step[n:])))
    left = imbalance(after)
    off = jnp.stack([step[n] - by_length @ left, after.values[1] - aim[1] + by_pressure @ left])
    swells = 0.0 if s.by_loads is None else s.by_loads[1, 1]
    slopes = [
        [by_length[n], by_pressure[n]],
        [s.gradients[1] @ by_length[:n], s.gradients[1] @ by_pressure[:n] + swells],
    ]
    return off, jnp.array(slopes)
