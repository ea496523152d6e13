"""The wall of the chamber where it spans the openings between fibres (theory page, the wall between fibres)."""

import math

from mckibben.units import Number

__all__ = ["HALF_CIRCLE", "bulging_pressure"]

HALF_CIRCLE = 0.5 * math.pi
"""Angle [rad] between the wall and the plane of the opening where its bulge is half a circle: stretched by pi/2."""


def bulging_pressure(width: Number, thickness: Number, shear_modulus: Number, angle: float = HALF_CIRCLE) -> Number:
    """Pressure [Pa] at which a wall [m] over lozenges of a width [m] between sides bulges to an angle at its edges.

    Over a slit it is an arc: a neo-Hookean strip in plane strain, stretched by lambda = angle/sin(angle), whose tension
    mu t (lambda - lambda^-3) over the radius of the arc is the pressure. A lozenge bears twice that.
    """
    stretch = angle / math.sin(angle)
    slit = 2.0 * shear_modulus * thickness / width * math.sin(angle) * (stretch - stretch**-3)
    return 2.0 * slit
