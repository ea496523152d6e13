"""How stable a state is: negative modes of the tangent stiffness on what the control leaves free.

Three counts: symmetric modes under length control, symmetric modes under force control, antisymmetric modes (which
change neither length nor volume to first order, so the control does not matter to them).
"""

from typing import Any, NamedTuple

import attrs
import numpy as np
from jaxtyping import Float

from ..discretise.assemble import carry, localise
from ..discretise.mesh import values
from ..kernel import kernel
from ..lazy import Array, jax, jnp
from ..model.parameters import Number, Parameters
from ..verdict import Modes
from .problem import CLOSURE, LENGTH, VOLUME, Space


class Stiffness(NamedTuple):
    """Tangents of n states: symmetric (or full) with the four gradients, antisymmetric with its one constraint."""

    tangent: Float[Array, "n m m"]
    gradients: Float[Array, "n 4 m"]
    totals: Float[Array, "n 4"]
    state: Float[Array, "n q d"]
    antisymmetric: Float[Array, "n a a"]
    closure: Float[Array, "n a"]


@kernel
def stiffness(space: Space, p: Parameters, b: Number, u: Float[Array, "n m"], loads: Float[Array, "n 4"]) -> Stiffness:
    """Tangent stiffness of states u under loads (1, force, pressure, closure), dimensionless."""
    rows = jnp.concatenate([jnp.ones((len(u), 1)), -loads[:, 1:]], axis=1)[:, None]
    mesh, form, density = space.mesh(p, b), space.basis.form, space.density(p)
    local = jax.vmap(lambda u: localise(form, density, values(mesh, form, u, p), p))(u)
    base = jax.vmap(carry, (None, 0, 0))(mesh, local, rows)
    tangent, gradients = base.tangents[:, 0], base.gradients
    if not space.half:
        none = jnp.zeros((len(u), 0, 0))
        return Stiffness(tangent, gradients, base.totals, base.state, none, jnp.zeros((len(u), 0)))
    basis = attrs.evolve(space.line, modes="even")
    even = jax.vmap(carry, (None, 0, 0))(basis.mesh(p, b), local, rows)
    # antisymmetric theta is zero at mid-length: half of the closure, and the change at a free end
    closure = 0.5 * even.gradients[:, CLOSURE]
    if basis.ends == "free":
        closure = closure.at[:, -1].add(1.0)
    return Stiffness(tangent, gradients, base.totals, base.state, even.tangents[:, 0], closure)


def count_modes(space: Space, s: Stiffness, pressure_held: bool = True) -> list[Modes]:
    """Modes of each state; with the volume held instead of the pressure its gradient is a constraint too."""
    always = ([] if pressure_held else [VOLUME]) + ([CLOSURE] if space.basis.closes else [])
    K, G, closure = np.asarray(s.tangent), np.asarray(s.gradients), np.asarray(s.closure)
    lengths, forces = negative(K, G[:, [LENGTH, *always]]), negative(K, G[:, always])
    sideways: list[Any] = [(None, None)] * len(K)
    if closure.shape[1]:
        sideways = negative(np.asarray(s.antisymmetric), closure[:, None])
    return [
        Modes(length, force, anti, soft_length, soft_force, soft_anti)
        for (length, soft_length), (force, soft_force), (anti, soft_anti) in zip(lengths, forces, sideways, strict=True)
    ]


def weakest(s: Stiffness) -> tuple[np.ndarray, float]:
    """The softest antisymmetric mode of the first state, in coefficients of the even modes, and its stiffness."""
    closure = np.asarray(s.closure[0])[None]
    null = null_space(closure[binding(closure)])
    values, vectors = np.linalg.eigh(null.T @ np.asarray(s.antisymmetric[0]) @ null)
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
