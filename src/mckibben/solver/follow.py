"""Along a path of states in compiled code: a cubic or tangent guess, Newton, a stability check.

A step that cannot be taken at once is taken in parts. Where that fails too the function stops and says how many states
are good; nothing is lost.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.held import Held, conditions, rows_of, targets_of
from mckibben.solver.newton import Correction, correct
from mckibben.solver.problem import Basis, Problem, slopes
from mckibben.solver.system import Unknowns, remembered, system

__all__ = ["Followed", "Guess", "Track", "follow", "follow_to", "kept_going", "padded", "predict", "prepare"]

CORRECTIONS = 8
"""Newton systems a step may take; a good one needs one or two."""
LARGEST_CHANGE = 0.6
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""
SMALLEST = 1.0 / 64.0
"""Smallest part of a step."""


class Track(NamedTuple):
    """States along a path."""

    state: Unknowns  #: (n, m) and (n, l), and what the points keep, step by step
    iterations: Int[Array, " n"]
    good: Int[Array, ""]  #: number of states reached, the given first one included


class Guess(NamedTuple):
    """Where the next state starts from: what is known of the last two."""

    now: Unknowns
    before: Unknowns
    slope: Unknowns  #: change of the state for the step from `before` to `now`, taken at `before`
    tangents: Unknowns  #: change of the state by the targets, at `now`


def first_guess(state: Unknowns) -> Guess:
    """Of a path that begins at a state."""
    none = jax.tree.map(jnp.zeros_like, state._replace(memory=None))
    count = len(state.loads)
    return Guess(state, state, none, jax.tree.map(lambda x: jnp.zeros((*x.shape, count)), none))


class _Step(NamedTuple):
    state: Unknowns
    tangents: Unknowns
    change: Array  #: largest change of an unknown in the last correction
    iterations: Array
    stable: Array


def _take(newton: Any, guess: Unknowns, good: Unknowns, tolerance: Array) -> _Step:
    """Correct a guess until the last step, whose square is the error that is left, is below tolerance.

    A guess that is no minimum went too far from the last good state: it is taken back by half.
    """

    def more(step: _Step) -> Array:
        return (step.iterations < CORRECTIONS) & (step.change > tolerance)

    def again(step: _Step) -> _Step:
        c: Correction = newton(step.state)
        change = jnp.abs(c.step.u).max()
        parts = zip(step.state[:2], c.step[:2], good[:2], strict=True)
        u, loads = (jnp.where(c.stable, now + by, 0.5 * (now + last)) for now, by, last in parts)
        state = step.state._replace(u=u, loads=loads)
        return _Step(state, c.tangents, jnp.where(c.stable, change, jnp.inf), step.iterations + 1, c.stable)

    far, none = jnp.asarray(jnp.inf), jnp.zeros((), int)
    blank = first_guess(guess).tangents
    return jax.lax.while_loop(more, again, _Step(guess, blank, far, none, jnp.array(False)))


@kernel
def follow(
    static: tuple[Basis, Any],
    p: Parameters,
    b: Number,
    state: Unknowns,
    which: Int[Array, " l"],
    targets: Float[Array, "n l"],
    count: Int[Array, ""],
    tolerance: Float[Array, ""],
) -> Track:
    """From a good state at targets[0] through targets[1 .. count - 1]; the rest of the array is padding.

    `static` is the basis and rows of one's own; `which` says which rows hold (see `held.rows_of`).
    """
    basis, own = static
    on, n = place(basis, p, b), len(targets)
    psi = slopes(basis, on)

    def advance(now: _Going) -> _Going:
        track, g = now.track, now.guess
        k = track.good  # for k = 0 the given state is corrected where it stands, which also gives the tangents
        begin, end = targets[jnp.maximum(k - 1, 0)], targets[k]
        whole = (now.share + now.part >= 1.0) | (k == 0)
        here, aim = _between(begin, end, now.share), jnp.where(whole, end, _between(begin, end, now.share + now.part))

        def newton(state: Unknowns) -> Correction:
            s = system(basis, on, state)
            return correct(s, conditions(own, which, aim, on, s, state.loads))

        step = _take(newton, predict(g, now.done, aim - here), g.now, tolerance)
        moved = jnp.abs(psi @ (step.state.u - g.now.u)).max()
        ok = (step.change <= tolerance) & (moved < LARGEST_CHANGE) & step.stable & jnp.isfinite(step.state.u).all()
        ok = ok | (k == 0)
        reached = remembered(basis, on, step.state)
        kept = Track(
            jax.tree.map(lambda row, one: row.at[k].set(one), track.state, reached),
            track.iterations.at[k].add(step.iterations),
            jnp.where(ok & whole, k + 1, k),
        )
        further = kept_going(g, reached, step.tangents, aim - here)
        return _Going(
            kept,
            jax.tree.map(lambda new, old: jnp.where(ok, new, old), further, g),
            jnp.where(ok, aim - here, now.done),
            jnp.where(ok, jnp.where(whole, 0.0, now.share + now.part), now.share),
            jnp.where(ok, jnp.minimum(2.0 * now.part, 1.0), 0.5 * now.part),
        )

    rooms = jax.tree.map(lambda x: jnp.zeros((n, *x.shape), x.dtype), state)
    track = Track(rooms, jnp.zeros(n, int), jnp.zeros((), int))
    start = _Going(track, first_guess(state), jnp.zeros_like(targets[0]), jnp.zeros(()), jnp.ones(()))
    return jax.lax.while_loop(lambda now: (now.part >= SMALLEST) & (now.track.good < count), advance, start).track


class _Going(NamedTuple):
    """How far a path is followed."""

    track: Track
    guess: Guess
    done: Array  #: change of the targets in the last step
    share: Array  #: how much of the way to the next state lies behind
    part: Array  #: how much of it is tried next


def _between(begin: Array, end: Array, share: Array) -> Array:
    return begin + (end - begin) * share


def kept_going(g: Guess, state: Unknowns, tangents: Unknowns, step: Array) -> Guess:
    """What is known after one more state."""
    return Guess(state, g.now, jax.tree.map(lambda by: by @ step, g.tangents), tangents)


def predict(g: Guess, done: Array, ahead: Array) -> Unknowns:
    """The cubic through the last two states with their tangents where the path goes straight on, else the tangent."""
    length, past = jnp.linalg.norm(ahead), jnp.linalg.norm(done)
    ratio = length / jnp.maximum(past, 1e-300)
    straight = (ahead @ done > 0.999 * length * past) & (past > 0.0) & (ratio < 3.0)
    t = 1.0 + jnp.where(straight, ratio, 0.0)

    def of(now: Array, before: Array, slope: Array, tangents: Array) -> Array:
        cubic = (2 * t**3 - 3 * t**2 + 1) * before + (t**3 - 2 * t**2 + t) * slope
        cubic = cubic + (3 * t**2 - 2 * t**3) * now + (t**3 - t**2) * (tangents @ done)
        return jnp.where(straight, cubic, now + tangents @ ahead)

    return g.now._replace(u=of(*(one.u for one in g)), loads=of(*(one.loads for one in g)))


def padded(targets: np.ndarray) -> np.ndarray:
    """Targets repeated up to the next power of two from 32, so that few lengths are compiled."""
    size = max(32, 1 << int(len(targets) - 1).bit_length())
    return np.concatenate([targets, np.repeat(targets[-1:], size - len(targets), axis=0)])


class Followed(NamedTuple):
    """One state that following reached."""

    u: np.ndarray
    loads: np.ndarray
    iterations: int


def follow_to(problem: Problem, path: Sequence[Held], here: Equilibrium, tolerance: float) -> list[Followed]:
    """The states of a path, all holding the same things, from `here` which is at its first; as far as they are good."""
    own, which = rows_of(path[0].names, problem.loads)
    targets = padded(targets_of(path, problem.unit, problem.loads))
    count, close = np.asarray(len(path)), np.asarray(tolerance)
    track = follow((problem.basis, own), problem.p, problem.b, here.state, which, targets, count, close)
    u, loads, iterations = (np.asarray(part) for part in (track.state.u, track.state.loads, track.iterations))
    return [Followed(u[k], loads[k], int(iterations[k])) for k in range(int(track.good))]


def prepare(basis: Basis, p: Parameters, b: float, count: int) -> None:
    """Have what follows a path of `count` states compiled in the background (see `compiled.kernel`)."""
    loads = 3 if basis.closes else 2
    own, which = rows_of(("length", "pressure"), loads)
    state = Unknowns(np.empty(basis.unknowns), np.empty(loads))
    follow.prepare(
        (basis, own), p, b, state, which, padded(np.empty((count, loads))), np.asarray(count), np.asarray(0.0)
    )  # fmt: skip
