"""Many muscles along a path each, in step: from rest to the first state by adaptive steps, then state by state.

Made to be mapped over muscles. A muscle for which a step cannot be taken is marked, and spoils no other one.
"""

from functools import partial
from typing import Any, NamedTuple

from jaxtyping import Bool, Float, Int

from ..discretise.line import Line
from ..kernel import jitted
from ..lazy import Array, jax, jnp
from ..model.parameters import Law
from .follow import Guess, predict
from .lockstep import LOADS, Design, constants, correct, sample, system

FIRST_STEP, GROWTH, CUT = 0.25, 2.0, 0.4
"""Of the way from rest to the first state: the first step, and what becomes of it after success and failure."""
CLOSE, ARRIVED, FAR = 0.05, 1e-2, 0.6
"""Largest change of psi [rad] in a correction after which a step on the way is good enough, in one after which the end
is, and above which a step was too long."""
LARGEST_CHANGE = 0.8
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""


class Arrival(NamedTuple):
    """The first state, or how far it went."""

    guess: Guess
    reached: Bool[Array, ""]
    systems: Int[Array, ""]


def approach(line: Line, law: Law, d: Design, select: Array, rest: Array, target: Array, limit: int) -> Arrival:
    """From the undeformed muscle, which rests at `rest`, to `target`: the pressure first, which stretches the fibres.

    Steps double as long as Newton follows; at most `limit` systems are solved.
    """
    shape = jnp.asarray(constants(line).shape)
    corner = jnp.where(target[1] == rest[1], 0.0, 0.5)

    def at(t: Array) -> Array:
        first = jnp.clip(t / jnp.maximum(corner, 1e-9), 0.0, 1.0)
        then = jnp.clip((t - corner) / (1.0 - corner), 0.0, 1.0)
        return rest + (target - rest) * jnp.stack([then, first])

    def newton(w: Array, target: Array) -> Any:
        return correct(system(line, law, d, w, sample(line, d, w)), w, select, target)

    def ahead(good: Array, tangents: Array, t: Array, dt: Array) -> Array:
        return good + tangents @ (at(t + dt) - at(t))

    class Way(NamedTuple):
        good: Array
        tangents: Array
        t: Array
        dt: Array
        w: Array
        systems: Array
        tries: Array  #: corrections of this step
        done: Array

    def going(now: Way) -> Array:
        return ~now.done & (now.systems < limit)

    def advance(now: Way) -> Way:
        c = newton(now.w, at(now.t + now.dt))
        w = now.w + c.step
        change = jnp.abs(shape @ c.step[:-LOADS]).max()
        moved = jnp.abs(shape @ (w - now.good)[:-LOADS]).max()
        sound, last = jnp.isfinite(change) & c.stable, now.t + now.dt >= 1.0 - 1e-12
        taken = sound & (change < jnp.where(last, ARRIVED, CLOSE)) & (moved < LARGEST_CHANGE)
        failed = ~taken & (~sound | (change > FAR) | (now.tries >= 4) | (moved > LARGEST_CHANGE))
        good, tangents = jnp.where(taken, w, now.good), jnp.where(taken, c.tangents, now.tangents)
        t = jnp.where(taken, now.t + now.dt, now.t)
        dt = jnp.where(taken, jnp.minimum(GROWTH * now.dt, 1.0 - t), jnp.where(failed, CUT * now.dt, now.dt))
        anew = taken | failed
        w = jnp.where(anew, ahead(good, tangents, t, dt), w)
        tries = jnp.where(anew, 0, now.tries + 1)
        return Way(good, tangents, t, dt, w, now.systems + 1, tries, taken & last)

    zero, none = jnp.zeros(()), jnp.zeros((), int)
    blank = jnp.zeros(line.unknowns + LOADS)
    c = newton(blank, rest)
    dt = jnp.asarray(FIRST_STEP)
    start = Way(c.step, c.tangents, zero, dt, ahead(c.step, c.tangents, zero, dt), none + 1, none, jnp.array(False))
    end = jax.lax.while_loop(going, advance, start)
    return Arrival(Guess(end.good, end.good, jnp.zeros_like(end.good), end.tangents), end.done, end.systems)


class Rows(NamedTuple):
    """States of one path."""

    w: Float[Array, "n w"]
    change: Float[Array, " n"]  #: largest change of psi [rad] in the last correction
    good: Bool[Array, " n"]  #: stable under what is held, and near the state before


def walk(
    line: Line, law: Law, d: Design, g: Guess, select: Array, targets: Array, count: Array, corrections: int
) -> Rows:
    """Through targets (n, 2), of which `count` count, from a state at targets[0] (which is corrected too)."""
    shape = jnp.asarray(constants(line).shape)
    n = len(targets)

    def advance(k: Array, carry: tuple[Guess, Rows]) -> tuple[Guess, Rows]:
        g, rows = carry
        now, last = targets[k], targets[jnp.maximum(k - 1, 0)]
        w = predict(g, last - targets[jnp.maximum(k - 2, 0)], now - last)
        for _ in range(corrections):
            c = correct(system(line, law, d, w, sample(line, d, w)), w, select, now)
            w = w + c.step
        change = jnp.abs(shape @ c.step[:-LOADS]).max()
        near = jnp.abs(shape @ (w - g.w)[:-LOADS]).max() < LARGEST_CHANGE
        filled = Rows(rows.w.at[k].set(w), rows.change.at[k].set(change), rows.good.at[k].set(c.stable & near))
        return Guess(w, g.w, g.tangents @ (now - last), c.tangents), filled

    blank = Rows(jnp.zeros((n, line.unknowns + LOADS)), jnp.full(n, jnp.inf), jnp.zeros(n, bool))
    return jax.lax.fori_loop(0, count, advance, (g, blank))[1]


class March(NamedTuple):
    """What one muscle's path gave."""

    reached: Bool[Array, ""]
    systems: Int[Array, ""]  #: solved on the way to the first state
    rows: Rows


@partial(jitted, static_argnums=(0, 1), static_argnames=("limit", "corrections"))
def march(
    line: Line,
    law: Law,
    designs: Design,
    select: Float[Array, "2 4"],
    rest: Float[Array, "batch 2"],
    targets: Float[Array, "batch n 2"],
    count: Int[Array, ""],
    *,
    limit: int = 40,
    corrections: int = 1,
) -> March:
    """Every muscle from `rest` to its first target and along the others; all quantities dimensionless."""

    def one(d: Design, rest: Array, targets: Array) -> March:
        first = approach(line, law, d, select, rest, targets[0], limit)
        return March(first.reached, first.systems, walk(line, law, d, first.guess, select, targets, count, corrections))

    return jax.vmap(one)(designs, rest, targets)
