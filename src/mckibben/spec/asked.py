"""What the measures of a design share: their words, and the fields that several of them have."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

from mckibben.spec.constants import ATMOSPHERE
from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, spec
from mckibben.spec.loading import HIGHEST
from mckibben.spec.path import Path
from mckibben.spec.plausible import CONTROLLED
from mckibben.spec.wishes import Measure
from mckibben.units import UnitError, show

__all__ = [
    "MEASURES",
    "AtOneState",
    "Ranged",
    "between_field",
    "check_one_state",
    "contraction_field",
    "density_field",
    "force_field",
    "length_field",
    "measure",
    "percent",
    "place_said",
    "pressure_field",
]

T = TypeVar("T")

MEASURES: dict[str, type] = {}
"""The measures by their words in files."""


def measure(cls: type[T]) -> type[T]:
    """Class decorator: known in files by its word."""
    MEASURES[cls.kind] = cls  # type: ignore[attr-defined]
    return cls


def pressure_field(meaning: str = "gauge pressure", default: Any = None, **about: Any) -> Any:
    low = {"low": -ATMOSPHERE} | about
    about = {"high": HIGHEST, "doubt": CONTROLLED["Pa"], **low}
    return quantity("Pa", meaning=meaning, **about) if default is None else quantity(
        "Pa", meaning=meaning, default=default, **about
    )  # fmt: skip


def force_field(meaning: str, **about: Any) -> Any:
    return quantity("N", meaning=meaning, size=(0.0, 1e9), **about)


def contraction_field() -> Any:
    return quantity(
        "1", meaning="contraction 1 - h/H0; that as made", low=-10.0, high=1.0, high_open=True, default=None
    )


def length_field() -> Any:
    return quantity(
        "m", meaning="distance between the fittings, in place of a contraction", low=0.0, low_open=True,
        size=(1e-6, 1e3), default=None, doubt=CONTROLLED["m"],
    )  # fmt: skip


def density_field(of: str) -> Any:
    return quantity("kg/m^3", meaning=f"density of the {of}", low=0.0, low_open=True, high=3e4, default=None)


def _read_between(value: Any, field: str, declared: Declared) -> tuple[float, float]:
    advice = 'write it like "0 to 20 %", or leave it out: from as made to the free contraction'
    try:
        ends = Path.parse(value, "1").waypoints
    except UnitError as error:
        raise SpecError(field, value, str(error), advice) from error
    if len(ends) != 2 or not -10.0 <= ends[0] < ends[1] < 1.0:
        raise SpecError(field, value, "must go from a contraction to a larger one, below 100 %", advice)
    return float(ends[0]), float(ends[1])


def between_field() -> Any:
    meaning = "range of contractions; from as made to the free contraction"
    return declare(Declared(kind="range", read=_read_between, meaning=meaning, default=None, unit="1"))


def check_one_state(measure: Any) -> None:
    """SpecError where a state is given by its contraction and by its length."""
    if measure.contraction is not None and measure.length is not None:
        raise SpecError(f"{measure.kind}.length", show(measure.length, "m"), "is given beside a contraction",
                        "give one of them")  # fmt: skip


def percent(value: float) -> str:
    return f"{100.0 * value:.4g} %"


def place_said(measure: Any, as_made: str) -> str:
    """Where a measure of one state is taken, in words."""
    if measure.length is not None:
        return show(measure.length, "m", 4)
    return as_made if measure.contraction is None else f"{percent(measure.contraction)} contraction"


def _range(measure: Any) -> str:
    """Where a measure of a range of states is taken, in words."""
    low, high = ("the length as made", "the free contraction") if measure.between is None else (
        percent(measure.between[0]), f"{percent(measure.between[1])} contraction"
    )  # fmt: skip
    return f"from {low} to {high} at {show(measure.pressure, 'Pa', 4)}"


@spec()
class AtOneState(Measure):
    """A measure of the state at one pressure and contraction, or length."""

    usual: ClassVar[str] = "the length as made"
    """Where the state is if nothing is said of it."""
    pressure: Reads[float] = pressure_field()
    contraction: Reads[float | None] = contraction_field()
    length: Reads[float | None] = length_field()

    def __attrs_post_init__(self) -> None:
        check_one_state(self)

    @property
    def where(self) -> str:
        return f"at {place_said(self, self.usual)} and {show(self.pressure, 'Pa', 4)}"


@spec()
class Ranged(Measure):
    """A measure over a range of contractions at one pressure."""

    pressure: Reads[float] = pressure_field()
    between: Reads[tuple[float, float] | None] = between_field()

    @property
    def where(self) -> str:
        return _range(self)
