"""How stable a state is: negative modes of the tangent stiffness on what the control leaves free.

Three counts: symmetric modes under length control, symmetric modes under force control, antisymmetric modes (which
change neither length nor volume to first order, so the control does not matter to them).
"""

from typing import NamedTuple

import attrs
import numpy as np
from jaxtyping import Float

from ..discretise.assemble import carry, localise
from ..discretise.line import Line
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
    if not (isinstance(space.basis, Line) and space.basis.half):
        none = jnp.zeros((len(u), 0, 0))
        return Stiffness(tangent, gradients, base.totals, base.state, none, jnp.zeros((len(u), 0)))
    basis = attrs.evolve(space.basis, modes="even")
    even = jax.vmap(carry, (None, 0, 0))(basis.mesh(p, b), local, rows)
    # antisymmetric theta is zero at mid-length: half of the closure, and the change at a free end
    closure = 0.5 * even.gradients[:, CLOSURE]
    if basis.ends == "free":
        closure = closure.at[:, -1].add(1.0)
    return Stiffness(tangent, gradients, base.totals, base.state, even.tangents[:, 0], closure)


def count_modes(space: Space, s: Stiffness, pressure_held: bool = True) -> list[Modes]:
    """Modes of each state; with the volume held instead of the pressure its gradient is a constraint too."""
    always = ([] if pressure_held else [VOLUME]) + ([CLOSURE] if space.basis.closes else [])
    found = []
    for k in range(len(s.tangent)):
        K, G = np.asarray(s.tangent[k]), np.asarray(s.gradients[k])
        length, soft_length = negative(K, G[[LENGTH, *always]])
        force, soft_force = negative(K, G[always])
        anti, soft_anti = None, None
        if s.closure.shape[1]:
            anti, soft_anti = negative(np.asarray(s.antisymmetric[k]), np.asarray(s.closure[k])[None])
        found.append(Modes(length, force, anti, soft_length, soft_force, soft_anti))
    return found


def weakest(s: Stiffness) -> tuple[np.ndarray, float]:
    """The softest antisymmetric mode of the first state, in coefficients of the even modes, and its stiffness."""
    null = null_space(np.asarray(s.closure[0])[None])
    values, vectors = np.linalg.eigh(null.T @ np.asarray(s.antisymmetric[0]) @ null)
    return np.asarray(null @ vectors[:, 0]), float(values[0])


def null_space(constraints: np.ndarray) -> np.ndarray:
    """Orthonormal basis of what the constraint rows leave free; rows that are zero constrain nothing."""
    size = np.abs(constraints).max(axis=1)
    rows = constraints[size > 1e-10 * max(1.0, float(size.max(initial=0.0)))]
    if not len(rows):
        return np.eye(constraints.shape[1])
    return np.asarray(np.linalg.qr(rows.T, mode="complete")[0][:, len(rows) :])


def negative(K: np.ndarray, constraints: np.ndarray) -> tuple[int, float]:
    """Number of negative eigenvalues of K on the null space of the constraint rows, and the least over the largest.

    (-1, NaN) where K is not finite.
    """
    if not np.isfinite(K).all():
        return -1, float("nan")
    null = null_space(constraints)
    values = np.linalg.eigvalsh(null.T @ K @ null)
    size = float(np.abs(values).max())
    return int((values < -1e-12 * size).sum()), float(values[0]) / size
