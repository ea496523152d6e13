"""Kinematics of the envelope surface and of its fibres, pointwise.

The state at a material point is (theta, psi, kappa): braid angle from the parallels, slope angle of the meridian and
its derivative psi' = d psi/dv. Taking psi instead of the paper's theta' removes the square root of Eq. (12) and lets a
bulge overhang its fitting; inextensibility (Eqs. 11-12) then reads theta' = -sin(psi) / (R0 tan(theta0)).
"""

from ..lazy import jnp
from .angle import cos, sin, tan
from .parameters import Number, Parameters


def radius(theta: Number, p: Parameters) -> Number:
    """Current radius r [m] (Eq. 11)."""
    return p.R0 * cos(theta) / cos(p.theta0)


def meridian_stretch(theta: Number, p: Parameters) -> Number:
    """Meridian stretch s = |d(r, z)/dv| (square root of G in Eq. 5, by Eq. 10 corrected)."""
    return sin(theta) / sin(p.theta0)


def stretches(theta: Number, p: Parameters) -> tuple[Number, Number, Number]:
    """Principal stretches of the incompressible chamber: hoop, axial, thickness (Eq. 24)."""
    hoop, axial = cos(theta) / cos(p.theta0), meridian_stretch(theta, p)
    return hoop, axial, 1.0 / (hoop * axial)


def angle_rate(psi: Number, p: Parameters) -> Number:
    """theta' = d theta/dv [rad/m] that keeps the fibres inextensible at slope psi (Eq. 12)."""
    return -sin(psi) / (p.R0 * tan(p.theta0))


def height_rate(theta: Number, psi: Number, p: Parameters) -> Number:
    """z' = dz/dv, the axial length per unit v (Eq. 12)."""
    return meridian_stretch(theta, p) * cos(psi)


def volume_rate(theta: Number, psi: Number, p: Parameters) -> Number:
    """Enclosed volume per unit v, pi r^2 z' [m^2] (Eq. 27)."""
    return jnp.pi * radius(theta, p) ** 2 * height_rate(theta, psi, p)


def fibre_strains(theta: Number, psi: Number, kappa: Number, p: Parameters) -> tuple[Number, Number, Number]:
    """Strains of a right-handed fibre [1/m]: geodesic curvature u1, normal curvature u2, twist u3 (Eqs. 14-16).

    Eq. (15) is misprinted in the paper: its first term divides by tan(theta), not tan(theta0).
    """
    u1 = -2.0 * cos(p.theta0) * sin(psi) / p.R0
    hoop, bend = cos(p.theta0) * cos(psi) / p.R0, sin(p.theta0) * kappa
    u2 = -hoop * cos(theta) + bend * sin(theta)
    u3 = hoop * sin(theta) + bend * cos(theta)
    return u1, u2, u3


def natural_strains(p: Parameters) -> tuple[Number, Number, Number]:
    """Stress-free strains [1/m]: those of the initial helix (Eq. 18), or zero for naturally straight fibres."""
    c, s = cos(p.theta0), sin(p.theta0)
    return 0.0 * c, -p.helical * c * c / p.R0, p.helical * c * s / p.R0
