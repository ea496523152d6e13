"""Radii that the fittings hold where they differ from the braid's: how they are read, and which a braid can take."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mckibben.spec.declared import Declared
from mckibben.spec.ends import Ends
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import read_quantity
from mckibben.units import Number, is_traced, show

__all__ = ["certainly_held", "check_end_radii", "limits", "read_radii"]

FLATTEST = 1e-2
"""Least sine and cosine of the braid angle at a fitting."""


def read_radii(value: Any, field: str, declared: Declared) -> tuple[Number, ...]:
    """One radius for both ends, or those of the first and the last: the SI floats of what a user gave."""
    several = isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) == 1
    given = list(value) if several else [value]
    if len(given) not in (1, 2):
        advice = "one radius for both ends, or a list of that at the first end and that at the last"
        raise SpecError(field, value, "must be one or two radii", advice)
    if not several:
        return (read_quantity(value, field, declared),)
    return tuple(read_quantity(item, f"{field}[{index}]", declared) for index, item in enumerate(given))


def check_end_radii(muscle: Any) -> None:
    """SpecError for radii that the braid cannot take, or that do not go with its ends or its friction."""
    radii, braid = muscle.end_radii, muscle.braid
    if radii is None:
        return
    if muscle.ends == Ends.FREE:
        advice = 'leave end_radii out, or take ends = "clamped" or "pinned"'
        raise SpecError("muscle.end_radii", _said(radii), 'do not go with ends = "free", which hold no radius', advice)
    if muscle.friction is not None:
        said = (
            "do not go with friction: the crossings turn as the braid is pushed over the fittings, by a way that the "
            "model does not know"
        )
        raise SpecError("muscle.end_radii", _said(radii), said, "leave one of the two out")
    if is_traced(braid.radius) or is_traced(braid.angle):
        return
    low, high = limits(braid)
    for radius in radii:
        if not is_traced(radius) and not low <= radius <= high:
            why = "touch each other" if (_jams(braid) or 0.0) >= FLATTEST else "lie along the axis, or flat around it"
            said = f"must be from {show(low, 'm')} to {show(high, 'm')}, beyond which the fibres {why}"
            raise SpecError("muscle.end_radii", show(radius, "m"), said, "change the fitting, or the braid")


def limits(braid: Any) -> tuple[float, float]:
    """Least and largest radius [m] that a braid can be held at: r = R0 cos(theta)/cos(theta0), and its fibres fit."""
    widest = braid.radius / math.cos(braid.angle)
    flat = _jams(braid)
    if flat is None or flat < FLATTEST:
        return widest * FLATTEST, widest * math.sqrt(1.0 - FLATTEST**2)
    return widest * math.sin(flat), widest * math.cos(flat)


def certainly_held(braid: Any, radii: Any) -> Any:
    """Whether braids whose numbers are arrays can be held at radii, as far as that is certain."""
    shares = [np.asarray(radius) * np.cos(braid.angle) / braid.radius for radius in radii]
    good: Any = True
    for share in shares:
        good = good & (share > FLATTEST) & (share < math.sqrt(1.0 - FLATTEST**2))
    if braid.fibre.diameter is None:
        return good
    crowded = braid.fibres * braid.fibre.diameter * np.cos(braid.angle) / (2.0 * math.pi * braid.radius)
    for share in shares:
        good = good & (2.0 * share * np.sqrt(np.maximum(1.0 - share**2, 0.0)) > crowded)
    return good


def _jams(braid: Any) -> float | None:
    """The flatter of the two braid angles at which neighbouring fibres touch; None where they may be of any size."""
    diameter = braid.fibre.diameter
    if diameter is None or is_traced(diameter) or is_traced(braid.fibres):
        return None
    return 0.5 * math.asin(min(1.0, braid.fibres * diameter * math.cos(braid.angle) / (2.0 * math.pi * braid.radius)))


def _said(radii: tuple[Number, ...]) -> str:
    return ", ".join(show(radius, "m") if not is_traced(radius) else str(radius) for radius in radii)
