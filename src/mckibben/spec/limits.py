"""What can be computed of a muscle as a whole: no product of its numbers over- or underflows, or means nothing."""

from __future__ import annotations

import math
from typing import Any

from mckibben.spec.errors import SpecError
from mckibben.units import Number, is_traced, show

__all__ = ["BENDING", "check_angle", "check_muscle"]

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


def check_muscle(muscle: Any) -> None:
    """SpecError that names the product and its range, unless all can be computed. Traced numbers are not judged."""
    braid, chamber = muscle.braid, muscle.chamber
    _check_ratio("braid.length", braid.length, braid.radius, "the radius", SLENDERNESS)
    for name, stiffness in zip(("B1", "B2", "B3"), braid.fibre.stiffnesses, strict=True):
        if not is_traced(stiffness) and stiffness != 0.0:  # a stiffness of 0 is a choice
            _check(f"braid.fibre: the stiffness {name} of a fibre", stiffness, "N m^2", BENDING)
    if chamber is None:
        return
    _check_ratio("chamber.thickness", chamber.thickness, braid.radius, "the radius of the braid", WALL)
    modulus = getattr(chamber.law, "shear_modulus", None)  # of a user's own law nothing is known
    if modulus is not None and not any(is_traced(x) for x in (modulus, chamber.thickness, braid.radius)):
        area = math.pi * chamber.thickness * (chamber.thickness + 2.0 * braid.radius)
        _check("chamber: its stiffness, shear modulus times area of the wall,", modulus * area, "N", STRETCHING)


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


def check_angle(angle: Number) -> None:
    """SpecError for fibres that lie along the parallels or the axis, but for a hair."""
    if not is_traced(angle) and min(math.sin(angle), math.cos(angle)) < FLATTEST:
        least = math.degrees(FLATTEST)
        said = f"is beyond what can be computed: {least:.4f} deg to {90.0 - least:.4f} deg"
        raise SpecError("braid.angle", show(angle, "rad"), said, "fibres cannot lie along the parallels or the axis")
