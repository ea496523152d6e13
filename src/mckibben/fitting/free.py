"""The numbers that a fit finds: their ranges, their scales, and what is known of them beforehand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import attrs
import numpy as np

from mckibben.spec import Muscle, SpecError
from mckibben.spec.angle import AngleFrom, from_parallels
from mckibben.spec.change import changed_muscle
from mckibben.spec.declared import Declared, numbers
from mckibben.spec.errors import nearest
from mckibben.spec.plausible import trusted
from mckibben.spec.vary import full_name
from mckibben.units import DISPLAY, UnitError, show, to_si

__all__ = [
    "OFFSETS",
    "Free",
    "OfFree",
    "free_number",
    "free_numbers",
    "is_turned",
    "offsets_of",
    "put_in",
    "read_range",
]

OFFSETS = {
    "length": ("m", "added to every measured length"),
    "pressure": ("Pa", "added to every measured pressure"),
    "force": ("N", "added to every force of the model: what the load cell shows without load"),
}
"""What an instrument may be off by."""
WIDE = 10.0
"""Ratio of two positive bounds from which on the logarithm is searched."""
FAR = 10.0
"""Standard deviations to which an offset may go."""


@attrs.frozen
class Free:
    """One number with its range [SI]; the search works on `x`, 0 at one bound and 1 at the other."""

    name: str
    unit: str
    low: float
    high: float
    start: float
    meaning: str = ""
    display: str = ""
    prior: tuple[float, float] | None = None  #: mean and standard deviation of what is known beforehand

    @property
    def logarithmic(self) -> bool:
        """Whether x is linear in the logarithm."""
        return self.low > 0.0 and self.high >= WIDE * self.low

    def value(self, x: float) -> float:
        """The number at x."""
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** x)
        return float(self.low + (self.high - self.low) * x)

    def x(self, value: float) -> float:
        """Where a number is between its bounds."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def slope(self, x: float) -> float:
        """Derivative of the number by x."""
        return self.value(x) * math.log(self.high / self.low) if self.logarithmic else self.high - self.low

    def text(self, value: float) -> str:
        """A value in the unit that people see."""
        return show(value, self.display or self.unit)


class OfFree:
    """What every misfit has of its free numbers."""

    free: tuple[Free, ...]

    @property
    def start(self) -> np.ndarray:
        """x of what was given."""
        return np.array([one.x(one.start) for one in self.free])

    def values(self, x: np.ndarray) -> np.ndarray:
        """The numbers at x, SI."""
        return np.array([one.value(float(at)) for one, at in zip(self.free, x, strict=True)])


def free_number(name: str, given: Any, declared: Declared, number: float, priors: Mapping[str, Any]) -> Free:
    """A declared number that is free in the range given, with what is known of it beforehand."""
    low, high = read_range(f"free.{name}", given, declared)
    one = Free(name, declared.unit, low, high, number, declared.meaning, declared.display)
    if not low <= number <= high:
        one = attrs.evolve(one, start=one.value(0.5))
    prior = _prior(f"priors.{name}", priors[name], declared.unit) if name in priors else None
    return attrs.evolve(one, prior=prior)


def free_numbers(muscle: Muscle, free: Mapping[str, Any], priors: Mapping[str, Any]) -> tuple[Free, ...]:
    """What is free, from a mapping of names to ranges. SpecError for a name or range that cannot be."""
    if not isinstance(free, Mapping) or not free:
        advice = 'such as free={"braid.angle": "30 deg to 40 deg"}'
        raise SpecError("free", free, "must name at least one number and its range", advice)
    known = {name: (declared, number) for name, declared, number in numbers(muscle)}
    for name in priors:
        if full_name(str(name)) not in {full_name(str(one)) for one in free}:
            raise SpecError(f"priors.{name}", allowed="is not free", advice="name it in free too")
    told = {full_name(str(name)): given for name, given in priors.items()}
    found = []
    for given_name, given in free.items():
        name = full_name(str(given_name))
        if name not in known:
            advice = nearest(name, [one for one, (declared, _) in known.items() if declared.kind != "count"])
            raise SpecError(f"free.{given_name}", allowed="is no number of this muscle", advice=advice)
        declared, number = known[name]
        if is_turned(muscle, name):
            number = from_parallels(number, muscle.braid.measured_from)
        if declared.kind == "count":
            raise SpecError(f"free.{name}", given, "is a whole number", "fit once for each, and compare the errors")
        found.append(free_number(name, given, declared, float(number), told))
    return tuple(found)


def offsets_of(offsets: Mapping[str, Any]) -> tuple[Free, ...]:
    """Offsets of instruments, each with the standard deviation that is expected of it."""
    found = []
    for name, given in offsets.items():
        if name not in OFFSETS:
            said = "must be one of " + ", ".join(OFFSETS)
            raise SpecError(f"offsets.{name}", allowed=said, advice=nearest(str(name), OFFSETS))
        unit, meaning = OFFSETS[name]
        sd = _number(f"offsets.{name}", given, unit)
        if sd <= 0.0:
            raise SpecError(f"offsets.{name}", given, "must be above 0: the standard deviation that is expected")
        shown = DISPLAY.get(unit, unit)
        found.append(Free(f"offset.{name}", unit, -FAR * sd, FAR * sd, 0.0, meaning, shown, (0.0, sd)))
    return tuple(found)


def is_turned(muscle: Muscle, name: str) -> bool:
    """Whether a number is the complement of what the muscle keeps: an angle that is given from the axis."""
    return name == "braid.angle" and muscle.braid.measured_from == AngleFrom.AXIS


def put_in(muscle: Muscle, free: tuple[Free, ...], values: np.ndarray) -> Muscle:
    """The muscle with the numbers that are its own. SpecError where they do not go together."""
    changes: dict[str, Any] = {}
    for one, value in zip(free, values.tolist(), strict=True):
        if _is_offset(one):
            continue
        owner, _, last = one.name.rpartition(".")
        if last.endswith("]"):  # one of several constants: "chamber.law.mu[1]"
            field, _, place = one.name.rstrip("]").partition("[")
            several = list(changes.get(field, attrgetter(field)(muscle)))
            several[int(place)] = value
            changes[field] = tuple(several)
        elif owner.endswith(".constants"):  # of a law of the user's own
            changes[owner] = dict(changes.get(owner, attrgetter(owner)(muscle))) | {last: value}
        else:
            changes[one.name] = value
    with trusted():
        changed: Muscle = changed_muscle(muscle, changes)
    return changed


def _is_offset(one: Free) -> bool:
    return one.name.startswith("offset.")


def _number(field: str, given: Any, unit: str) -> float:
    try:
        return float(to_si(given, unit))
    except UnitError as error:
        raise SpecError(field, given, str(error), error.advice) from error


def read_range(field: str, given: Any, declared: Declared) -> tuple[float, float]:
    """Two bounds, from "30 deg to 40 deg", "30 to 40 deg" or a pair. SpecError where they are out of range."""
    ends: Any = given
    advice = 'such as "30 deg to 40 deg", or two numbers in SI'
    if isinstance(given, str):
        first, to, last = given.partition(" to ")
        if not to:
            raise SpecError(field, given, "must be a range", advice)
        unit = last.strip().lstrip("+-.,0123456789eE ")
        ends = (f"{first} {unit}" if first.strip()[-1:].isdigit() and unit else first, last)
    try:
        low, high = ends
    except (TypeError, ValueError):
        raise SpecError(field, given, "must be a range", advice) from None

    def read(end: Any) -> float:
        """One number, also where the field holds several of them ("end_radii[0]")."""
        if declared.kind == "quantities":
            try:
                (number,) = declared.read((end,), field, declared)
            except SpecError as error:  # which names its place in a list of one
                raise error.renamed(field) from error
            return float(number)
        return float(declared.read(end, field, declared))

    bounds = [read(end) for end in (low, high)]
    if not bounds[0] < bounds[1]:
        raise SpecError(field, given, "must go from the smaller bound to the larger one")
    return bounds[0], bounds[1]


def _prior(field: str, given: Any, unit: str) -> tuple[float, float]:
    """Mean and standard deviation, from "0.3 MPa +- 0.1 MPa" or a pair."""
    pair = given.replace("±", "+-").split("+-") if isinstance(given, str) else given
    try:
        mean, sd = (_number(field, part.strip() if isinstance(part, str) else part, unit) for part in pair)
    except (TypeError, ValueError) as error:
        if isinstance(error, SpecError):
            raise
        raise SpecError(
            field, given, "must be a mean and its standard deviation", 'such as "0.3 MPa +- 0.1 MPa"'
        ) from None
    if sd <= 0.0:
        raise SpecError(field, given, "needs a standard deviation above 0")
    return mean, sd
