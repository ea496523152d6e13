"""Many muscles along a path each, in step: from rest to the first state by adaptive steps, then state by state.

Made to be mapped over muscles. A muscle for which a step cannot be taken is marked, and spoils no other one. The
equations are those of `solver.system`, arranged for many at once.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed
from mckibben.solver.follow import Guess, first_guess, kept_going, predict
from mckibben.solver.from_rest import begin, target
from mckibben.solver.held import NAMES, conditions, units
from mckibben.solver.newton import Correction, correct
from mckibben.solver.problem import Basis, slopes
from mckibben.solver.system import Unknowns, system

__all__ = ["Arrival", "Course", "March", "march", "moved", "newton"]

FIRST_STEP = 0.25
"""First step, over the way from rest to the first state."""
GROWTH = 2.0
"""What becomes of the step after success."""
CUT = 0.4
"""What becomes of the step after failure."""
CLOSE = 0.05
"""Largest change of psi [rad] in a correction after which a step on the way is good enough."""
ARRIVED = 1e-2
"""The same for the end of the way."""
FAR = 0.6
"""Change of psi [rad] in a correction above which a step was too long."""
LARGEST_CHANGE = 0.8
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""
TRIES = 4
"""Corrections of one step before it counts as too long."""


def newton(basis: Basis, on: Placed, which: Array, state: Unknowns, target: Array) -> Correction:
    """One Newton step towards what is held."""
    s = system(basis, on, state, together=True)
    return correct(s, conditions((), which, target, on, s, state.loads))


def moved(basis: Basis, on: Placed, du: Array) -> Array:
    """Largest change of psi [rad] by a change of the unknowns."""
    return jnp.abs(slopes(basis, on) @ du).max()


class Arrival(NamedTuple):
    """The first state, or how far it went."""

    guess: Guess
    reached: Bool[Array, ""]
    systems: Int[Array, ""]


class _Way(NamedTuple):
    good: Unknowns
    tangents: Unknowns
    t: Array
    dt: Array
    state: Unknowns
    systems: Array
    tries: Array  #: corrections of this step
    done: Array


def _either(first: Array, one: Any, other: Any) -> Any:
    return jax.tree.map(lambda a, b: jnp.where(first, a, b), one, other)


def _plus(state: Unknowns, change: Unknowns) -> Unknowns:
    return jax.tree.map(jnp.add, state, change)


def arrive(basis: Basis, on: Placed, which: Array, rest: Array, goal: Array, limit: Array) -> Arrival:
    """From the undeformed muscle, which rests at `rest`, to `goal`: the pressure first, which stretches the fibres.

    Where the fittings have a radius of their own it sets out from the cylinder of the first one, whatever `rest` says,
    and the other end gets its radius on the way. Steps double as long as Newton follows; at most `limit` systems are
    solved.
    """
    blank = Unknowns(jnp.zeros(basis.unknowns), jnp.zeros(len(which)))
    if on.p.end_radii is not None:
        blank, now = begin(basis, on)
        size = units(on.unit)
        rest = jnp.stack([target(name, now) / size[name] for name in (*NAMES, "closure")])[which]
    corner = jnp.where(goal[1] == rest[1], 0.0, 0.5)
    step = partial(newton, basis, on, which)

    def at(t: Array) -> Array:
        first = jnp.clip(t / jnp.maximum(corner, 1e-9), 0.0, 1.0)
        then = jnp.clip((t - corner) / (1.0 - corner), 0.0, 1.0)
        return rest + (goal - rest) * jnp.stack([then, first, *[then] * (len(which) - 2)])

    def ahead(good: Unknowns, tangents: Unknowns, t: Array, dt: Array) -> Unknowns:
        return jax.tree.map(lambda now, by: now + by @ (at(t + dt) - at(t)), good, tangents)

    def going(now: _Way) -> Array:
        return ~now.done & (now.systems < limit)

    def advance(now: _Way) -> _Way:
        c = step(now.state, at(now.t + now.dt))
        state = _plus(now.state, c.step)
        change, far = moved(basis, on, c.step.u), moved(basis, on, state.u - now.good.u)
        sound, last = jnp.isfinite(change) & c.stable, now.t + now.dt >= 1.0 - 1e-12
        taken = sound & (change < jnp.where(last, ARRIVED, CLOSE)) & (far < LARGEST_CHANGE)
        failed = ~taken & (~sound | (change > FAR) | (now.tries >= TRIES) | (far > LARGEST_CHANGE))
        good, tangents = _either(taken, (state, c.tangents), (now.good, now.tangents))
        t = jnp.where(taken, now.t + now.dt, now.t)
        dt = jnp.where(taken, jnp.minimum(GROWTH * now.dt, 1.0 - t), jnp.where(failed, CUT * now.dt, now.dt))
        anew = taken | failed
        state = _either(anew, ahead(good, tangents, t, dt), state)
        tries = jnp.where(anew, 0, now.tries + 1)
        return _Way(good, tangents, t, dt, state, now.systems + 1, tries, taken & last)

    zero, none = jnp.zeros(()), jnp.zeros((), int)
    c = step(blank, rest)
    dt, first = jnp.asarray(FIRST_STEP), c.step if on.p.end_radii is None else _plus(blank, c.step)
    start = _Way(first, c.tangents, zero, dt, ahead(first, c.tangents, zero, dt), none + 1, none, jnp.array(False))
    end = jax.lax.while_loop(going, advance, start)
    return Arrival(first_guess(end.good)._replace(tangents=end.tangents), end.done, end.systems)


class Course(NamedTuple):
    """States of one path."""

    state: Unknowns  #: (n, m) and (n, l)
    change: Float[Array, " n"]  #: largest change of psi [rad] in the last correction
    good: Bool[Array, " n"]  #: stable under what is held, and near the state before


def go_on(basis: Basis, on: Placed, g: Guess, which: Array, targets: Array, count: Array, corrections: int) -> Course:
    """Through targets (n, l), of which `count` count, from a state at targets[0] (which is corrected too)."""
    n = len(targets)

    def advance(k: Array, carry: tuple[Guess, Course]) -> tuple[Guess, Course]:
        g, rows = carry
        now, last = targets[k], targets[jnp.maximum(k - 1, 0)]
        state = predict(g, last - targets[jnp.maximum(k - 2, 0)], now - last)
        for _ in range(corrections):
            c = newton(basis, on, which, state, now)
            state = _plus(state, c.step)
        near = moved(basis, on, state.u - g.now.u) < LARGEST_CHANGE
        filled = Course(
            jax.tree.map(lambda row, one: row.at[k].set(one), rows.state, state),
            rows.change.at[k].set(moved(basis, on, c.step.u)),
            rows.good.at[k].set(c.stable & near),
        )
        return kept_going(g, state, c.tangents, now - last), filled

    rooms = jax.tree.map(lambda x: jnp.zeros((n, *x.shape)), g.now)
    blank = Course(rooms, jnp.full(n, jnp.inf), jnp.zeros(n, bool))
    return jax.lax.fori_loop(0, count, advance, (g, blank))[1]


class March(NamedTuple):
    """What one muscle's path gave."""

    reached: Bool[Array, ""]
    systems: Int[Array, ""]  #: solved on the way to the first state
    rows: Course


@partial(kernel, static_argnames=("corrections",))
def march(
    basis: Basis,
    on: Placed,
    which: Int[Array, " l"],
    rest: Float[Array, "batch l"],
    targets: Float[Array, "batch n l"],
    count: Int[Array, ""],
    limit: Int[Array, ""],
    *,
    corrections: int = 1,
) -> March:
    """Every muscle from `rest` to its first target, by at most `limit` systems, and along the others; dimensionless."""

    def one(on: Placed, rest: Array, targets: Array) -> March:
        first = arrive(basis, on, which, rest, targets[0], limit)
        return March(first.reached, first.systems, go_on(basis, on, first.guess, which, targets, count, corrections))

    return jax.vmap(one)(on, rest, targets)
