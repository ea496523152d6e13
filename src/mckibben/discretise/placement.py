"""Where to put points before solving, from the end layer that the cylinder formula predicts."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.model.cylinder import cylinder_force, cylinder_length, end_layer
from mckibben.model.kinematics import radius
from mckibben.model.parameters import Parameters
from mckibben.model.point import Point
from mckibben.model.profile import evened

__all__ = ["crowding", "crowdings"]

UNIFORM = 0.5
"""Least crowding: points nearly uniform along the length."""
STEEPEST = 8.0
"""Largest crowding: beyond it the points of the middle are too far apart."""


@partial(kernel, static_argnums=())
def crowdings(p: Parameters, length: Array, force: Array, pressure: Array) -> Float[Array, " n"]:
    """b for each of n states of given length, or of given force where the length is NaN."""
    p = evened(p)
    angles = jnp.linspace(jnp.deg2rad(3.0), jnp.deg2rad(88.0), 341)

    def one(length: Array, force: Array, pressure: Array) -> Array:
        forces = jax.vmap(lambda theta: cylinder_force(theta, pressure, p))(angles)
        by_length = jnp.abs(cylinder_length(angles, p) - length)
        by_force = jnp.abs(forces - force)
        best = jnp.argmin(jnp.where(jnp.isnan(length), by_force, by_length))
        theta = angles[best]
        pull = jnp.where(jnp.isnan(force), forces[best], force)
        layer = end_layer(theta, pull + jnp.pi * radius(Point.cylinder(theta), p) ** 2 * pressure, p)
        return jnp.clip(0.5 * jnp.log(p.H0 / (3.0 * layer)), UNIFORM, STEEPEST)

    return jax.vmap(one)(length, force, pressure)


def crowding(p: Parameters, length: np.ndarray, force: np.ndarray, pressure: np.ndarray) -> float:
    """Crowding b of points that serves all the given states (NaN where length or force is not held)."""
    size = max(4, 1 << int(len(length) - 1).bit_length())
    padded = (np.concatenate([a, np.repeat(a[-1:], size - len(a))]) for a in (length, force, pressure))
    return float(np.max(np.asarray(crowdings(p, *padded))))
