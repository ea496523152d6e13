"""How stable a state is: negative modes of the tangent stiffness on what the control leaves free.

Three counts: symmetric modes under length control, symmetric modes under force control, antisymmetric modes (which
change neither length nor volume to first order, so the control does not matter to them).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place
from mckibben.model.parameters import Number, Parameters
from mckibben.results.verdict import Modes
from mckibben.solver.held import GASES, conditions, rows_of
from mckibben.solver.newton import grip
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.system import Local, System, Unknowns, assemble, closing, localise, stiffness

__all__ = ["Tangents", "binding", "count_modes", "negative", "null_space", "stiffnesses", "tangents", "weakest"]


class Tangents(NamedTuple):
    """Tangents of states: symmetric (or full) with the gradients, antisymmetric with its conditions, or none."""

    stiffness: Float[Array, "*n m m"]
    gradients: Float[Array, "*n l m"]
    antisymmetric: Float[Array, "*n a a"]
    closure: Float[Array, "*n c a"]


def stiffnesses(basis: Basis, on: Placed, local: Local, s: System, together: bool = False) -> Tangents:
    """Of one state, from its pointwise derivatives."""
    if not basis.half:
        return Tangents(s.stiffness, s.gradients, jnp.zeros((0, 0)), jnp.zeros((1, 0)))
    return Tangents(
        s.stiffness, s.gradients, stiffness(basis.even(), on, local, together), closing(basis, on, local)
    )  # fmt: skip


@kernel
def tangents(
    static: tuple[Basis, Any], p: Parameters, b: Number, states: Unknowns, which: Any, targets: Float[Array, " l"]
) -> Tangents:
    """Tangents of n states, with the stiffness of what answers a change of volume: that of the gas, if it is sealed."""
    basis, own = static
    on = place(basis, p, b)

    def one(state: Unknowns) -> Tangents:
        local = localise(basis, on, state)
        s = assemble(basis, on, local, len(state.loads))
        found = stiffnesses(basis, on, local, s)
        A, weight = grip(s, conditions(own, which, targets, on, s, state.loads))
        return found._replace(stiffness=s.stiffness + (A[1:2].T * weight[1:2]) @ A[1:2])

    return jax.vmap(one)(states)


def of_states(
    problem: Problem, u: np.ndarray, loads: np.ndarray, names: tuple[Any, ...] = (), memory: Any = None
) -> Tangents:
    """Tangents of states u (n, m) under loads (n, l) on a problem; only the gas among `names` counts, and a volume held
    in a chamber that may leave the braid: it still gives way where that swells."""
    softly = (*GASES, "volume") if problem.leaves else GASES
    gas = next((name for name in names if name in softly), "pressure")
    own, which = rows_of(("length", gas), problem.loads)
    states = Unknowns(u, loads, memory)
    targets = np.zeros(problem.loads)
    return Tangents(*map(np.asarray, tangents((problem.basis, own), problem.p, problem.b, states, which, targets)))


def count_modes(problem: Problem, t: Tangents, pressure_held: bool = True) -> list[Modes]:
    """Modes of each state; with the volume held instead of the pressure its gradient is a constraint too."""
    always = ([] if pressure_held else [1]) + ([2] if problem.basis.closes else [])
    lengths, forces = (negative(t.stiffness, t.gradients[:, rows]) for rows in ([0, *always], always))
    sideways: list[Any] = [(None, None)] * len(t.stiffness)
    if t.closure.shape[2]:
        sideways = negative(t.antisymmetric, t.closure)
    return [
        Modes(length, force, anti, soft_length, soft_force, soft_anti)
        for (length, soft_length), (force, soft_force), (anti, soft_anti) in zip(lengths, forces, sideways, strict=True)
    ]


def weakest(t: Tangents) -> tuple[np.ndarray, float]:
    """The softest antisymmetric mode of the first state, in coefficients of the even modes, and its stiffness."""
    closure = np.asarray(t.closure[0])
    null = null_space(closure[binding(closure)])
    values, vectors = np.linalg.eigh(null.T @ np.asarray(t.antisymmetric[0]) @ null)
    return np.asarray(null @ vectors[:, 0]), float(values[0])


def binding(constraints: np.ndarray) -> np.ndarray:
    """Which constraint rows (..., c, m) constrain anything: those that are not zero."""
    size = np.abs(constraints).max(axis=-1)
    return np.asarray(size > 1e-10 * np.maximum(1.0, size.max(axis=-1, initial=0.0))[..., None])


def null_space(constraints: np.ndarray) -> np.ndarray:
    """Orthonormal basis (..., m, m - c) of what constraint rows (..., c, m) leave free."""
    return np.asarray(np.linalg.qr(constraints.swapaxes(-1, -2), mode="complete")[0][..., constraints.shape[-2] :])


def negative(K: np.ndarray, constraints: np.ndarray) -> list[tuple[int, float]]:
    """Number of negative eigenvalues of each K (n, m, m) on what its constraint rows (n, c, m) leave free, and the
    least over the largest.

    (-1, NaN) where K is not finite.
    """
    found, finite, bound = [(-1, float("nan"))] * len(K), np.isfinite(K).all(axis=(1, 2)), binding(constraints)
    for pattern in {tuple(row) for row in bound[finite].tolist()}:  # nearly always one
        some = np.flatnonzero(finite & (bound == pattern).all(axis=1))
        null = null_space(constraints[some][:, list(pattern)])
        values = np.linalg.eigvalsh(null.swapaxes(1, 2) @ K[some] @ null)
        size = np.abs(values).max(axis=1)
        counts, softest = (values < -1e-12 * size[:, None]).sum(axis=1), values[:, 0] / size
        for k, count, soft in zip(some, counts, softest, strict=True):
            found[k] = (int(count), float(soft))
    return found
