"""What can be computed of a muscle as a whole: no product of its numbers over- or underflows, or means nothing."""

from __future__ import annotations

import math
from typing import Any

from mckibben.spec.errors import SpecError
from mckibben.units import Number, is_traced, show

__all__ = ["BENDING", "certainly_fits", "check_angle", "check_muscle"]

SLENDERNESS = (1e-3, 1e5)
"""Length over radius of the braid."""
WALL = (1e-6, 1e3)
"""Thickness of the chamber over the radius of the braid."""
FLATTEST = 1e-4
"""Least sine and cosine of the braid angle: what fibres along the parallels, or along the axis, make of a tube."""
BENDING = (1e-24, 1e4)
"""Stiffness of a fibre in bending or twist [N m^2]: from a hundredth of a micrometre of plastic to a bar of steel."""
STRETCHING = (1e-15, 1e15)
"""Shear modulus of the chamber times the area of its wall [N]."""
ROUNDING = 1e-9
"""Share by which a tube may be wider than its braid: half a diameter need not be the radius to the last digit."""
MOUNTED = (0.05, 20.0)
"""Stretch at which a tube is mounted: more than rubber bears either way."""


def check_muscle(muscle: Any) -> None:
    """SpecError that names the product and its range, unless all can be computed. Traced numbers are not judged."""
    braid, chamber = muscle.braid, muscle.chamber
    _check_ratio("braid.length", braid.length, braid.radius, "the radius", SLENDERNESS)
    for name, stiffness in zip(("B1", "B2", "B3"), braid.fibre.stiffnesses, strict=True):
        if not is_traced(stiffness) and stiffness != 0.0:  # a stiffness of 0 is a choice
            _check(f"braid.fibre: the stiffness {name} of a fibre", stiffness, "N m^2", BENDING)
    if chamber is not None:
        _check_chamber(chamber, braid)


def _check_chamber(chamber: Any, braid: Any) -> None:
    """SpecError unless the chamber fits into the braid as made and its stiffness can be computed."""
    R0, H0 = braid.radius, braid.length
    field = "chamber" if chamber.thickness is None else "chamber.thickness"
    _check_room(chamber, R0, H0)
    if chamber.wall_thickness is not None:
        _check_ratio(field, chamber.wall_thickness, R0, "the radius of the braid", WALL)
    for name, value, stretch, other in (
        ("outer_diameter", chamber.outer_diameter, chamber.stretches(R0, H0)[0], "the braid's over its own"),
        ("length", chamber.length, chamber.stretches(R0, H0)[1], "the braid's over its own"),
    ):
        if value is not None and not is_traced(stretch) and not MOUNTED[0] <= stretch <= MOUNTED[1]:
            said = f"is mounted at a stretch of {stretch:.3g} ({other}): must be {MOUNTED[0]:g} to {MOUNTED[1]:g}"
            raise SpecError(f"chamber.{name}", show(value, "m"), said, "check the units of both")
    modulus = getattr(chamber.law, "shear_modulus", None)  # of a user's own law nothing is known
    area = chamber.area(R0)
    if modulus is not None and not is_traced(modulus) and not is_traced(area):
        _check("chamber: its stiffness, shear modulus times area of the wall,", modulus * area, "N", STRETCHING)


def _check_room(chamber: Any, R0: Number, H0: Number) -> None:
    """SpecError for a tube wider than its braid, a wall inside that leaves no bore, or a bore closed as mounted."""
    numbers = (R0, H0, chamber.outer_diameter, chamber.inner_diameter, chamber.thickness, chamber.length)
    if not chamber.inside or chamber.wall_thickness is None or any(is_traced(x) for x in numbers):
        return
    if chamber.outer_diameter is not None and chamber.outer_diameter > 2.0 * R0 * (1.0 + ROUNDING):
        said = f"must be at most {show(2.0 * R0, 'm')}, twice the radius of the braid: a wider tube would lie in folds"
        advice = "take a smaller tube or a wider braid"
        raise SpecError("chamber.outer_diameter", show(chamber.outer_diameter, "m"), said, advice)
    if chamber.thickness is not None and not chamber.thickness < R0:
        said = f"must be above 0 mm and below {show(R0, 'm')}, the radius of the braid, where the wall lies inside"
        raise SpecError("chamber.thickness", show(chamber.thickness, "m"), said, "leave it some bore")
    if not _bore(chamber, R0, H0) > 0.0:
        said = "is so much longer than the braid that the bore of the tube is closed as mounted"
        raise SpecError("chamber.length", show(chamber.length, "m"), said, "mount a shorter tube, or a thinner wall")


def _bore(chamber: Any, R0: Any, H0: Any) -> Any:
    """(Radius of the bore over that of the face on the braid, both as mounted)^2 times the hoop stretch squared."""
    hoop, axial = chamber.stretches(R0, H0)
    return hoop**2 - (1.0 - chamber.other_face(R0)) / axial


def certainly_fits(braid: Any, chamber: Any) -> Any:
    """Whether the chambers of many muscles, whose numbers are arrays, certainly fit into their braids."""
    R0, H0 = braid.radius, braid.length
    hoop, axial = chamber.stretches(R0, H0)
    good: Any = True
    if chamber.wall_thickness is not None:
        share = chamber.wall_thickness / R0
        good = (share >= WALL[0]) & (share <= WALL[1])
    for stretch in (hoop, axial):
        good = good & (stretch >= MOUNTED[0]) & (stretch <= MOUNTED[1])
    if not chamber.inside or chamber.wall_thickness is None:
        return good
    bore = chamber.wall_thickness / chamber.riding_radius(R0) < 1.0
    return good & bore & (hoop >= 1.0) & (chamber.wall_thickness > 0.0) & (_bore(chamber, R0, H0) > 0.0)


def _check(what: str, value: float, unit: str, limits: tuple[float, float]) -> None:
    low, high = limits
    if not low <= value <= high:
        said = f"{what} is {show(value, unit)}, beyond what can be computed: {show(low, unit)} to {show(high, unit)}"
        field, _, said = said.partition(": ")
        raise SpecError(field, allowed=said, advice="check the units of what it is made of")


def _check_ratio(field: str, value: Number, other: Number, name: str, limits: tuple[float, float]) -> None:
    low, high = limits
    if not is_traced(value) and not is_traced(other) and not low <= value / other <= high:
        said = f"is {value / other:.3g} times {name}, beyond what can be computed: {low:g} to {high:g} times"
        raise SpecError(field, show(value, "m"), said, "check the units of both")


def check_angle(angle: Number, field: str = "braid.angle") -> None:
    """SpecError for fibres that lie along the parallels or the axis, but for a hair."""
    if not is_traced(angle) and min(math.sin(angle), math.cos(angle)) < FLATTEST:
        least = math.degrees(FLATTEST)
        said = f"is beyond what can be computed: {least:.4f} deg to {90.0 - least:.4f} deg"
        raise SpecError(field, show(angle, "rad"), said, "fibres cannot lie along the parallels or the axis")
