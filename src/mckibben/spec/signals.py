"""What changes with time in a rig: signals by what a laboratory sets, and fields that take one."""

from __future__ import annotations

import math
from typing import Any, ClassVar, TypeVar

from mckibben.spec.declared import Declared, Reads, declare, describe, evolved
from mckibben.spec.errors import SpecError, near
from mckibben.spec.fields import quantity, spec
from mckibben.spec.plausible import CONTROLLED, reading
from mckibben.spec.series import Series
from mckibben.spec.signal import TINY, Constant, Signal, read_value, time_field, value_field
from mckibben.units import Number, UnitError, is_traced, show, to_si

__all__ = ["PWM", "SIGNALS", "Jump", "Ramp", "Sine", "resolved", "signal_field"]

S = TypeVar("S", bound=Signal)


@spec("jump")
class Jump(Signal):
    """One value before a time and another from it on.

    Args:
        after: the value from the jump on.
        before: the value before it.
        at: when it jumps [s].

    Raises:
        SpecError: for what is no number, or no time.

    >>> signal = mk.Jump(1.0, at="100 ms")
    >>> signal(0.05), signal(0.2)
    (0.0, 1.0)
    """

    kind: ClassVar[str] = "jump"
    after: Reads[Any] = value_field("value from the jump on")
    before: Reads[Any] = value_field("value before it", 0.0)
    at: Reads[float] = time_field("when it jumps", default=0.0)

    def __call__(self, t: float) -> float:
        return float(self.after if t >= self.at - TINY else self.before)

    def breaks(self, until: float) -> list[float]:
        return [self.at]


@spec("ramp")
class Ramp(Signal):
    """From one value to another along a straight line in time, and constant before and after.

    Args:
        to: the last value.
        begin: the first value.
        start: when it begins [s].
        stop: when it ends [s], after its beginning.

    Raises:
        SpecError: for what is no number, or an end before the beginning.

    >>> mk.Ramp(1.0, start="0 s", stop="2 s")(0.5)
    0.25
    """

    kind: ClassVar[str] = "ramp"
    steady: ClassVar[bool] = False
    to: Reads[Any] = value_field("last value")
    begin: Reads[Any] = value_field("first value", 0.0)
    start: Reads[float] = time_field("when it begins", default=0.0)
    stop: Reads[float] = time_field("when it ends", default=1.0)

    def __attrs_post_init__(self) -> None:
        if not is_traced(self.stop) and not is_traced(self.start) and not self.stop > self.start:
            said = f"must be after the beginning, {show(self.start, 's')}"
            raise SpecError("ramp.stop", show(self.stop, "s"), said, "or use a Jump")

    def __call__(self, t: float) -> float:
        share = min(max((t - self.start) / (self.stop - self.start), 0.0), 1.0)
        return float(self.begin + share * (self.to - self.begin))

    def breaks(self, until: float) -> list[float]:
        return [self.start, self.stop]


@spec("sine")
class Sine(Signal):
    """A sine about a mean: mean + amplitude sin(2 pi frequency t + phase).

    Args:
        amplitude: half of the way from the lowest to the highest value.
        frequency: periods per second [Hz].
        mean: the middle value.
        phase: phase at time 0 [rad].

    Raises:
        SpecError: for what is no number, or a frequency out of range.

    >>> mk.Sine(0.5, frequency="2 Hz", mean=0.5)(0.125)
    1.0
    """

    kind: ClassVar[str] = "sine"
    steady: ClassVar[bool] = False
    amplitude: Reads[Any] = declare(
        Declared(kind="value", read=read_value, meaning="half of the way from the lowest to the highest value")
    )
    frequency: Reads[float] = quantity("1/s", meaning="periods per second", low=0.0, low_open=True, high=1e4)
    mean: Reads[Any] = value_field("middle value", 0.0)
    phase: Reads[float] = quantity("rad", meaning="phase at time 0", low=-1e3, high=1e3, default=0.0)

    def __call__(self, t: float) -> float:
        return float(self.mean + self.amplitude * math.sin(2.0 * math.pi * self.frequency * t + self.phase))


@spec("pwm")
class PWM(Signal):
    """Pulse width modulation: high for a part of each period, low for the rest.

    The duty is taken at the beginning of each period. On a valve a pulse from 1 to -1 is what a 3/2-way valve does:
    it fills or vents, and is never closed.

    Args:
        duty: part of a period that is high, 0 to 1; a number or a signal.
        frequency: periods per second [Hz].
        high: value of the first part.
        low: value of the rest.

    Raises:
        SpecError: for a duty outside of 0 to 1, or a frequency out of range.

    >>> signal = mk.PWM(0.25, frequency="10 Hz")
    >>> signal(0.01), signal(0.05)
    (1.0, -1.0)
    """

    kind: ClassVar[str] = "pwm"
    duty: Any = declare(
        Declared(kind="signal", read=lambda value, field, declared: _read_signal(value, field, declared), unit="1",
                 meaning="part of a period that is high, a number or a signal", low=0.0, high=1.0)
    )  # fmt: skip
    frequency: Reads[float] = quantity("1/s", meaning="periods per second", low=0.0, low_open=True, high=1e4)
    high: Reads[Any] = value_field("value of the first part", 1.0)
    low: Reads[Any] = value_field("value of the rest", -1.0)

    def share(self, period: int) -> float:
        """The duty of a period, counted from 0."""
        return min(max(self.duty(period / self.frequency + TINY), 0.0), 1.0)

    def __call__(self, t: float) -> float:
        turns = t * self.frequency + TINY
        period = math.floor(turns)
        return float(self.high if turns - period < self.share(period) else self.low)

    def breaks(self, until: float) -> list[float]:
        found: list[float] = []
        for period in range(math.floor(until * self.frequency) + 1):
            found += [period / self.frequency, (period + self.share(period)) / self.frequency]
        return found

    @property
    def end(self) -> float:
        return float(self.duty.end)


SIGNALS: dict[str, type] = {cls.kind: cls for cls in (Constant, Jump, Ramp, Sine, PWM, Series)}
"""The signals by their words in files."""


def resolved(signal: S, unit: str, field: str, low: float = -math.inf, high: float = math.inf) -> S:
    """A signal with its values as SI numbers of a unit. SpecError, named by where it is used, for any other."""
    made: dict[str, Any] = {}
    for declared in describe(type(signal)):
        value = getattr(signal, declared.name)
        if declared.kind == "value":
            made[declared.name] = _si(value, unit, f"{field}.{declared.name}", low, high)
        elif declared.kind == "values":
            made[declared.name] = tuple(
                _si(one, unit, f"{field}.{declared.name}[{k}]", low, high) for k, one in enumerate(value)
            )
    known = not any(is_traced(one) for one in made.values())
    if isinstance(signal, Sine) and known:  # what must be in range is the sum
        top = abs(made["amplitude"])
        for end in (made["mean"] - top, made["mean"] + top):
            _check(end, signal.amplitude, unit, f"{field}.amplitude", low, high)
    return evolved(signal, **made)


def _si(value: Any, unit: str, field: str, low: float, high: float) -> Number:
    try:
        number = to_si(value, unit)
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error
    if is_traced(number):
        return number
    meant = reading([value], unit, CONTROLLED.get(unit))
    if meant:
        raise SpecError(field, value, "a number without a unit is in SI", meant)
    if not field.endswith(".amplitude"):
        _check(number, value, unit, field, low, high)
    return number


def _check(number: float, value: Any, unit: str, field: str, low: float, high: float) -> None:
    if not low - 1e-12 <= number <= high + 1e-12:
        ends = [f"at least {show(low, unit)}"] * (low > -math.inf) + [f"at most {show(high, unit)}"] * (high < math.inf)
        raise SpecError(field, value, f"must be {' and '.join(ends)}")


def _read_signal(value: Any, field: str, declared: Declared) -> Any:
    """A signal, or a number or text for a constant one, with its values in SI."""
    if not isinstance(value, Signal):
        if isinstance(value, (str, int, float)) or hasattr(value, "magnitude") or is_traced(value):
            value = Constant(value)
        else:
            names = ", ".join(cls.__name__ for cls in SIGNALS.values())
            given = type(value).__name__
            said = f"must be a number or a signal: {names}"
            raise SpecError(field, value, said, near(given, [cls.__name__ for cls in SIGNALS.values()]))
    try:
        return resolved(value, declared.unit, field, declared.low, declared.high)
    except SpecError as error:
        if isinstance(value, Constant):
            raise error.renamed(field) from error
        raise


def signal_field(unit: str, meaning: str, default: Any = None, **about: Any) -> Any:
    """A number or a signal whose values have a unit."""
    return declare(
        Declared(kind="signal", read=_read_signal, unit=unit, meaning=meaning, default=default,
                 parts=tuple(SIGNALS.values()), **about)
    )  # fmt: skip
