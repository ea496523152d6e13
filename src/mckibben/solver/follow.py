"""Along a path of states in compiled code: tangent predictor, Newton on the bordered system, a stability check.

The unknowns are w = (u, force, pressure); the last two equations hold any two of length, volume, force and pressure.
Where a step cannot be taken the function stops and says how many states are good; nothing is lost.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from ..kernel import kernel
from ..lazy import Array, jax, jnp
from ..model.parameters import Number, Parameters
from .problem import Space

CORRECTIONS = 6
"""Newton systems a step may take; a good one needs two."""
LARGEST_CHANGE = 0.6
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""


class Track(NamedTuple):
    """States along a path."""

    w: Float[Array, "n w"]
    totals: Float[Array, "n 4"]
    residual: Float[Array, " n"]
    iterations: Int[Array, " n"]
    good: Int[Array, ""]  #: number of states reached, the given first one included


class _Step(NamedTuple):
    w: Array
    tangent: Array
    totals: Array
    residual: Array
    change: Array
    iterations: Array
    stable: Array


def bordered(space: Space, p: Parameters, b: Number, w: Array, select: Array, targets: Array) -> tuple[Array, ...]:
    """System matrix, right-hand side, totals, residual and the tangent stiffness on the constraints at w."""
    u, f, q = w[:-2], w[-2], w[-1]
    row = jnp.stack([jnp.ones_like(f), -f, -q, jnp.zeros_like(f)])
    a = space.assemble(p, b, u, row[None])
    K, G = a.tangents[0], a.gradients
    held = select[:, :2] @ G[1:3]
    have = jnp.concatenate([a.totals[1:3], w[-2:]])
    system = jnp.block([[K, -G[1:3].T], [held, select[:, 2:]]])
    miss = select @ have - targets
    rest = row @ G
    scale = jnp.abs(row) @ jnp.linalg.norm(G, axis=1)
    residual = jnp.maximum(jnp.linalg.norm(rest) / scale, jnp.abs(miss).max() / (1.0 + jnp.abs(targets).max()))
    # positive definite on the null space of what is held: augment the stiffness along the held gradients
    size = jnp.trace(jnp.abs(K)) / (1e-30 + jnp.sum(held**2))
    return system, jnp.concatenate([rest, miss]), a.totals, residual, K + 1e3 * size * held.T @ held


def _take(
    space: Space, p: Parameters, b: Number, w: Array, select: Array, targets: Array, ahead: Array, tol: Array
) -> _Step:
    """Correct w onto the targets; also the tangent dw for the change of targets that lies ahead."""

    def more(carry: tuple[_Step, Array]) -> Array:
        step, last = carry
        return (step.iterations < CORRECTIONS) & (last > tol)

    def newton(carry: tuple[_Step, Array]) -> tuple[_Step, Array]:
        step, _ = carry
        system, miss, totals, residual, augmented = bordered(space, p, b, step.w, select, targets)
        sides = jnp.stack([-miss, jnp.concatenate([jnp.zeros_like(miss[:-2]), ahead])], axis=1)
        change, tangent = jnp.linalg.solve(system, sides).T
        stable = jnp.isfinite(jnp.linalg.cholesky(augmented)).all()
        size = jnp.abs(change[:-2]).max()
        # Newton converges quadratically: the totals after the step follow from the linear model to its square
        G = -system[:-2, -2:].T
        after = totals.at[1:3].add(G @ change[:-2])
        return _Step(step.w + change, tangent, after, residual, step.change, step.iterations + 1, stable), size

    none = jnp.zeros_like(w)
    start = _Step(w, none, jnp.zeros(4), jnp.asarray(jnp.inf), jnp.zeros(()), jnp.zeros((), int), jnp.array(False))
    step, last = jax.lax.while_loop(more, newton, (start, jnp.asarray(jnp.inf)))
    return step._replace(change=last)


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
    n, psi = targets.shape[0], space.basis.slope_factor(p) * space.mesh(p, b).fields[:, 0]
    track = Track(
        jnp.zeros((n, w.shape[0])), jnp.zeros((n, 4)), jnp.full(n, jnp.inf), jnp.zeros(n, int), jnp.zeros((), int)
    )
    none = jnp.zeros_like(w)
    given = _Step(w, none, jnp.zeros(4), jnp.asarray(jnp.inf), jnp.zeros(()), jnp.zeros((), int), jnp.array(True))

    def more(carry: tuple[Track, _Step, Array, Array]) -> Array:
        track, _, _, going = carry
        return going & (track.good < count)

    def advance(carry: tuple[Track, _Step, Array, Array]) -> tuple[Track, _Step, Array, Array]:
        track, last, before, _ = carry
        k = track.good  # for k = 0 the given state is corrected where it stands, which also gives the tangent
        now, previous = targets[k], targets[jnp.maximum(k - 1, 0)]
        guess = _predict(last, before, previous - targets[jnp.maximum(k - 2, 0)], now - previous, k)
        ahead = targets[jnp.minimum(k + 1, n - 1)] - now
        step = _take(space, p, b, guess, select, now, ahead, tolerance)
        moved = jnp.abs(psi @ (step.w - last.w)[:-2]).max()
        ok = (step.change <= tolerance) & (moved < LARGEST_CHANGE) & step.stable & jnp.isfinite(step.w).all()
        ok = ok | (k == 0)
        kept = Track(
            track.w.at[k].set(step.w),
            track.totals.at[k].set(step.totals),
            track.residual.at[k].set(step.residual),
            track.iterations.at[k].set(step.iterations),
            jnp.where(ok, k + 1, k),
        )
        return kept, step, last.w, ok

    track, *_ = jax.lax.while_loop(more, advance, (track, given, w, jnp.array(True)))
    return track


def _predict(last: _Step, before: Array, done: Array, ahead: Array, k: Array) -> Array:
    """Tangent prediction, with the curvature of the last step added where there was one.

    `last.tangent` is dw for the whole step ahead; with t the ratio of the step ahead to the one done, the parabola
    through `before` and `last` with that end tangent is w + dw + (t dw - t^2 (w - before)) ... of third-order error.
    """
    ratio = jnp.linalg.norm(ahead) / jnp.maximum(jnp.linalg.norm(done), 1e-300)
    curve = ratio * last.tangent - ratio**2 * (last.w - before)
    smooth = (k > 1) & (ratio < 3.0)
    return last.w + last.tangent + jnp.where(smooth, curve, 0.0)


def padded(targets: np.ndarray) -> np.ndarray:
    """Targets repeated up to the next power of two from 32, so that few lengths are compiled."""
    size = max(32, 1 << int(len(targets) - 1).bit_length())
    return np.concatenate([targets, np.repeat(targets[-1:], size - len(targets), axis=0)])
