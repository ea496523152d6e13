"""What a muscle weighs, and how wide it is over its fibres: from what it is made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from mckibben.model.profile import fibre_lengths
from mckibben.spec import Muscle
from mckibben.units import Number

__all__ = ["mass_of", "over_fibres"]


def mass_of(muscle: Muscle, fibre_density: Any, chamber_density: Any) -> Any:
    """Mass [kg] of fibres and chamber, without fittings, from densities [kg/m^3]; numbers of the muscle may be arrays.

    A fibre of one angle is H0/sin(theta0) long. Its diameter must be known. NaN for bellows whose wall is not told.
    """
    braid, chamber = muscle.braid, muscle.chamber
    section = 0.25 * np.pi * np.asarray(braid.fibre.diameter) ** 2
    mass = fibre_density * np.asarray(braid.fibres) * section * fibre_lengths(muscle)
    if chamber is None or chamber_density is None:
        return mass
    if chamber.wall_thickness is None:
        return np.nan * mass
    length = braid.length if chamber.length is None else chamber.length
    return mass + chamber_density * np.asarray(chamber.area(braid.radius)) * np.asarray(length)


def over_fibres(radius: Any, muscle: Muscle) -> Number:
    """Outer diameter [m] over a braid whose centre lines lie on a radius [m]: where two fibres cross, r + d outside.

    Where the diameter of a fibre is not known, that of the centre lines.
    """
    diameter = muscle.braid.fibre.diameter
    return 2.0 * (radius + (0.0 if diameter is None else diameter))
