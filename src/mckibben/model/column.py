"""The muscle as a column: its bending stiffness, and the push from which it bows sideways (theory page, column)."""

import jax
import jax.numpy as jnp

from mckibben.model.energy import stored
from mckibben.model.kinematics import radius
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point

__all__ = ["bending_stiffness", "column_load"]


def bending_stiffness(theta: Number, force: Number, pressure: Number, p: Parameters) -> Number:
    """Bending stiffness B [N m^2] of the cylinder at a braid angle [rad], axial force [N] and gauge pressure [Pa].

    B = r^2 [s w''/2 + (F + 2 pi r^2 P + pi r^2 P tan^2(theta)) tan^2(theta)], with w'' the second derivative of the
    stored energy by the axial stretch s. A section stays round, and every place keeps to its own axial stretch.
    """
    s = jnp.sin(theta) / jnp.sin(p.theta0)

    def energy(stretch: Number) -> Number:
        return stored(Point.cylinder(jnp.arcsin(stretch * jnp.sin(p.theta0))), p)

    area, steep = jnp.pi * radius(Point.cylinder(theta), p) ** 2, jnp.tan(theta) ** 2
    own = 0.5 * s * jax.grad(jax.grad(energy))(s)
    return area / jnp.pi * (own + (force + area * pressure * (2.0 + steep)) * steep)


def column_load(length: Number, stiffness: Number) -> Number:
    """Push [N] from which a column [m] bows whose ends neither turn nor move aside: 4 pi^2 B/h^2 (Euler)."""
    return 4.0 * jnp.pi**2 * stiffness / length**2
