"""Where to put points before solving: the end layer that the cylinder formula foretells."""

import numpy as np
from jaxtyping import Float

from ..kernel import kernel
from ..lazy import Array, jax, jnp
from ..model.cylinder import cylinder_force, cylinder_length, end_layer
from ..model.kinematics import radius
from ..model.parameters import Law, Parameters

UNIFORM, STEEPEST = 0.5, 8.0


@kernel
def crowdings(law: Law, p: Parameters, length: Array, force: Array, pressure: Array) -> Float[Array, " n"]:
    """b for each of n states of given length, or of given force where the length is NaN."""
    angles = jnp.linspace(jnp.deg2rad(3.0), jnp.deg2rad(88.0), 341)

    def one(length: Array, force: Array, pressure: Array) -> Array:
        forces = jax.vmap(lambda theta: cylinder_force(theta, pressure, p, law))(angles)
        by_length = jnp.abs(cylinder_length(angles, p) - length)
        by_force = jnp.abs(forces - force)
        best = jnp.argmin(jnp.where(jnp.isnan(length), by_force, by_length))
        theta = angles[best]
        pull = jnp.where(jnp.isnan(force), forces[best], force)
        layer = end_layer(theta, pull + jnp.pi * radius(theta, p) ** 2 * pressure, p)
        return jnp.clip(0.5 * jnp.log(p.H0 / (3.0 * layer)), UNIFORM, STEEPEST)

    return jax.vmap(one)(length, force, pressure)


def crowding(law: Law, p: Parameters, length: np.ndarray, force: np.ndarray, pressure: np.ndarray) -> float:
    """Crowding b of points that serves all the given states (NaN where length or force is not held)."""
    size = max(32, 1 << int(len(length) - 1).bit_length())
    padded = (np.concatenate([a, np.repeat(a[-1:], size - len(a))]) for a in (length, force, pressure))
    return float(np.max(np.asarray(crowdings(law, p, *padded))))
