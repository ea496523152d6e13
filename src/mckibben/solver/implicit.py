"""Derivatives of a state that is known, by the implicit function theorem.

The unknowns w = (u, force, pressure) satisfy R(w; p, targets) = 0: equilibrium and the two quantities that are held. So

    dw = -(dR/dw)^-1 (dR/dp dp + dR/dtargets dtargets)

however w was found. The placement of points and the units of the quantities are held fixed: the state depends on them
only by its discretisation error.
"""

from functools import partial
from typing import Any

from jaxtyping import Float

from ..discretise.assemble import totals
from ..lazy import Array, jax, jnp
from ..model.parameters import Number, Parameters
from .problem import LENGTH, VOLUME, Space, bordered


def potential(
    space: Space, p: Parameters, b: Number, w: Float[Array, " w"]
) -> tuple[Float[Array, " u"], Float[Array, "4"]]:
    """Gradient of the potential energy by u, and the values of `NAMES` (length, volume, force, pressure)."""
    signs = jnp.stack([jnp.ones_like(w[-2]), -w[-2], -w[-1], jnp.zeros_like(w[-1])])
    mesh, form, density = space.mesh(p, b), space.basis.form, space.density(p)

    def energy(u: Array) -> tuple[Array, Array]:
        found = totals(mesh, form, density, u, p)
        return signs @ found, found

    rest, found = jax.grad(energy, has_aux=True)(w[:-2])
    return rest, jnp.concatenate([found[LENGTH : VOLUME + 1], w[-2:]])


def imbalance(
    space: Space, p: Parameters, b: Number, w: Float[Array, " w"], select: Any, targets: Float[Array, "2"]
) -> Float[Array, " w"]:
    """R: the gradient of the potential energy by u, and what is held minus its targets; dimensionless."""
    rest, have = potential(space, p, b, w)
    return jnp.concatenate([rest, select @ have - targets])


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def settle(
    space: Space, w: Float[Array, " w"], p: Parameters, b: Number, select: Any, targets: Float[Array, "2"]
) -> Float[Array, " w"]:
    """w, which must be a state, as a function of p and targets, differentiable to any order; NaN stays NaN."""
    return w


@settle.defjvp
def _settle_jvp(space: Space, primals: Any, tangents: Any) -> tuple[Any, Any]:
    w, p, b, select, targets = primals
    _, dp, _, _, dtargets = tangents
    # Not w, which is constant, but the state, which depends on p in turn: that gives the higher derivatives.
    state = settle(space, w, p, b, select, targets)
    good = jnp.isfinite(state).all()
    safe = jnp.where(good, state, 0.0)
    system = jnp.where(good, bordered(space, p, b, safe, select, targets)[0], jnp.eye(len(w)))
    _, change = jax.jvp(lambda p, targets: imbalance(space, p, b, safe, select, targets), (p, targets), (dp, dtargets))
    return state, -jnp.linalg.solve(system, change)
