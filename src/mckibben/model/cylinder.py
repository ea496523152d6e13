"""The uniform cylinder with stored energy, in closed form: oracle, first guess and instant answer.

It is the state of a long muscle away from its ends: psi = 0 and theta uniform (theory page, closed forms).
"""

import jax
import jax.numpy as jnp

from mckibben.model.angle import radians
from mckibben.model.energy import lagrangian, stored
from mckibben.model.gap import inflated, leaves
from mckibben.model.kinematics import radius, volume_rate
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point

__all__ = ["cylinder_angle", "cylinder_force", "cylinder_length", "cylinder_volume", "end_layer", "inside_at_rest"]


def cylinder_force(theta: Number, pressure: Number, p: Parameters) -> Number:
    """Axial force [N], positive in tension, of a cylinder at braid angle theta [rad] and gauge pressure [Pa].

    F = [dw/dtheta - P d(pi r^2 s)/dtheta] / (ds/dtheta); with no stored energy this is Eq. (31).
    """
    if leaves(p):
        slope = jax.grad(lambda t: lagrangian(Point.cylinder(t), p, 0.0, pressure))(theta)
        return slope * jnp.sin(p.theta0) / jnp.cos(theta)
    energy = jax.grad(lambda t: stored(Point.cylinder(t), p))(theta)
    volume = jax.grad(lambda t: cylinder_volume(t, p) / p.H0)(theta)
    return (energy - pressure * volume) * jnp.sin(p.theta0) / jnp.cos(theta)


def cylinder_length(theta: Number, p: Parameters) -> Number:
    """Length [m] between the fittings of the cylinder at braid angle theta [rad]."""
    active = p.H0 * jnp.sin(theta) / jnp.sin(p.theta0)
    return active if p.dead is None else active + p.dead


def cylinder_angle(length: Number, p: Parameters) -> Number:
    """Braid angle [rad] of the cylinder of a length between the fittings [m]; 90 deg at and beyond full extension."""
    return jnp.arcsin(jnp.clip(p.active(length) / p.H0 * jnp.sin(p.theta0), 0.0, 1.0))


def cylinder_volume(theta: Number, p: Parameters) -> Number:
    """Enclosed volume [m^3] of the cylinder; largest at the magic angle arctan(1/sqrt 2) (Fig. 1)."""
    return jnp.pi * radius(Point.cylinder(theta), p) ** 2 * p.active(cylinder_length(theta, p))


def inside_at_rest(p: Parameters) -> Number:
    """Volume [m^3] that the pressure fills in a muscle as mounted, without any: of a chamber that may leave the braid,
    its own."""
    return p.H0 * volume_rate(inflated(Point.cylinder(radians(p.theta0)), 0.0, p), p)


def end_layer(theta: Number, tension: Number, p: Parameters) -> Number:
    """Width [m, along v] of the boundary layer at a fitting, for mesh tension F + pi r^2 P [N] at angle theta.

    Bending against tension: delta = sin(theta0) sqrt(N Be / (tension sin(theta))) with
    Be = B2 sin^2(theta) + B3 cos^2(theta); right within a factor 3, which is all that point placement needs.
    """
    stiffness = p.B2 * jnp.sin(theta) ** 2 + p.B3 * jnp.cos(theta) ** 2
    return jnp.sin(p.theta0) * jnp.sqrt(p.N * stiffness / (jnp.abs(tension) * jnp.sin(theta)))
