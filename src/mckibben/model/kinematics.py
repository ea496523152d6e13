"""Kinematics of the envelope surface and of its fibres, pointwise. `at` is the `Point`, `p` the muscle's numbers."""

import jax.numpy as jnp

from mckibben.model.angle import cos, radians, sin, tan
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point, made_angle

__all__ = [
    "angle_rate",
    "closure_rate",
    "end_angle",
    "facing",
    "fibre_strains",
    "height_rate",
    "made_angle",
    "meridian_stretch",
    "natural_strains",
    "radius",
    "stretch_rate",
    "stretches",
    "volume_rate",
]


def radius(at: Point, p: Parameters) -> Number:
    """Current radius r [m] (Eq. 11), times the stretch of the fibres."""
    return _stretched(p.R0 * cos(at.theta) / cos(made_angle(at, p)), at)


def _stretched(value: Number, at: Point) -> Number:
    """What is proportional to the length of the fibres."""
    return value if at.stretch is None else at.stretch * value


def meridian_stretch(at: Point, p: Parameters) -> Number:
    """Meridian stretch s = |d(r, z)/dv| (square root of G in Eq. 5, by Eq. 10 corrected)."""
    return _stretched(sin(at.theta) / sin(made_angle(at, p)), at)


def stretches(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Principal stretches of the incompressible chamber: hoop, axial, thickness (Eq. 24)."""
    hoop, axial = _stretched(cos(at.theta) / cos(made_angle(at, p)), at), meridian_stretch(at, p)
    return hoop, axial, 1.0 / (hoop * axial)


def angle_rate(at: Point, p: Parameters) -> Number:
    """theta' = d theta/dv [rad/m] that keeps the fibres inextensible at slope psi (Eqs. 11-12), and its excess."""
    rate = -sin(at.psi) / (p.R0 * tan(made_angle(at, p)))
    return rate if at.excess is None else rate + at.excess


def stretch_rate(at: Point, p: Parameters) -> Number:
    """lambda'/lambda [1/m] of fibres that stretch: what r' = s sin(psi) asks for (theory page)."""
    rate = at.excess * tan(at.theta)
    return rate if at.made is None else rate - at.made.rate * tan(at.made.angle)


def closure_rate(at: Point, p: Parameters) -> Number:
    """Density of what vanishes where both ends have their radii: theta', or -r' cos(theta0)/R0 of stretching fibres,
    less what its integral is where these differ."""
    rate = angle_rate(at, p) if at.stretch is None else -meridian_stretch(at, p) * sin(at.psi) * cos(p.theta0) / p.R0
    if p.end_radii is None or len(p.end_radii) == 1:
        return rate
    if at.stretch is None:
        return rate - (end_angle(p, 1) - end_angle(p, 0)) / p.H0
    first, last = p.end_radii
    return rate - (first - last) * cos(p.theta0) / (p.R0 * p.H0)


def end_angle(p: Parameters, end: int) -> Number:
    """Braid angle [rad] of fibres that do not stretch at the first end (0) or the last (1): R1 = R0 cos/cos(theta0)."""
    if p.end_radii is None:
        return radians(p.theta0)
    radius = p.end_radii[0] if len(p.end_radii) == 1 else p.end_radii[end]
    return jnp.arccos(radius * cos(p.theta0) / p.R0)


def height_rate(at: Point, p: Parameters) -> Number:
    """z' = dz/dv, the axial length per unit v (Eq. 12)."""
    return meridian_stretch(at, p) * cos(at.psi)


def volume_rate(at: Point, p: Parameters) -> Number:
    """Enclosed volume per unit v, pi r^2 z' [m^2] (Eq. 27); of a chamber that may leave the braid, what it encloses."""
    inside = jnp.pi * radius(at, p) ** 2 * height_rate(at, p)
    if at.blown is None:
        return inside
    gap = radius(at, p) ** 2 - (p.R0 * at.blown) ** 2
    return inside - jnp.pi * gap * meridian_stretch(at, p) * facing(at)


def facing(at: Point) -> Number:
    """How much of the meridian lies along the axis, cos(psi); where it is steeper than 60 deg no less than 1/4.

    There the mesh has turned over, and a chamber beside it no longer moves off along the radius.
    """
    c = cos(at.psi)
    return jnp.where(c > 0.5, c, 0.25 + jnp.maximum(c, 0.0) ** 2)


def fibre_strains(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Strains of a right-handed fibre [1/m]: geodesic curvature u1, normal curvature u2, twist u3 (Eqs. 14-16).

    Eq. (15) is misprinted in the paper: its first term divides by tan(theta), not tan(theta0).
    """
    made = made_angle(at, p)
    u1 = -2.0 * cos(made) * sin(at.psi) / p.R0
    if at.excess is not None:
        u1 = u1 + sin(made) * at.excess
    hoop, bend = cos(made) * cos(at.psi) / p.R0, sin(made) * at.kappa
    u2 = -hoop * cos(at.theta) + bend * sin(at.theta)
    u3 = hoop * sin(at.theta) + bend * cos(at.theta)
    return (u1, u2, u3) if at.roll is None else _rolled(u1, u2, u3, at, p)


def _rolled(u1: Number, u2: Number, u3: Number, at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Strains about the axes of a section that has turned by phi about the fibre (theory page)."""
    c, s = cos(at.roll), sin(at.roll)
    return c * u1 + s * u2, c * u2 - s * u1, u3 + sin(made_angle(at, p)) * at.roll_rate


def natural_strains(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Stress-free strains [1/m]: those of the initial helix (Eq. 18), or zero for naturally straight fibres.

    In a programmed braid a fibre as made turns within the surface as well, by sin(theta0) theta0'.
    """
    c, s = cos(made_angle(at, p)), sin(made_angle(at, p))
    aside = 0.0 * c if at.made is None else p.helical * s * at.made.rate
    return aside, -p.helical * c * c / p.R0, p.helical * c * s / p.R0
