"""What changes with time in a rig: signals, each as a function of time that knows where it jumps and where it ends."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any, ClassVar, TypeVar

from mckibben.spec.declared import Declared, Reads, declare, describe, evolved
from mckibben.spec.errors import SpecError, near
from mckibben.spec.fields import choice, quantities, quantity, spec
from mckibben.spec.held import Between
from mckibben.spec.plausible import CONTROLLED, reading
from mckibben.units import UnitError, show, split, to_si

__all__ = ["PWM", "SIGNALS", "Constant", "Jump", "Ramp", "Series", "Signal", "Sine", "resolved", "signal_field"]

S = TypeVar("S", bound="Signal")
TINY = 1e-9
"""Part of a period, or of a second, by which a time may miss a jump."""


def _read_value(value: Any, field: str, declared: Declared) -> Any:
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
    return declare(Declared(kind="value", read=_read_value, meaning=meaning, **about))


def _read_values(value: Any, field: str, declared: Declared) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        raise SpecError(field, value, "must be a list of values")
    return tuple(_read_value(one, f"{field}[{k}]", declared) for k, one in enumerate(value))


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
        if not self.stop > self.start:
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
        Declared(kind="value", read=_read_value, meaning="half of the way from the lowest to the highest value")
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


@spec("series")
class Series(Signal):
    """Values at given times, with straight lines between them or each held until the next.

    Before the first time it has the first value. It ends with its last time: a simulation may not be longer.

    Args:
        time: times [s], each after the one before.
        value: as many values.
        between: "line" or "hold".

    Raises:
        SpecError: for lists of different length, times that do not rise, or what is no number.

    >>> mk.Series(time=[0.0, 1.0, 2.0], value=[0.0, 1.0, -1.0])(0.5)
    0.5
    """

    kind: ClassVar[str] = "series"
    time: Reads[tuple[float, ...]] = quantities("s", meaning="times, each after the one before", size=(0.0, 1e6))
    value: Reads[tuple[Any, ...]] = declare(Declared(kind="values", read=_read_values, meaning="as many values"))
    between: Reads[Between] = choice(Between, meaning="what the values are between the times", default=Between.LINE)

    def __attrs_post_init__(self) -> None:
        if len(self.time) != len(self.value):
            said = f"must be {len(self.time)} values, as many as there are times, not {len(self.value)}"
            raise SpecError("series.value", allowed=said)
        for k in range(1, len(self.time)):
            if not self.time[k] > self.time[k - 1]:
                said = f"must be after the time before, {show(self.time[k - 1], 's')}"
                raise SpecError(f"series.time[{k}]", show(self.time[k], "s"), said)

    @property
    def steady(self) -> bool:  # type: ignore[override]
        return self.between == Between.HOLD

    def __call__(self, t: float) -> float:
        k = bisect_right(self.time, t + TINY)
        if k == 0 or k == len(self.time) or self.between == Between.HOLD:
            return float(self.value[max(k - 1, 0)])
        t0, t1, a, b = self.time[k - 1], self.time[k], self.value[k - 1], self.value[k]
        return float(a + (b - a) * (t - t0) / (t1 - t0))

    def breaks(self, until: float) -> list[float]:
        return [t for t in self.time if t <= until]

    @property
    def end(self) -> float:
        return self.time[-1]


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
    if isinstance(signal, Sine):  # what must be in range is the sum
        top = abs(made["amplitude"])
        for end in (made["mean"] - top, made["mean"] + top):
            _check(end, signal.amplitude, unit, f"{field}.amplitude", low, high)
    return evolved(signal, **made)


def _si(value: Any, unit: str, field: str, low: float, high: float) -> float:
    try:
        number = float(to_si(value, unit))
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error
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
        if isinstance(value, (str, int, float)) or hasattr(value, "magnitude"):
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
