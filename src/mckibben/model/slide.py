"""A chamber inside that slides along the mesh: friction between the two, elastic up to the shear at which it slides.

What lies beside a place v of the mesh was mounted at v + slide, so that there are 1 + slide' times as much of the
chamber and its axial stretch is less by as much (`wall.lying`). A change of the slide moves the chamber by s/(1 +
slide') of it along the mesh, against a shear stress of at most mu p, with the pressure p of the chamber on the mesh:

    f = clip(K (slide - slid), -limit, limit),   K = 2 pi R0 k,   limit = mu max(p, 0) 2 pi r s^2/(1 + slide')

per unit v, in which `slid`, the slide at which it would be free of shear, is what it remembers (theory page).
"""

import jax.numpy as jnp

from mckibben.model.friction import Remembered, step_energy
from mckibben.model.gap import contact_of
from mckibben.model.kinematics import meridian_stretch, radius
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.wall import contact_pressure

__all__ = ["after_slide", "grip", "shear_stress", "slide_density", "slide_energy", "slide_force", "slide_limit"]


def grip(p: Parameters) -> Number:
    """K: force per unit v and slide of a chamber that sticks [N/m^2]."""
    return 2.0 * jnp.pi * p.R0 * p.friction.grip


def arm(at: Point, p: Parameters) -> Number:
    """Force per unit v against the slide over the shear stress [m]: area of the mesh per unit v, and how far the
    chamber moves along it."""
    return 2.0 * jnp.pi * radius(at, p) * meridian_stretch(at, p) ** 2 / (1.0 + at.slide_rate)


def slide_limit(at: Point, P: Number, p: Parameters) -> Number:
    """Force per unit v at which the chamber slides [N/m], in a state (`gap.inflated`) at a gauge pressure P [Pa]."""
    pressed = contact_pressure(at, P, p) if at.blown is None else contact_of(at, P, p)[2]
    return p.friction.chamber * jnp.maximum(pressed, 0.0) * arm(at, p)


def slide_energy(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Energy per unit v [J/m] that a step from `memory` stores in the grip and dissipates by sliding."""
    return step_energy(at.slide - memory.slid, grip(p), memory.limit)


def slide_force(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Force per unit v against the slide [N/m]."""
    return jnp.clip(grip(p) * (at.slide - memory.slid), -memory.limit, memory.limit)


def shear_stress(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Shear stress [Pa] of the mesh on the chamber, positive towards the last end."""
    return slide_force(at, p, memory) / arm(at, p)


def slide_density(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Energy that the grip stores per unit v [J/m]: it comes back when the chamber is let go."""
    return 0.5 * slide_force(at, p, memory) ** 2 / grip(p)


def after_slide(at: Point, p: Parameters, memory: Remembered) -> Remembered:
    """What the chamber remembers once it has been in a state."""
    return memory._replace(slid=at.slide - slide_force(at, p, memory) / grip(p))
