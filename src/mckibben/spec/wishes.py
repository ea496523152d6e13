"""What is wanted of a muscle that is to be designed: a `Measure` of it, with a limit (`Demand`) or a sense."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import attrs

from mckibben.spec.errors import SpecError
from mckibben.units import DISPLAY, UnitError, show, to_si

__all__ = ["Demand", "Goal", "Maximise", "Measure", "Minimise", "text_of"]


def text_of(value: float, unit: str, display: str = "", digits: int = 4) -> str:
    """A value as people read it: in the unit `display`, "%" included, or the usual one for its SI unit."""
    if not math.isfinite(value):
        return "unknown"
    if display == "%":
        return f"{100.0 * value:.{digits}g} %"
    return show(value, display or DISPLAY.get(unit, unit), digits)


class Measure:
    """A number by which a muscle is judged; `measure >= "150 N"` is a demand on it."""

    __slots__ = ()
    kind: ClassVar[str]
    """Its word in files."""
    meaning: ClassVar[str]
    unit: ClassVar[str]
    """SI unit of its value, "1" for none."""
    display: ClassVar[str] = ""
    """Unit that people see, where it is not the usual one."""
    low: ClassVar[float] = -math.inf
    """What its value always is above."""
    high: ClassVar[float] = math.inf
    """What its value always is below."""

    @property
    def said(self) -> str:
        """The measure in words: "force at 10 % contraction and 4 bar"."""
        return f"{self.meaning} {self.where}".rstrip()

    @property
    def where(self) -> str:
        """At which states, in words; empty for what no state is needed for."""
        return ""

    def text(self, value: float) -> str:
        """A value of this measure in the unit that people see."""
        return text_of(value, self.unit, self.display)

    def __ge__(self, limit: Any) -> Demand:
        return Demand(self, least=limit)

    def __le__(self, limit: Any) -> Demand:
        return Demand(self, most=limit)

    __gt__, __lt__ = __ge__, __le__


def _read_measure(value: Any, field: str) -> Measure:
    if isinstance(value, Measure):
        return value
    advice = 'such as mk.ForceAt(pressure="4 bar", contraction="10 %")'
    raise SpecError(field, value, "must be a measure of a muscle", advice)


def _of_demand(value: Any) -> Measure:
    return _read_measure(value, "demand.measure")


def _of_goal(value: Any) -> Measure:
    return _read_measure(value, "objective")


@attrs.frozen(repr=False)
class Demand:
    """A measure with limits: what a design must fulfil.

    Made by comparing: `mk.Stroke(pressure="4 bar") >= "20 %"`. Give both limits here for a measure that must lie
    between.

    Args:
        measure: what is limited, such as `ForceAt` or `Diameter`.
        least: least value, in the unit of the measure, or None.
        most: largest value, or None.

    Raises:
        SpecError: for no limit, one of another unit, one that no muscle keeps or breaks, or least above most.

    >>> demand = mk.ForceAt(pressure="4 bar", contraction="10 %") >= "150 N"
    >>> demand.said
    'force at 10 % contraction and 4 bar at least 150 N'
    >>> mk.Demand(mk.Diameter(pressure="4 bar"), least="20 mm", most="30 mm").most  # m
    0.03
    """

    measure: Measure = attrs.field(converter=_of_demand)
    least: float | None = None
    most: float | None = None

    def __init__(self, measure: Any, least: Any = None, most: Any = None) -> None:
        read = _of_demand(measure)
        low, high = _limit(read, "least", least), _limit(read, "most", most)
        if low is None and high is None:
            raise SpecError(read.kind, allowed="is given no limit", advice="write at_least or at_most")
        if low is not None and high is not None and not low < high:
            raise SpecError(f"{read.kind}.at_least", least, f"must be below at_most, {read.text(high)}")
        self.__attrs_init__(read, low, high)  # type: ignore[attr-defined]

    def __bool__(self) -> bool:
        advice = 'mk.Demand(measure, least="20 mm", most="30 mm")'
        raise SpecError(self.measure.kind, allowed="cannot be compared twice in a row", advice=f"write {advice}")

    @property
    def said(self) -> str:
        """The demand in words."""
        return f"{self.measure.said} {self.limits}"

    @property
    def limits(self) -> str:
        """Its limits in words."""
        said = (("at least", self.least), ("at most", self.most))
        return " and ".join(f"{word} {self.measure.text(value)}" for word, value in said if value is not None)

    def __repr__(self) -> str:
        return f"<Demand: {self.said}>"


def _limit(measure: Measure, name: str, value: Any) -> float | None:
    """A limit in SI. SpecError where it is no number of the measure's unit, or out of its range."""
    if value is None:
        return None
    field = f"{measure.kind}.at_{name}"
    try:
        number = float(to_si(value, measure.unit))
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error
    if number <= measure.low:
        raise SpecError(field, value, f"must be above {measure.text(measure.low)}, as every {measure.meaning} is")
    if number >= measure.high:
        said = f"must be below {measure.text(measure.high)}, as every {measure.meaning} is"
        raise SpecError(field, value, said, 'write it like "20 %" or 0.2')
    return number


@attrs.frozen(repr=False)
class Goal:
    """A measure that is to be as large, or as small, as can be."""

    measure: Measure = attrs.field(converter=_of_goal)
    sense: ClassVar[str] = ""
    sign: ClassVar[float] = 1.0
    """Its value times this is what is made least."""

    @property
    def said(self) -> str:
        """The goal in words."""
        return f"{self.sense} {self.measure.said}"

    def __repr__(self) -> str:
        return f"<{self.said}>"


@attrs.frozen(repr=False)
class Maximise(Goal):
    """A measure that is to be as large as can be.

    Args:
        measure: such as `ForceAt`, `Stroke` or `Work`.

    Raises:
        SpecError: for what is no measure.

    >>> mk.Maximise(mk.Stroke(pressure="4 bar")).said
    'maximise free contraction at 4 bar'
    """

    sense: ClassVar[str] = "maximise"
    sign: ClassVar[float] = -1.0


@attrs.frozen(repr=False)
class Minimise(Goal):
    """A measure that is to be as small as can be.

    Args:
        measure: such as `Mass`, `Diameter` or `PressureFor`.

    Raises:
        SpecError: for what is no measure.

    >>> mk.Minimise(mk.PressureFor(force="100 N", contraction="10 %")).said
    'minimise pressure for 100 N at 10 % contraction'
    """

    sense: ClassVar[str] = "minimise"
