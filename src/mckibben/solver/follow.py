"""Along a path of states in compiled code: a cubic or tangent guess, Newton, a stability check.

The unknowns are w = (u, force, pressure), and any two of length, volume, force and pressure are held. Where a step
cannot be taken the function stops and says how many states are good; nothing is lost.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from ..kernel import kernel
from ..lazy import Array, jax, jnp
from ..model.parameters import Number, Parameters
from .lockstep import HEAVY, LOADS, Correction, correct, design, sample, system
from .problem import Space, bordered

CORRECTIONS = 8
"""Newton systems a step may take; a good one needs one or two."""
LARGEST_CHANGE = 0.6
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""


class Track(NamedTuple):
    """States along a path."""

    w: Float[Array, "n w"]
    values: Float[Array, "n 2"]  #: length and volume
    iterations: Int[Array, " n"]
    good: Int[Array, ""]  #: number of states reached, the given first one included


class Guess(NamedTuple):
    """Where the next state starts from: what is known of the last two."""

    w: Array
    before: Array  #: w of the state before
    slope: Array  #: dw for the step from `before` to w, taken at `before`
    tangents: Array  #: dw by the held values, at w


class _Step(NamedTuple):
    w: Array
    values: Array
    tangents: Array
    change: Array  #: largest change of an unknown in the last correction
    iterations: Array
    stable: Array


Newton = Callable[[Array, Array], tuple[Correction, Array]]
"""(w, target) -> a Newton step, and length and volume after it."""


def _newton(space: Space, p: Parameters, b: Number, select: Array) -> Newton:
    """By the quick equations of a half line, or by the bordered system of any space."""

    def quick(w: Array, target: Array) -> tuple[Correction, Array]:
        s = system(space.line, space.law, d, w, sample(space.line, d, w))
        c = correct(s, w, select, target)
        return c, s.values + s.gradients @ c.step[:-LOADS]

    def general(w: Array, target: Array) -> tuple[Correction, Array]:
        matrix, rest, values = bordered(space, p, b, w, select, target)
        sides = jnp.concatenate([-rest[:, None], jnp.eye(len(w))[:, -LOADS:]], axis=1)
        solved = jnp.linalg.solve(matrix, sides)
        K, held = matrix[:-LOADS, :-LOADS], matrix[-LOADS:, :-LOADS]
        size = HEAVY * jnp.trace(jnp.abs(K)) / jnp.maximum(jnp.sum(held**2), 1e-30)
        stable = jnp.isfinite(jnp.linalg.cholesky(K + size * held.T @ held)).all()
        change = -matrix[:-LOADS, -LOADS:].T @ solved[:-LOADS, 0]
        return Correction(solved[:, 0], solved[:, 1:], stable), values + change

    if not space.half:
        return general
    d = design(space.line, space.law, p, b)
    return quick


def _take(newton: Newton, w: Array, good: Array, target: Array, tolerance: Array) -> _Step:
    """Correct w onto what is held, until the last step, whose square is the error that is left, is below tolerance.

    A guess that is no minimum went too far from the last good state: it is taken back by half.
    """

    def more(step: _Step) -> Array:
        return (step.iterations < CORRECTIONS) & (step.change > tolerance)

    def again(step: _Step) -> _Step:
        c, values = newton(step.w, target)
        change = jnp.abs(c.step[:-LOADS]).max()
        return _Step(
            jnp.where(c.stable, step.w + c.step, 0.5 * (step.w + good)), values, c.tangents,
            jnp.where(c.stable, change, jnp.inf), step.iterations + 1, c.stable,
        )  # fmt: skip

    far, none = jnp.asarray(jnp.inf), jnp.zeros((), int)
    start = _Step(w, jnp.zeros(2), jnp.zeros((len(w), 2)), far, none, jnp.array(False))
    return jax.lax.while_loop(more, again, start)


@kernel
def follow(
    space: Space,
    p: Parameters,
    b: Number,
    w: Float[Array, " w"],
    select: Float[Array, "2 4"],
    targets: Float[Array, "n 2"],
    count: Int[Array, ""],
    tolerance: Float[Array, ""],
) -> Track:
    """From a good state w at targets[0] through targets[1 .. count - 1]; the rest of the array is padding."""
    n, newton = len(targets), _newton(space, p, b, select)
    psi = space.basis.slope_factor(p) * space.mesh(p, b).fields[:, 0]
    track = Track(jnp.zeros((n, len(w))), jnp.zeros((n, 2)), jnp.zeros(n, int), jnp.zeros((), int))

    def more(carry: tuple[Track, Guess, Array]) -> Array:
        track, _, going = carry
        return going & (track.good < count)

    def advance(carry: tuple[Track, Guess, Array]) -> tuple[Track, Guess, Array]:
        track, g, _ = carry
        k = track.good  # for k = 0 the given state is corrected where it stands, which also gives the tangents
        now, last = targets[k], targets[jnp.maximum(k - 1, 0)]
        guess = predict(g, last - targets[jnp.maximum(k - 2, 0)], now - last)
        step = _take(newton, guess, g.w, now, tolerance)
        moved = jnp.abs(psi @ (step.w - g.w)[:-LOADS]).max()
        ok = (step.change <= tolerance) & (moved < LARGEST_CHANGE) & step.stable & jnp.isfinite(step.w).all()
        ok = ok | (k == 0)
        kept = Track(
            track.w.at[k].set(step.w),
            track.values.at[k].set(step.values),
            track.iterations.at[k].set(step.iterations),
            jnp.where(ok, k + 1, k),
        )
        return kept, Guess(step.w, g.w, g.tangents @ (now - last), step.tangents), ok

    first = Guess(w, w, jnp.zeros_like(w), jnp.zeros((len(w), 2)))
    track, *_ = jax.lax.while_loop(more, advance, (track, first, jnp.array(True)))
    return track


def predict(g: Guess, done: Array, ahead: Array) -> Array:
    """The cubic through the last two states with their tangents where the path goes straight on, else the tangent."""
    length, past = jnp.linalg.norm(ahead), jnp.linalg.norm(done)
    ratio = length / jnp.maximum(past, 1e-300)
    straight = (ahead @ done > 0.999 * length * past) & (past > 0.0) & (ratio < 3.0)
    t = 1.0 + jnp.where(straight, ratio, 0.0)
    cubic = (2 * t**3 - 3 * t**2 + 1) * g.before + (t**3 - 2 * t**2 + t) * g.slope
    cubic = cubic + (3 * t**2 - 2 * t**3) * g.w + (t**3 - t**2) * (g.tangents @ done)
    return jnp.where(straight, cubic, g.w + g.tangents @ ahead)


def padded(targets: np.ndarray) -> np.ndarray:
    """Targets repeated up to the next power of two from 32, so that few lengths are compiled."""
    size = max(32, 1 << int(len(targets) - 1).bit_length())
    return np.concatenate([targets, np.repeat(targets[-1:], size - len(targets), axis=0)])
