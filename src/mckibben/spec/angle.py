"""The braid angle's two conventions: from the parallels, as stored, or from the axis; and what the angle tells.

A braid keeps its angle from the parallels, and remembers what it was given from (`Braid.measured_from`): an angle given
anew, by `Muscle.replace` or a sweep, means what the muscle's own words meant.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from mckibben.units import Number, is_traced, show

__all__ = ["MAGIC", "AngleFrom", "anew", "as_written", "between", "both_ways", "from_parallels", "tendency"]

MAGIC = math.atan(math.sqrt(0.5))
"""The magic angle from the parallels [rad], 35.26 deg: there a long muscle neither contracts nor lengthens (Eq. 31)."""


class AngleFrom(StrEnum):
    """What the braid angle is measured from: the parallels (circles around the tube) or the tube's axis."""

    PARALLELS = "parallels"
    AXIS = "axis"


def from_parallels(angle: Number, measured_from: str) -> Number:
    """An angle [rad] from the parallels, given from what it is measured; and the other way round."""
    return math.pi / 2.0 - angle if measured_from == AngleFrom.AXIS else angle


def as_written(angle: Number, measured_from: str) -> dict[str, Any]:
    """The fields `angle` and `angle_from` that read back as an angle [rad] from the parallels, in a braid's own words.

    The words are left out where they are the default, where `angle` is no number between 0 and 90 deg (as in the
    derivative by a muscle), and where the complement would not read back to the last bit: no angle that was given from
    the axis is such.
    """
    if measured_from != AngleFrom.AXIS or is_traced(angle) or not 0.0 < angle < math.pi / 2.0:
        return {"angle": angle}
    given = math.pi / 2.0 - angle
    return {"angle": given, "angle_from": "axis"} if math.pi / 2.0 - given == angle else {"angle": angle}


def anew(braid: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """What to make a braid anew from, where `angle` or `angle_from` is given.

    An angle alone means what the braid's own words meant. What it is measured from alone: the number stays as given.
    """
    if not {"angle", "angle_from"} & given.keys():
        return dict(given)
    said = given.get("angle_from", braid.measured_from)
    own = from_parallels(braid.angle, braid.measured_from)
    return {"angle": own, **given, "angle_from": said, "measured_from": None}


def both_ways(angle: float) -> str:
    """An angle [rad] from the parallels in both conventions: "65 deg from the parallels (25 deg from the axis)"."""
    return f"{show(angle, 'rad')} from the parallels ({show(math.pi / 2.0 - angle, 'rad')} from the axis)"


def between(low: float, high: float) -> str:
    """Which angles [rad] from the parallels a programmed braid has: "37 deg to 48 deg from the parallels"."""
    return f"{show(low, 'rad', 4)} to {show(high, 'rad', 4)} from the parallels, programmed along the length"


def tendency(angle: float) -> str:
    """What a long muscle with this braid angle [rad, from the parallels] does under pressure (Eq. 31)."""
    if abs(angle - MAGIC) < 1e-6:
        return "neither contracts nor lengthens under pressure"
    return "contracts under pressure" if angle > MAGIC else "lengthens under pressure"
