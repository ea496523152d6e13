"""Where neighbouring fibres of one hand touch, at either end of the range of lengths (theory page, jamming)."""

import math

import numpy as np

from mckibben import spec
from mckibben.units import Number

__all__ = ["across", "jamming_angles", "jamming_lengths"]


def across(r: Number, theta: Number, fibres: Number) -> Number:
    """Distance [m] between the centre lines of neighbouring fibres of one hand, across them: 2 pi r sin(theta)/(N/2).

    On a braid of inextensible fibres it goes with sin(2 theta): largest at 45 deg, and small at both ends.
    """
    return 4.0 * np.pi * r * np.sin(theta) / fibres


def jamming_angles(R0: float, theta0: float, fibres: float, diameter: float) -> tuple[float, float]:
    """Braid angles [rad from the parallels] of the cylinder at which fibres touch: flat around it, and steep along it.

    sin(2 theta) = N d cos(theta0)/(2 pi R0).
    """
    flat = 0.5 * math.asin(min(1.0, fibres * diameter * math.cos(theta0) / (2.0 * math.pi * R0)))
    return flat, 0.5 * math.pi - flat


def jamming_lengths(muscle: spec.Muscle) -> tuple[float, float]:
    """Lengths [m] between the fittings of the cylinder whose fibres, of a known diameter, touch: short and long."""
    braid, dead = muscle.braid, muscle.rest_length - muscle.braid.length
    assert braid.fibre.diameter is not None
    angles = jamming_angles(braid.radius, braid.angle, braid.fibres, braid.fibre.diameter)
    short, long = (braid.length * math.sin(one) / math.sin(braid.angle) + dead for one in angles)
    return short, long
