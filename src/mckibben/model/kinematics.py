"""Kinematics of the envelope surface and of its fibres, pointwise. `at` is the `Point`, `p` the muscle's numbers."""

import jax.numpy as jnp

from mckibben.model.angle import cos, sin, tan
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point

__all__ = [
    "angle_rate",
    "fibre_strains",
    "height_rate",
    "meridian_stretch",
    "natural_strains",
    "radius",
    "stretches",
    "volume_rate",
]


def radius(at: Point, p: Parameters) -> Number:
    """Current radius r [m] (Eq. 11)."""
    return p.R0 * cos(at.theta) / cos(p.theta0)


def meridian_stretch(at: Point, p: Parameters) -> Number:
    """Meridian stretch s = |d(r, z)/dv| (square root of G in Eq. 5, by Eq. 10 corrected)."""
    return sin(at.theta) / sin(p.theta0)


def stretches(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Principal stretches of the incompressible chamber: hoop, axial, thickness (Eq. 24)."""
    hoop, axial = cos(at.theta) / cos(p.theta0), meridian_stretch(at, p)
    return hoop, axial, 1.0 / (hoop * axial)


def angle_rate(at: Point, p: Parameters) -> Number:
    """theta' = d theta/dv [rad/m] that keeps the fibres inextensible at slope psi (Eqs. 11-12); needs psi alone."""
    return -sin(at.psi) / (p.R0 * tan(p.theta0))


def height_rate(at: Point, p: Parameters) -> Number:
    """z' = dz/dv, the axial length per unit v (Eq. 12)."""
    return meridian_stretch(at, p) * cos(at.psi)


def volume_rate(at: Point, p: Parameters) -> Number:
    """Enclosed volume per unit v, pi r^2 z' [m^2] (Eq. 27)."""
    return jnp.pi * radius(at, p) ** 2 * height_rate(at, p)


def fibre_strains(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Strains of a right-handed fibre [1/m]: geodesic curvature u1, normal curvature u2, twist u3 (Eqs. 14-16).

    Eq. (15) is misprinted in the paper: its first term divides by tan(theta), not tan(theta0).
    """
    u1 = -2.0 * cos(p.theta0) * sin(at.psi) / p.R0
    hoop, bend = cos(p.theta0) * cos(at.psi) / p.R0, sin(p.theta0) * at.kappa
    u2 = -hoop * cos(at.theta) + bend * sin(at.theta)
    u3 = hoop * sin(at.theta) + bend * cos(at.theta)
    return u1, u2, u3


def natural_strains(p: Parameters) -> tuple[Number, Number, Number]:
    """Stress-free strains [1/m]: those of the initial helix (Eq. 18), or zero for naturally straight fibres."""
    c, s = cos(p.theta0), sin(p.theta0)
    return 0.0 * c, -p.helical * c * c / p.R0, p.helical * c * s / p.R0
