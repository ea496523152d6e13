"""What a signal is: a function of time that knows where it jumps and where it ends; its fields; a constant one."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, spec
from mckibben.units import UnitError, split, to_si

__all__ = ["TINY", "Constant", "Signal", "read_value", "read_values", "time_field", "value_field"]

TINY = 1e-9
"""Part of a period, or of a second, by which a time may miss a jump."""


def read_value(value: Any, field: str, declared: Declared) -> Any:
    """A number, or text with a unit as it stands: which unit it must be is known where the signal is used."""
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        value = f"{value.magnitude!r} {value.units:D}"
    if isinstance(value, str):
        if split(value) is None:
            raise SpecError(field, value, "must be a number, with its unit where it has one", 'such as "60 mm"')
        return value
    try:
        return to_si(value, "1")
    except UnitError as error:
        raise SpecError(field, value, str(error)) from error


def value_field(meaning: str, default: Any = None, **about: Any) -> Any:
    """A value of a signal: a number or text with a unit."""
    if default is not None:
        about["default"] = default
    return declare(Declared(kind="value", read=read_value, meaning=meaning, **about))


def read_values(value: Any, field: str, declared: Declared) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        raise SpecError(field, value, "must be a list of values")
    return tuple(read_value(one, f"{field}[{k}]", declared) for k, one in enumerate(value))


def time_field(meaning: str, **about: Any) -> Any:
    return quantity("s", meaning=meaning, low=0.0, high=1e6, **about)


class Signal:
    """A quantity over time."""

    __slots__ = ()
    kind: ClassVar[str]
    """Its word in files."""
    steady: ClassVar[bool] = True
    """Whether it is constant between its breaks."""

    def __call__(self, t: float) -> float:
        """Its value at a time [s]; at a jump that after it."""
        raise NotImplementedError

    def breaks(self, until: float) -> list[float]:
        """Times [s] up to `until` at which it jumps or has a kink."""
        return []

    @property
    def end(self) -> float:
        """The last time [s] at which it has a value."""
        return math.inf


@spec("constant")
class Constant(Signal):
    """The same value all the time.

    Args:
        value: the value, such as 1 for a valve that is open, or "60 mm" where a length is wanted.

    Raises:
        SpecError: for what is no number.

    >>> mk.Constant(0.5)(3.0)
    0.5
    """

    kind: ClassVar[str] = "constant"
    value: Reads[Any] = value_field("the value")

    def __call__(self, t: float) -> float:
        return float(self.value)
