"""A field is declared once: meaning, unit, range, source. Checks, errors, TOML and the reference page derive from that.

A spec class is an immutable attrs class made by `@spec("dotted.path")`; its fields are made by `quantity`, `count`,
`choice`, `words` and `part`. The converter of each field reads what the user gave and checks it in one go, so that an
error can quote the user's own words. JAX tracers and arrays pass through unread: numbers are differentiable leaves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import StrEnum
from typing import Any, TypeVar, dataclass_transform

import attrs

from mckibben.shown import Shown
from mckibben.spec.declared import Declared, as_call, declare
from mckibben.spec.errors import SpecError, near
from mckibben.spec.plausible import Doubt, reading
from mckibben.units import DISPLAY, Number, UnitError, is_traced, to_si

__all__ = [
    "check_size",
    "choice",
    "count",
    "part",
    "quantities",
    "quantity",
    "read_count",
    "read_quantity",
    "spec",
    "spec_classes",
    "switch",
    "words",
]

T = TypeVar("T")
_CLASSES: list[type] = []


def read_quantity(value: Any, field: str, declared: Declared) -> Number:
    """The SI float of what a user gave for `declared`, checked against its range."""
    try:
        number = to_si(value, declared.unit)
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error
    if is_traced(number):
        return number
    meant = reading([value], declared.unit, declared.doubt)
    if not declared.contains(number):
        raise SpecError(field, value, f"must be {declared.allowed}", meant or declared.advice)
    if meant:
        raise SpecError(field, value, "a number without a unit is in SI", meant)
    check_size(number, value, field, declared)
    return number


def check_size(number: Number, value: Any, field: str, declared: Declared) -> None:
    """SpecError for a number in range that is so small or large that nobody means it, and nothing comes of it."""
    if not is_traced(number) and not declared.computable(number):
        said = f"is beyond what can be computed: {declared.computed}"
        raise SpecError(field, value, said, "check its unit")


def quantity(
    unit: str,
    *,
    meaning: str,
    low: float = -math.inf,
    high: float = math.inf,
    low_open: bool = False,
    high_open: bool = False,
    size: tuple[float, float] = (0.0, math.inf),
    display: str = "",
    source: str = "",
    advice: str = "",
    default: Any = attrs.NOTHING,
    explain: Callable[[float], str] | None = None,
    doubt: Doubt | None = None,
    read: Callable[[Any, str, Declared], Number] = read_quantity,
) -> Any:
    """A number with an SI unit ("1" for none). With `default=None` the field may be left out.

    `size`: the least and the largest magnitude that are computed, beside 0 where that is in range. `read`: what reads
    a number that people write in a way of its own.
    """
    return declare(
        Declared(
            kind="quantity", read=read, unit=unit, meaning=meaning, low=low, high=high, low_open=low_open,
            high_open=high_open, size=size, display=display or DISPLAY.get(unit, ""), source=source, advice=advice,
            default=default, explain=explain, doubt=doubt,
        )
    )  # fmt: skip


def _read_quantities(value: Any, field: str, declared: Declared) -> tuple[Number, ...]:
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        raise SpecError(field, value, "must be a list of numbers")
    read = tuple(read_quantity(item, f"{field}[{index}]", declared) for index, item in enumerate(value))
    if not read:
        raise SpecError(field, value, "must hold at least one number")
    return read


def quantities(
    unit: str,
    *,
    meaning: str,
    low: float = -math.inf,
    high: float = math.inf,
    low_open: bool = False,
    high_open: bool = False,
    size: tuple[float, float] = (0.0, math.inf),
    display: str = "",
    source: str = "",
    advice: str = "",
    default: Any = attrs.NOTHING,
    doubt: Doubt | None = None,
    read: Callable[[Any, str, Declared], tuple[Number, ...]] = _read_quantities,
) -> Any:
    """A list of one or more numbers with the same unit, stored as a tuple; with `default=None` it may be left out."""
    return declare(
        Declared(
            kind="quantities", read=read, unit=unit, meaning=meaning, low=low, high=high, low_open=low_open,
            high_open=high_open, size=size, display=display or DISPLAY.get(unit, ""), source=source, advice=advice,
            default=default, doubt=doubt, quiet=default is None,
        )
    )  # fmt: skip


def read_count(value: Any, field: str, declared: Declared) -> Number:
    """The whole number that a user gave for `declared`, checked against its range."""
    if is_traced(value):
        return value
    try:
        number = to_si(value, "1")
    except UnitError as error:
        raise SpecError(field, value, "must be a whole number") from error
    if isinstance(value, str) or number != int(number):
        raise SpecError(field, value, "must be a whole number", "such as 56, without quotes")
    if not declared.contains(number):
        raise SpecError(field, value, f"must be {declared.allowed}", declared.advice)
    return int(number)


def count(
    *,
    meaning: str,
    low: int = 0,
    high: float = math.inf,
    source: str = "",
    advice: str = "",
    default: Any = attrs.NOTHING,
    static: bool = False,
    read: Callable[[Any, str, Declared], Number] = read_count,
) -> Any:
    """A whole number, such as that of the fibres. With `static` it cannot be varied (such as the number of states)."""
    return declare(
        Declared(
            kind="count", read=read, meaning=meaning, low=low, high=high, source=source, advice=advice,
            default=default, static=static,
        )
    )  # fmt: skip


def _read_words(value: Any, field: str, declared: Declared) -> Any:
    if declared.kind == "text":
        if isinstance(value, str):
            return value
        raise SpecError(field, value, "must be text")
    if isinstance(value, str) or not isinstance(value, (list, tuple)) or not all(isinstance(w, str) for w in value):
        raise SpecError(field, value, "must be a list of names")
    return tuple(value)


def words(*, meaning: str, many: bool = False, default: Any = None) -> Any:
    """Free text, or with `many` a tuple of names."""
    return declare(Declared(kind="names" if many else "text", read=_read_words, meaning=meaning, default=default))


def _read_switch(value: Any, field: str, declared: Declared) -> bool:
    if isinstance(value, bool):
        return value
    raise SpecError(field, value, "must be true or false", "without quotes in a file; True or False in Python")


def switch(*, meaning: str, source: str = "", default: bool = False) -> Any:
    """An effect that is on or off; off unless said."""
    return declare(
        Declared(kind="switch", read=_read_switch, meaning=meaning, source=source, default=default, quiet=True)
    )


def choice(
    options: type[StrEnum], *, meaning: str, default: Any = attrs.NOTHING, stored: bool = True, quiet: bool = False,
    source: str = "",
) -> Any:  # fmt: skip
    """One word out of an enumeration; the value compares equal to the word."""

    def read(value: Any, field: str, declared: Declared) -> StrEnum:
        if isinstance(value, str) and value in declared.options:
            return options(value)
        advice = near(value, declared.options) if isinstance(value, str) else ""
        raise SpecError(field, value, f"must be {declared.allowed}", advice)

    names = tuple(str(option) for option in options)
    return declare(
        Declared(
            kind="choice", read=read, meaning=meaning, options=names, default=default, stored=stored, quiet=quiet,
            source=source,
        )
    )  # fmt: skip


def _read_part(value: Any, field: str, declared: Declared) -> Any:
    if isinstance(value, declared.parts):
        return value
    names = " or ".join(kind.__name__ for kind in declared.parts)
    advice = f"write {field.rpartition('.')[2]}=mk.{declared.parts[0].__name__}(...)"
    raise SpecError(field, value, f"must be a {names}", advice)


def part(
    *kinds: type, meaning: str, default: Any = attrs.NOTHING, quiet: bool = False, kw_only: bool = False
) -> Any:  # fmt: skip
    """A field that holds another spec object, of one of `kinds`; `kw_only` where fields before it may be left out."""
    declared = Declared(kind="part", read=_read_part, meaning=meaning, parts=kinds, default=default, quiet=quiet)
    return declare(declared, kw_only)


@dataclass_transform(
    frozen_default=True, field_specifiers=(quantity, quantities, count, choice, switch, words, part, declare)
)
def spec(path: str = "") -> Callable[[type[T]], type[T]]:
    """Class decorator: an immutable value class whose errors name its fields as `path`.name.

    One without a path has fields for others, which are derived from it, and is not listed.
    """

    def make(cls: type[T]) -> type[T]:
        cls.__spec_path__ = path  # type: ignore[attr-defined]
        made = attrs.define(frozen=True, repr=False)(cls)
        made.__repr__ = as_call  # type: ignore[method-assign]
        made._repr_html_ = Shown._repr_html_  # type: ignore[attr-defined]
        if path:
            _CLASSES.append(made)
        return made

    return make


def spec_classes() -> tuple[type, ...]:
    """Every spec class, in the order of definition."""
    return tuple(_CLASSES)
