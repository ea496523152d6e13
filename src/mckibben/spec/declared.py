"""What is known about a field: `Declared`, and how to list the declared fields of a spec class or a spec object."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import attrs

from mckibben.spec.angle import as_written
from mckibben.spec.plausible import Doubt, trusted
from mckibben.units import Number, is_traced, show

__all__ = ["Declared", "Reads", "as_call", "declare", "describe", "evolved", "in_own_words", "numbers", "walk"]

T = TypeVar("T")
V = TypeVar("V")


class Reads(Generic[V]):
    """For type checkers: a field that gives a V when read, and may be set from text, quantities, words and so on."""

    if TYPE_CHECKING:

        def __get__(self, instance: object, owner: Any = None) -> V: ...

        def __set__(self, instance: object, value: Any) -> None: ...


@attrs.frozen(kw_only=True)
class Declared:
    """What is known about one field. `low` and `high` are SI; `low_open` and `high_open` exclude the bound itself.

    `size` says from which magnitude on, and up to which, the program computes: generous, but no number beyond is meant.
    """

    kind: str
    meaning: str
    read: Callable[[Any, str, Declared], Any] = attrs.field(repr=False)
    name: str = ""
    unit: str = ""
    display: str = ""
    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False
    size: tuple[float, float] = (0.0, math.inf)
    source: str = ""
    advice: str = ""
    optional: bool = False
    default: Any = attrs.Factory(lambda: attrs.NOTHING)
    parts: tuple[type, ...] = ()
    options: tuple[str, ...] = ()
    stored: bool = True
    """False for a field that only says how another is read (angle_from); it may be given anew all the same."""
    doubt: Doubt | None = None
    """Sizes of a bare number that are absurd in SI and plausible in the usual unit."""
    explain: Callable[[float], str] | None = attrs.field(default=None, repr=False)
    """Says a value in full where the plain number is open to mistakes."""
    static: bool = False
    """True for a number that decides what is computed (how many states) and cannot be varied a little."""
    quiet: bool = False
    """True for an effect that is not mentioned where it is off: files and tables say what is there."""

    @property
    def required(self) -> bool:
        return self.default is attrs.NOTHING

    @property
    def allowed(self) -> str:
        """The range as a phrase: "above 0 deg and below 90 deg"; empty when any value will do."""
        if self.options:
            return "one of " + ", ".join(self.options)
        bounds = []
        if self.low > -math.inf:
            bounds.append(("above " if self.low_open else "at least ") + self.text(self.low))
        if self.high < math.inf:
            bounds.append(("below " if self.high_open else "at most ") + self.text(self.high))
        return " and ".join(bounds)

    @property
    def computed(self) -> str:
        """The sizes that are computed, as a phrase: "0.001 mm to 10000 mm"; empty where there is no limit."""
        least, most = self.size
        if most == math.inf:
            return ""
        return f"{self.text(least)} to {self.text(most)}" if least else f"up to {self.text(most)}"

    def mentioned(self, value: Any) -> bool:
        """Whether a value is worth a line in a file or a table."""
        return self.stored and not (self.quiet and value == self.default)

    def text(self, value: float) -> str:
        return f"{value:.0f}" if self.kind == "count" else show(value, self.display or self.unit)

    def explained(self, value: float) -> str:
        """A value as text, with what it may be mistaken for: an angle is shown in both conventions."""
        return self.text(value) if self.explain is None or is_traced(value) else self.explain(value)

    def contains(self, value: float) -> bool:
        """Whether an SI value is in range; NaN is in no range."""
        above = value > self.low if self.low_open else value >= self.low
        below = value < self.high if self.high_open else value <= self.high
        return above and below

    def computable(self, value: float) -> bool:
        """Whether an SI value is 0 or of a size that is computed."""
        return value == 0.0 or self.size[0] <= abs(value) <= self.size[1]


def declare(declared: Declared, kw_only: bool = False) -> Any:
    """An attrs field whose values are read and checked as `declared` says."""

    def convert(value: Any, instance: Any, attribute: Any) -> Any:
        if value is None and (declared.optional or declared.default is None):
            return None
        return declared.read(value, f"{instance.__spec_path__}.{attribute.name}", declared)

    converter: Any = attrs.Converter(convert, takes_self=True, takes_field=True)
    about = {"declared": declared}
    return attrs.field(default=declared.default, converter=converter, metadata=about, kw_only=kw_only)


def evolved(value: T, /, **changes: Any) -> T:
    """A copy of a spec object with some fields changed; the new values are read and checked as when it was made."""
    kinds = {item.name: item for item in describe(type(value))}
    read = {name: _read_again(value, kinds.get(name), new) for name, new in changes.items()}
    with trusted():  # what stays was read before
        copy: T = attrs.evolve(value, **read)  # type: ignore[misc]  # made by attrs inside `spec`
    return copy


def _read_again(owner: Any, declared: Declared | None, new: Any) -> Any:
    """A new value as its field reads it, by itself."""
    if declared is None or new is None or declared.kind not in ("quantity", "quantities", "path", "held"):
        return new
    return declared.read(new, f"{owner.__spec_path__}.{declared.name}", declared)


def describe(cls: type) -> tuple[Declared, ...]:
    """The declared fields of a spec class, in order, each with its name."""
    return _described(cls)


@cache
def _described(cls: Any) -> tuple[Declared, ...]:
    found = ((field.name, field.metadata.get("declared")) for field in attrs.fields(cls))
    return tuple(attrs.evolve(declared, name=name) for name, declared in found if declared is not None)


def walk(value: Any, prefix: str = "") -> Iterator[tuple[str, Declared, Any]]:
    """(dotted name, declaration, value) of every number, word and list in a spec object; parts are entered."""
    for declared in describe(type(value)):
        item = getattr(value, declared.name)
        if declared.kind == "part" and item is not None:
            yield from walk(item, f"{prefix}{declared.name}.")
        elif declared.mentioned(item):
            yield prefix + declared.name, declared, item


def numbers(value: Any, prefix: str = "") -> Iterator[tuple[str, Declared, Number]]:
    """(name, declaration, number) of every single number of a spec object that can be varied.

    Parts, lists and paths are entered: "braid.angle", "chamber.law.mu[1]", "pressure[0]" (just "pressure" where it is
    one value), "steps[1].length". The order is that of the leaves of the object as a JAX pytree.
    """
    for declared in describe(type(value)):
        item, name = getattr(value, declared.name), f"{prefix}{declared.name}"
        if item is None or declared.static:
            continue
        if declared.kind == "part":
            yield from numbers(item, f"{name}.")
        elif declared.kind == "steps":
            for index, step in enumerate(item):
                yield from numbers(step, f"{name}[{index}].")
        elif declared.kind in ("quantity", "count"):
            yield name, declared, item
        elif declared.kind == "constants":
            yield from ((f"{name}.{key}", declared, item[key]) for key in sorted(item))
        elif declared.kind in ("quantities", "path", "held"):
            several = item if declared.kind == "quantities" else item.waypoints
            single = declared.kind != "quantities" and len(several) == 1
            if declared.kind != "quantities" and item.called(declared.name) != declared.name:
                name = f"{prefix}{item.called(declared.name)}"
                declared = attrs.evolve(declared, unit=item.unit, display="", meaning="contraction 1 - h/H0")
            for index, number in enumerate(several):
                yield name if single else f"{name}[{index}]", declared, number


def as_call(self: Any) -> str:
    """A spec object as the Python call that makes it, in display units; fields that are None or empty are left out.

    What its class has to remark comes after it, as a comment.
    """
    remark = self.__remark__() if hasattr(self, "__remark__") else ""
    return _call(self) + (f"  # {remark}" if remark else "")


def in_own_words(value: Any) -> dict[str, Any]:
    """The fields of a spec object that say it: those that are stored, an angle as the braid's own words have it."""
    said = {
        declared.name: getattr(value, declared.name)
        for declared in describe(type(value))
        if declared.mentioned(getattr(value, declared.name))
    }
    return said | as_written(said["angle"], value.measured_from) if hasattr(value, "measured_from") else said


def _call(self: Any) -> str:
    parts = []
    own = in_own_words(self)
    for declared in describe(type(self)):
        value = own.get(declared.name)
        if declared.kind == "quantity" and isinstance(value, float) and declared.unit != "1":
            value = show(value, declared.display or declared.unit, digits=12)
        elif isinstance(value, StrEnum):
            value = str(value)
        if value is not None and not (isinstance(value, tuple) and not value):
            parts.append(f"{declared.name}={_call(value) if declared.kind == 'part' else repr(value)}")
    return f"{type(self).__name__}({', '.join(parts)})"
