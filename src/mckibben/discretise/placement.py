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

__all__ = ["crowding", "crowdings", "crowdings_at"]

UNIFORM = 0.5
"""Least crowding: points nearly uniform along the length."""
STEEPEST = 8.0
"""Largest crowding: beyond it the points of the middle are too far apart."""


@partial(kernel, static_argnums=())
def crowdings(p: Parameters, length: Array, force: Array, pressure: Array) -> Float[Array, " n"]:
    """b for each of n states of given length, or of given force where the length is NaN."""
    p, angles = evened(p), _angles()

    def one(length: Array, force: Array, pressure: Array) -> Array:
        forces = jax.vmap(lambda theta: cylinder_force(theta, pressure, p))(angles)
        by_length = jnp.abs(cylinder_length(angles, p) - length)
        by_force = jnp.where(jnp.isnan(forces), jnp.inf, jnp.abs(forces - force))  # no cylinder whose bore is closed
        best = jnp.argmin(jnp.where(jnp.isnan(length), by_force, by_length))
        return _crowding(angles[best], jnp.where(jnp.isnan(force), forces[best], force), pressure, p)

    return jax.vmap(one)(length, force, pressure)


@partial(kernel, static_argnums=())
def crowdings_at(p: Parameters, length: Array, pressure: Array) -> Float[Array, " n"]:
    """That of `crowdings` for n states of given length, without the force at every angle."""
    p, angles = evened(p), _angles()

    def one(length: Array, pressure: Array) -> Array:
        theta = angles[jnp.argmin(jnp.abs(cylinder_length(angles, p) - length))]
        return _crowding(theta, cylinder_force(theta, pressure, p), pressure, p)

    return jax.vmap(one)(length, pressure)


def _angles() -> Array:
    return jnp.linspace(jnp.deg2rad(3.0), jnp.deg2rad(88.0), 341)


def _crowding(theta: Array, pull: Array, pressure: Array, p: Parameters) -> Array:
    pull = jnp.where(jnp.isnan(pull), 0.0, pull)  # of a cylinder whose bore is closed
    layer = end_layer(theta, pull + jnp.pi * radius(Point.cylinder(theta), p) ** 2 * pressure, p)
    return jnp.clip(0.5 * jnp.log(p.H0 / (3.0 * layer)), UNIFORM, STEEPEST)


def crowding(p: Parameters, length: np.ndarray, force: np.ndarray, pressure: np.ndarray) -> float:
    """Crowding b of points that serves all the given states (NaN where length or force is not held)."""
    size = max(4, 1 << int(len(length) - 1).bit_length())
    length, force, pressure = (np.concatenate([a, np.repeat(a[-1:], size - len(a))]) for a in (length, force, pressure))
    held = not np.isnan(length).any() and np.isnan(force).all()
    found = crowdings_at(p, length, pressure) if held else crowdings(p, length, force, pressure)
    return float(np.max(np.asarray(found)))
