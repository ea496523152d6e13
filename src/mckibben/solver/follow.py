"""Along a path of states in compiled code: a cubic or tangent guess, Newton, a stability check.

Where a step cannot be taken the function stops and says how many states are good; nothing is lost.
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
from mckibben.solver.system import State, system

__all__ = ["Followed", "Guess", "Track", "follow", "follow_to", "kept_going", "padded", "predict", "prepare"]

CORRECTIONS = 8
"""Newton systems a step may take; a good one needs one or two."""
LARGEST_CHANGE = 0.6
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""


class Track(NamedTuple):
    """States along a path."""

    state: State  #: (n, m) and (n, l)
    iterations: Int[Array, " n"]
    good: Int[Array, ""]  #: number of states reached, the given first one included


class Guess(NamedTuple):
    """Where the next state starts from: what is known of the last two."""

    now: State
    before: State
    slope: State  #: change of the state for the step from `before` to `now`, taken at `before`
    tangents: State  #: change of the state by the targets, at `now`


def first_guess(state: State) -> Guess:
    """Of a path that begins at a state."""
    none = jax.tree.map(jnp.zeros_like, state)
    count = len(state.loads)
    return Guess(state, state, none, jax.tree.map(lambda x: jnp.zeros((*x.shape, count)), none))


class _Step(NamedTuple):
    state: State
    tangents: State
    change: Array  #: largest change of an unknown in the last correction
    iterations: Array
    stable: Array


def _take(newton: Any, guess: State, good: State, tolerance: Array) -> _Step:
    """Correct a guess until the last step, whose square is the error that is left, is below tolerance.

    A guess that is no minimum went too far from the last good state: it is taken back by half.
    """

    def more(step: _Step) -> Array:
        return (step.iterations < CORRECTIONS) & (step.change > tolerance)

    def again(step: _Step) -> _Step:
        c: Correction = newton(step.state)
        change = jnp.abs(c.step.u).max()
        state = jax.tree.map(
            lambda now, by, last: jnp.where(c.stable, now + by, 0.5 * (now + last)), step.state, c.step, good
        )
        return _Step(state, c.tangents, jnp.where(c.stable, change, jnp.inf), step.iterations + 1, c.stable)

    far, none = jnp.asarray(jnp.inf), jnp.zeros((), int)
    blank = first_guess(guess).tangents
    return jax.lax.while_loop(more, again, _Step(guess, blank, far, none, jnp.array(False)))


@kernel
def follow(
    static: tuple[Basis, Any],
    p: Parameters,
    b: Number,
    state: State,
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

    def advance(carry: tuple[Track, Guess, Array]) -> tuple[Track, Guess, Array]:
        track, g, _ = carry
        k = track.good  # for k = 0 the given state is corrected where it stands, which also gives the tangents
        now, last = targets[k], targets[jnp.maximum(k - 1, 0)]

        def newton(state: State) -> Correction:
            s = system(basis, on, state)
            return correct(s, conditions(own, which, now, on.unit, s.values, state.loads))

        guess = predict(g, last - targets[jnp.maximum(k - 2, 0)], now - last)
        step = _take(newton, guess, g.now, tolerance)
        moved = jnp.abs(psi @ (step.state.u - g.now.u)).max()
        ok = (step.change <= tolerance) & (moved < LARGEST_CHANGE) & step.stable & jnp.isfinite(step.state.u).all()
        ok = ok | (k == 0)
        kept = Track(
            jax.tree.map(lambda row, one: row.at[k].set(one), track.state, step.state),
            track.iterations.at[k].set(step.iterations),
            jnp.where(ok, k + 1, k),
        )
        return kept, kept_going(g, step.state, step.tangents, now - last), ok

    rooms = jax.tree.map(lambda x: jnp.zeros((n, *x.shape)), state)
    track = Track(rooms, jnp.zeros(n, int), jnp.zeros((), int))
    track, *_ = jax.lax.while_loop(
        lambda carry: carry[2] & (carry[0].good < count), advance, (track, first_guess(state), jnp.array(True))
    )
    return track


def kept_going(g: Guess, state: State, tangents: State, step: Array) -> Guess:
    """What is known after one more state."""
    return Guess(state, g.now, jax.tree.map(lambda by: by @ step, g.tangents), tangents)


def predict(g: Guess, done: Array, ahead: Array) -> State:
    """The cubic through the last two states with their tangents where the path goes straight on, else the tangent."""
    length, past = jnp.linalg.norm(ahead), jnp.linalg.norm(done)
    ratio = length / jnp.maximum(past, 1e-300)
    straight = (ahead @ done > 0.999 * length * past) & (past > 0.0) & (ratio < 3.0)
    t = 1.0 + jnp.where(straight, ratio, 0.0)

    def of(now: Array, before: Array, slope: Array, tangents: Array) -> Array:
        cubic = (2 * t**3 - 3 * t**2 + 1) * before + (t**3 - 2 * t**2 + t) * slope
        cubic = cubic + (3 * t**2 - 2 * t**3) * now + (t**3 - t**2) * (tangents @ done)
        return jnp.where(straight, cubic, now + tangents @ ahead)

    return jax.tree.map(of, *g)


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
    state = State(np.empty(basis.unknowns), np.empty(loads))
    follow.prepare(
        (basis, own), p, b, state, which, padded(np.empty((count, loads))), np.asarray(count), np.asarray(0.0)
    )  # fmt: skip
