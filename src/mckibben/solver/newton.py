"""One Newton step on the equations and the rows that are held, by one Cholesky factor."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from mckibben.compiled.arrays import Array
from mckibben.solver.held import Conditions
from mckibben.solver.system import System, Unknowns

__all__ = [
    "HEAVY",
    "MOST",
    "WORK",
    "Correction",
    "batch_size",
    "bordered",
    "correct",
    "grip",
    "positive",
    "small_solve",
]

HEAVY = 1e3
"""Stiffness of what holds a value over the sum of all others: enough for any stable state, and costs three digits."""


WORK = 200_000
"""Operations: jaxlib hands a batch of factorisations of as many or more to the threads on which the program itself
runs, which then wait for each other: it was seen to stop for ever."""
FEW = 4
"""Terms of a matrix product up to which each is written out."""
MOST = 64
"""Muscles in step on a processor: more do not fit in its cache."""
MANY = 1024
"""Muscles in step on other devices."""


def batch_size(unknowns: int) -> int:
    """How many muscles advance in step: a power of two."""
    if jax.default_backend() != "cpu":
        return MANY
    return int(np.clip(2 ** np.floor(np.log2(0.99 * WORK / (unknowns**3 / 3.0))), 1, MOST))


class Correction(NamedTuple):
    """A Newton step, the change of the state by each target, and whether the state is a minimum."""

    step: Unknowns
    tangents: Unknowns  #: (m, l) and (l, l): one column for each target
    stable: Bool[Array, ""]


def product(a: Float[Array, "r k"], b: Float[Array, "k c"]) -> Float[Array, "r c"]:
    """Matrix product of few rows or terms as sums, which a compiler joins with what is around them."""
    if len(b) <= FEW:
        return sum(a[:, k, None] * b[None, k] for k in range(len(b)))
    return jnp.sum(a[:, :, None] * b[None, :, :], axis=1)


def grip(s: System, c: Conditions) -> tuple[Float[Array, "r m"], Float[Array, " r"]]:
    """Gradients of the rows through the totals, and how stiffly each of them holds.

    A row that holds a total holds it as stiffly as can be told, one that gives a load not at all; in between, as with
    gas or a spring, the load answers to a change of its total: by 1/(dg/dT dg/dL) for the row g(T, L).
    """
    A = product(c.by_totals, s.gradients)
    heavy = HEAVY * jnp.trace(jnp.abs(s.stiffness)) / jnp.maximum(jnp.sum(A**2), 1e-30)
    return A, 1.0 / (jnp.sum(c.by_totals * c.by_loads, axis=1) + 1.0 / heavy)


def correct(s: System, c: Conditions) -> Correction:
    """Solve K du - G^T dl = -rest, A du + B dl = -miss, where A and B are the rows' derivatives by shape and loads.

    K plus the rows' squares, weighted by how they hold, is positive definite where the state is stable under them.
    """
    A, weight = grip(s, c)
    factor = jnp.linalg.cholesky(s.stiffness + product(A.T * weight, A))
    stable = jnp.isfinite(factor).all()
    solved = jax.scipy.linalg.cho_solve((factor, True), jnp.concatenate([s.rest[:, None], s.gradients.T], axis=1))
    y, Y = solved[:, 0], solved[:, 1:]
    Z = product(Y, c.by_totals.T) * weight
    on_loads = Y - product(Z, c.by_loads)  # du = on_loads dl - y - Z g, with g = miss, or its change by a target
    sides = jnp.concatenate([c.miss[:, None], jnp.diag(c.by_target)], axis=1)
    lead = jnp.concatenate([y[:, None], jnp.zeros((len(y), len(c.miss)))], axis=1) + product(Z, sides)
    dl = small_solve(product(A, on_loads) + c.by_loads, product(A, lead) - sides)
    du = product(on_loads, dl) - lead
    return Correction(Unknowns(du[:, 0], dl[:, 0]), Unknowns(du[:, 1:], dl[:, 1:]), stable)


def bordered(s: System, c: Conditions) -> Float[Array, "w w"]:
    """The matrix of the equations and rows by (shape, loads)."""
    return jnp.block([[s.stiffness, -s.gradients.T], [c.by_totals @ s.gradients, c.by_loads]])


def small_solve(matrix: Float[Array, "l l"], sides: Float[Array, "l k"]) -> Float[Array, "l k"]:
    """Solution of two equations by Cramer's rule, which takes no call of a library; of three by LAPACK."""
    if len(matrix) == 2:
        (a, b), (e, f) = matrix
        return jnp.stack([f * sides[0] - b * sides[1], a * sides[1] - e * sides[0]]) / (a * f - b * e)
    return jnp.linalg.solve(matrix, sides)


def positive(K: Float[Array, "m m"], held: Float[Array, "c m"]) -> Bool[Array, ""]:
    """Whether K is positive definite on what the rows `held` leave free."""
    size = jnp.trace(jnp.abs(K)) / jnp.maximum(jnp.sum(held**2), 1e-30)
    return jnp.isfinite(jnp.linalg.cholesky(K + size * product(held.T, held))).all()
