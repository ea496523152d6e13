"""Forces at measured lengths and pressures, with their derivatives by the numbers that are free.

From states that are near, Newton finds the states of a muscle whose numbers have changed, all points in step. With the
Lagrangian L = W - F (h - length) - P V at its stationary point, dL/dlength = F and dL/dq is that at fixed shape, so

    dF/dq = d/dlength (dL/dq) = (d/dw dL/dq) dw/dlength,    w: shape and loads.

Newton's factor gives dw/dlength; no derivative of the equations by the numbers is needed.
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place, variables
from mckibben.model.energy import stored, works
from mckibben.model.gap import inflated
from mckibben.model.parameters import Number, parameters
from mckibben.solver.batch import moved
from mckibben.solver.held import conditions, rows_of
from mckibben.solver.newton import batch_size, correct
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns, system
from mckibben.spec import Muscle

__all__ = ["Forces", "forces_at", "in_blocks"]

CORRECTIONS = 8
"""Newton systems at most for a state."""
BLOCK = 32
"""Points in step, at most."""
CLOSE = 1e-9
"""Last Newton step [rad], at most: the error of the derivatives, which are those of the state before it."""
LARGEST_CHANGE = 0.6
"""Largest change of psi [rad] from the state that was near which is trusted to be on the same branch."""


class Forces(NamedTuple):
    """At n points."""

    force: Float[Array, " n"]  #: axial [N], positive where the muscle pulls its fittings together
    slopes: Float[Array, "n k"]  #: by the free numbers, the last two added to length and pressure; SI
    states: Unknowns
    good: Bool[Array, " n"]  #: Newton arrived, near where it began and at a minimum


@partial(kernel, static_argnums=(0, 1))
def forces_at(
    basis: Basis,
    places: tuple[int, ...],
    b: Number,
    muscle: Muscle,
    free: Float[Array, " k"],
    points: Float[Array, "n 2"],
    near: Unknowns,
) -> Forces:
    """Forces at lengths and pressures (n, 2), from states `near` (n rows).

    `places` says which leaves of the muscle, in the order of `spec.numbers`, all but the last two of `free` replace;
    those are added to every length [m] and pressure [Pa].
    """
    leaves, tree = jax.tree.flatten(muscle)
    which = jnp.asarray(rows_of(("length", "pressure"), near.loads.shape[-1])[1])
    zeros = jnp.zeros(near.loads.shape[-1] - 2)
    weights = jnp.asarray(basis.operators().weights)

    def placed(free: Array) -> Placed:
        numbers = list(leaves)
        for k, leaf in enumerate(places):
            numbers[leaf] = free[k]
        return place(basis, parameters(jax.tree.unflatten(tree, numbers)), b)

    def lagrangian(free: Array, state: Unknowns) -> Array:
        on = placed(free)
        at = basis.form.point(variables(basis, on, state.u), on.p, on.made)
        loads = state.loads
        at = jax.vmap(lambda at: inflated(at, loads[1] * on.unit[0] / on.unit[2], on.p))(at)
        densities = jax.vmap(lambda at: jnp.stack([stored(at, on.p), *works(at, on.p)]))(at)
        energy, *works_on = ((weights * on.jacobian) @ densities) / on.unit
        return energy - sum(loads[k] * works_on[k] for k in range(len(loads)))

    here = placed(free)
    energy, length, volume, _ = here.unit
    size = jnp.stack([length, energy / volume])  # of the targets
    by_numbers = jax.grad(lagrangian)

    def one(row: tuple[Array, Unknowns]) -> Forces:
        point, start = row
        found = _arrived(basis, here, which, jnp.concatenate([(point + free[-2:]) / size, zeros]), start)
        state = found.state._replace(memory=None)
        by_length = jax.tree.map(lambda by: by[:, 0], found.tangents)
        mixed = jax.jvp(lambda at: by_numbers(free, at), (state,), (by_length,))[1][:-2]
        slopes = jnp.concatenate([mixed, found.tangents.loads[0, :2] / size]) * (energy / length)
        near_it = moved(basis, here, state.u - start.u) < LARGEST_CHANGE
        good = found.stable & near_it & (found.change <= CLOSE) & jnp.isfinite(state.loads).all()
        return Forces(state.loads[0] * energy / length, slopes, state, good)

    found: Forces = jax.vmap(one)((points, near))
    return found


def in_blocks(
    basis: Basis,
    places: tuple[int, ...],
    b: Number,
    muscle: Muscle,
    free: np.ndarray,
    points: np.ndarray,
    near: Unknowns,
) -> Forces:
    """`forces_at` for any number of points, in blocks of one size: whatever is asked for, one function is compiled."""
    size, n = min(batch_size(basis.unknowns), BLOCK), len(points)
    parts = []
    for begin in range(0, n, size):
        rows = np.minimum(np.arange(begin, begin + size), n - 1)
        some = Unknowns(near.u[rows], near.loads[rows])
        found = forces_at(basis, places, b, muscle, free, points[rows], some)
        parts.append(jax.tree.map(lambda part, left=n - begin: np.asarray(part)[:left], found))
    whole: Forces = jax.tree.map(lambda *some: np.concatenate(some), *parts)
    return whole


class _Arrived(NamedTuple):
    """Where Newton got to."""

    state: Unknowns
    tangents: Unknowns  #: its change by each target
    change: Array  #: last step [rad]
    stable: Array
    count: Array


def _arrived(basis: Basis, on: Placed, which: Array, target: Array, start: Unknowns) -> _Arrived:
    """Newton from a state that is near, until its last step is `CLOSE`."""

    def more(now: _Arrived) -> Array:
        return (now.count < CORRECTIONS) & (now.change > CLOSE)

    def again(now: _Arrived) -> _Arrived:
        s = system(basis, on, now.state)
        c = correct(s, conditions((), which, target, on, s, now.state.loads))
        u, loads = (old + by for old, by in zip(now.state[:2], c.step[:2], strict=True))
        return _Arrived(Unknowns(u, loads), c.tangents, moved(basis, on, c.step.u), c.stable, now.count + 1)

    m, n = len(start.u), len(start.loads)
    none = Unknowns(jnp.zeros((m, n)), jnp.zeros((n, n)))
    begin = _Arrived(Unknowns(start.u, start.loads), none, jnp.asarray(jnp.inf), jnp.array(True), jnp.zeros((), int))
    return jax.lax.while_loop(more, again, begin)
