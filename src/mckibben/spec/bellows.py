"""`Bellows`: a chamber whose folds take up its length, by the axial stiffness that is left."""

from __future__ import annotations

from typing import ClassVar

from mckibben.spec.declared import Reads
from mckibben.spec.fields import quantity, spec

__all__ = ["Bellows"]


@spec("chamber.law")
class Bellows:
    """A folded chamber, which stores energy by its length alone: k/2 (l - 1)^2 per length, l its axial stretch.

    Folds open and close as the muscle changes its length and its width, where a plain tube would have to stretch. What
    is left of a chamber's stiffness is one number, the force for each unit of axial strain, k: the spring rate that a
    bench measures along the axis [N/m] times the length of the bellows. Its radius costs nothing. It keeps the air
    inside and lets the braid do the work.

    A `Chamber` with this law needs no thickness. One that is given, or diameters, tell how much rubber there is, which
    counts for the mass and for the volume of air. A thick wall, or a gap, mean nothing for it and are refused.

    Args:
        axial_stiffness: force over axial strain, k [N], above 0: hang a weight on the bellows alone and divide it by
            the share by which it gets longer.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> chamber = mk.Chamber(law=mk.Bellows(axial_stiffness="50 N"))  # 5 N where it is 10 % longer than as made
    >>> mk.presets.paper().replace("chamber", chamber).chamber.law.axial_stiffness  # N
    50.0
    """

    name: ClassVar[str] = "bellows"
    axial_stiffness: Reads[float] = quantity(
        "N", meaning="force over axial strain k of the bellows", low=0.0, low_open=True, size=(1e-9, 1e9),
        source="theory page, bellows",
    )  # fmt: skip
