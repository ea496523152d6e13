"""The tolerances as given: which number scatters, how far, and by which law of chance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import attrs
import numpy as np

from mckibben.fitting.free import is_turned
from mckibben.spec import Muscle, SpecError, Test, numbers
from mckibben.spec.angle import from_parallels
from mckibben.spec.declared import Declared
from mckibben.spec.errors import nearest
from mckibben.spec.vary import full_name
from mckibben.units import UnitError, show, to_si

__all__ = ["REACH", "Distribution", "Scattering", "distribution_named", "scattering"]

REACH = 4.0
"""Standard deviations at which a normal distribution is cut off; it loses 0.05 % of its own by that."""


class Distribution(StrEnum):
    """What a tolerance says."""

    NORMAL = "normal"  # it is one standard deviation
    UNIFORM = "uniform"  # it is half a range, in which every value is as likely


@attrs.frozen
class Scattering:
    """One number that scatters about its value; SI units, an angle measured from what the muscle's own was."""

    name: str
    declared: Declared
    value: float
    size: float
    distribution: Distribution
    turned: bool  #: whether derivatives by the number, an angle from the parallels, are those by -1 times this one

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return self.size if self.distribution == Distribution.NORMAL else self.size / math.sqrt(3.0)

    @property
    def reach(self) -> float:
        """The farthest from its value that is drawn."""
        return REACH * self.size if self.distribution == Distribution.NORMAL else self.size

    @property
    def said(self) -> str:
        """The tolerance in words."""
        if self.distribution == Distribution.NORMAL:
            return f"{self.text(self.size)} (one standard deviation)"
        return f"±{self.text(self.size)} (uniform)"

    @property
    def display(self) -> str:
        """The unit that people see; that of a constant of the user's own law is not known."""
        return "1" if self.declared.kind == "constants" else self.declared.display or self.declared.unit or "1"

    def text(self, value: float) -> str:
        """A value of the number for people."""
        return show(value, self.display)

    def at(self, share: np.ndarray) -> np.ndarray:
        """The values below which these shares of all lie."""
        if self.distribution == Distribution.UNIFORM:
            return np.asarray(self.value + self.size * (2.0 * share - 1.0))
        from scipy.stats import truncnorm  # here, because it takes a second to import

        return np.asarray(self.value + self.size * truncnorm.ppf(share, -REACH, REACH))


def scattering(muscle: Muscle, test: Test, vary: Mapping[str, Any], distribution: str) -> tuple[Scattering, ...]:
    """What scatters. SpecError for an unknown number, and a tolerance that is none or leaves the allowed range."""
    if not isinstance(vary, Mapping) or not vary:
        raise SpecError("vary", vary, "must name at least one number", 'such as {"braid.angle": "1 deg"}')
    kind = distribution_named("distribution", distribution)
    known = {name: (declared, number) for name, declared, number in numbers(muscle)}
    known |= {f"test.{name}": (declared, number) for name, declared, number in numbers(test)}
    found: dict[str, Scattering] = {}
    for given_name, given in vary.items():
        name, field = full_name(str(given_name)), f"tolerances.{given_name}"
        if name not in known:
            names = [one for one, (declared, _) in known.items() if declared.kind != "count"]
            raise SpecError(field, allowed="is no number of this muscle or test", advice=nearest(name, names))
        if name in found:
            raise SpecError(field, allowed="is given twice")
        declared, number = known[name]
        if declared.kind == "count":
            raise SpecError(field, given, "is a whole number, which does not scatter", "compare designs with sweep()")
        found[name] = _one(muscle, field, given, name, declared, float(number), kind)
    return tuple(found.values())


def distribution_named(field: str, word: Any) -> Distribution:
    """The distribution of that name; SpecError for any other."""
    if word not in tuple(Distribution):
        raise SpecError(field, word, "must be " + " or ".join(Distribution), nearest(str(word), tuple(Distribution)))
    return Distribution(word)


def _one(
    muscle: Muscle, field: str, given: Any, name: str, declared: Declared, number: float, kind: Distribution
) -> Scattering:
    text, value = given, number
    turned = is_turned(muscle, name)
    if turned:
        value = float(from_parallels(number, muscle.braid.measured_from))
    if isinstance(given, str):
        text, _, word = given.strip().rpartition(" ")
        if word in tuple(Distribution):
            kind = Distribution(word)
        else:
            text = given
    made = Scattering(name, declared, value, _size(field, given, text, declared, value), kind, turned)
    low, high = value - made.reach, value + made.reach
    if not all(_allowed(declared, end) for end in (low, high)):
        allowed = "below 1" if _is_contraction(declared) else declared.allowed or declared.computed
        how = f"{REACH:g} standard deviations" if kind == Distribution.NORMAL else "all of the range"
        said = f"reaches from {declared.text(low)} to {declared.text(high)} ({how}), where {name} must be {allowed}"
        advice = "give a smaller one" + (', or a uniform one: "0.1 mm uniform"' if kind == Distribution.NORMAL else "")
        raise SpecError(field, given, said, advice)
    return made


def _is_contraction(declared: Declared) -> bool:
    return declared.kind in ("path", "held") and declared.unit == "1"


def _allowed(declared: Declared, value: float) -> bool:
    if _is_contraction(declared):  # what is declared is the length, whose place it takes
        return value < 1.0
    return declared.contains(value) and declared.computable(value)


def _size(field: str, given: Any, text: Any, declared: Declared, value: float) -> float:
    """How far a number scatters [SI]; text in per cent is a share of the number."""
    relative = isinstance(text, str) and text.rstrip().endswith("%")
    unit = "1" if declared.kind == "constants" else declared.unit or "1"
    if relative and unit == "1":
        said = "could mean a share of the number or a number by itself"
        raise SpecError(field, given, said, "write it as a plain number, such as 0.01")
    try:
        size = float(to_si(text, "1" if relative else unit))
    except UnitError as error:
        raise SpecError(field, given, str(error), error.advice) from error
    size = size * abs(value) if relative else size
    if size <= 0.0:
        said = "must be above 0: a standard deviation, or half the range of a uniform one"
        raise SpecError(field, given, f"is a share of {declared.text(value)}" if relative and not value else said)
    return size
