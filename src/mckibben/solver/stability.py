"""How stable a state is: negative modes of the tangent stiffness on what the control leaves free.

Three counts: symmetric modes under length control, symmetric modes under force control, antisymmetric modes (which
change neither length nor volume to first order, so the control does not matter to them).
"""

from functools import partial
from typing import NamedTuple

import attrs
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..discretise.assemble import carry, localise
from ..discretise.line import Line
from ..discretise.mesh import values
from ..model.parameters import Number, Parameters
from .problem import CLOSURE, LENGTH, VOLUME, Space


class Stiffness(NamedTuple):
    """Tangents of n states: symmetric (or full) with the four gradients, antisymmetric with its one constraint."""

    tangent: Float[Array, "n m m"]
    gradients: Float[Array, "n 4 m"]
    totals: Float[Array, "n 4"]
    state: Float[Array, "n q d"]
    antisymmetric: Float[Array, "n a a"]
    closure: Float[Array, "n a"]


@partial(jax.jit, static_argnums=0)
def stiffness(space: Space, p: Parameters, b: Number, u: Float[Array, "n m"], loads: Float[Array, "n 4"]) -> Stiffness:
    """Tangent stiffness of states u under loads (1, force, pressure, closure), dimensionless."""
    rows = jnp.concatenate([jnp.ones((len(u), 1)), -loads[:, 1:]], axis=1)[:, None]
    mesh, form, density = space.mesh(p, b), space.basis.form, space.density(p)
    local = jax.vmap(lambda u: localise(form, density, values(mesh, form, u, p), p))(u)
    base = jax.vmap(carry, (None, 0, 0))(mesh, local, rows)
    tangent, gradients = base.tangents[:, 0], base.gradients
    if not (isinstance(space.basis, Line) and space.basis.half):
        none = jnp.zeros((len(u), 0, 0))
        return Stiffness(tangent, gradients, base.totals, base.state, none, none[:, :, 0])
    basis = attrs.evolve(space.basis, modes="even")
    even = jax.vmap(carry, (None, 0, 0))(basis.mesh(p, b), local, rows)
    # antisymmetric theta is zero at mid-length: half of the closure, and the change at a free end
    closure = 0.5 * even.gradients[:, CLOSURE]
    if basis.ends == "free":
        closure = closure.at[:, -1].add(1.0)
    return Stiffness(tangent, gradients, base.totals, base.state, even.tangents[:, 0], closure)


@attrs.frozen
class Modes:
    """Numbers of negative modes; None where a discretisation does not separate them."""

    length_control: int
    force_control: int
    antisymmetric: int | None

    @property
    def total_under(self) -> tuple[int, int]:
        """Negative modes of any symmetry under length control and under force control."""
        anti = self.antisymmetric or 0
        return self.length_control + anti, self.force_control + anti


def count_modes(space: Space, s: Stiffness, pressure_held: bool = True) -> list[Modes]:
    """Negative modes of each state; with the volume held instead of the pressure its gradient is a constraint too."""
    always = ([] if pressure_held else [VOLUME]) + ([CLOSURE] if space.basis.closes else [])
    found = []
    for k in range(len(s.tangent)):
        K, G = np.asarray(s.tangent[k]), np.asarray(s.gradients[k])
        length, force = negative(K, G[[LENGTH, *always]]), negative(K, G[always])
        anti = negative(np.asarray(s.antisymmetric[k]), np.asarray(s.closure[k])[None]) if s.closure.shape[1] else None
        found.append(Modes(length, force, anti))
    return found


def negative(K: np.ndarray, constraints: np.ndarray) -> int:
    """Number of negative eigenvalues of K on the null space of the constraint rows; -1 where K is not finite."""
    if not np.isfinite(K).all():
        return -1
    rows = constraints[np.abs(constraints).max(axis=1) > 1e-10 * max(1.0, float(np.abs(constraints).max(initial=0.0)))]
    if len(rows):
        null = np.linalg.qr(rows.T, mode="complete")[0][:, len(rows) :]
        K = null.T @ K @ null
    values = np.linalg.eigvalsh(K)
    return int((values < -1e-12 * np.abs(values).max()).sum())
