"""What decides the command of a valve as it goes: a function of the user's own, or a PID controller."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, quantity, spec
from mckibben.spec.signal import Signal
from mckibben.spec.signals import resolved
from mckibben.units import is_traced, show

__all__ = ["CONTROLS", "PID", "UNITS", "Controlled", "Controller"]


class Controlled(StrEnum):
    """What a controller holds at its target."""

    LENGTH = "length"
    ANGLE = "angle"
    FORCE = "force"
    PRESSURE = "pressure"


UNITS = {Controlled.LENGTH: "m", Controlled.ANGLE: "rad", Controlled.FORCE: "N", Controlled.PRESSURE: "Pa"}
"""SI units of what is held."""


def _every(default: Any = "10 ms") -> Any:
    return quantity(
        "s", meaning="time between two calls", low=0.0, low_open=True, high=1e6, size=(1e-6, 1e6), default=default
    )


def _read_function(value: Any, field: str, declared: Declared) -> Any:
    if callable(value) and not isinstance(value, Signal):
        return value
    raise SpecError(field, value, "must be a function", "of time [s] and what is seen, that gives a command")


@spec("controller")
class Controller:
    """A function of your own that is called at every sample and gives the command until the next one.

    Args:
        function: called as function(t, seen): the time [s], and a mapping of what is measured then, in SI: "length",
            "speed", "force", "pressure" (gauge); of two muscles on a pulley "angle" and "angular_speed" too, and what
            belongs to the second muscle with `antagonist_` before it. It gives a command from -1 (vent) over 0
            (closed) to 1 (fill), or two of them for two muscles.
        every: time between two calls [s].

    Raises:
        SpecError: for what is no function, or no time. While simulating: for a command that is no number.

    >>> controller = mk.Controller(lambda t, seen: 1.0 if seen["length"] > 0.08 else -1.0, every="5 ms")
    >>> controller.every  # s
    0.005
    """

    kind: ClassVar[str] = "controller"
    function: Callable[..., Any] = declare(
        Declared(kind="function", read=_read_function, meaning="function of time and what is seen, gives the command")
    )
    every: Reads[float] = _every()


def _read_target(value: Any, field: str, declared: Declared) -> Any:
    if isinstance(value, Signal):
        return value
    from mckibben.spec.signal import Constant

    return Constant(value)


@spec("pid")
class PID:
    """A PID controller: command = kp e + ki (integral of e) + kd (rate of e), within limits, at every sample.

    The error e is positive where more air is needed: the target less what is seen, of a length the other way around.
    The rate is that of what is seen, so that a jump of the target makes none. While the command is at a limit, the
    integral does not grow further (anti-windup). Of two muscles the first one gets the command and the second one its
    negative.

    Args:
        of: what is held: "length", "angle" (of a pulley), "force" or "pressure" (gauge; of the first muscle).
        target: its target, a value with a unit or a signal.
        kp: command per error, in SI units of the error (per m, per rad, per N, per Pa).
        ki: command per error and second.
        kd: command per rate of the error.
        every: time between two samples [s].
        low: lowest command.
        high: highest command.
        filter: time constant by which the rate is smoothed [s].

    Raises:
        SpecError: for a target in a wrong unit, limits that are none, or a value out of range.

    >>> pid = mk.PID(of="angle", target=mk.Jump("20 deg", at="0.1 s"), kp=3.0, ki=5.0)
    >>> pid.target(0.2).__round__(4)  # rad
    0.3491
    """

    kind: ClassVar[str] = "pid"
    of: Reads[Controlled] = choice(Controlled, meaning="what is held")
    target: Any = declare(
        Declared(kind="signal", read=_read_target, meaning="its target: a value with a unit, or a signal")
    )
    kp: Reads[float] = quantity("1", meaning="command per error (SI)", low=0.0, high=1e12)
    ki: Reads[float] = quantity("1", meaning="command per error (SI) and second", low=0.0, high=1e12, default=0.0)
    kd: Reads[float] = quantity("1", meaning="command per rate of the error (SI)", low=0.0, high=1e12, default=0.0)
    every: Reads[float] = _every("5 ms")
    low: Reads[float] = quantity("1", meaning="lowest command", low=-1.0, high=1.0, default=-1.0)
    high: Reads[float] = quantity("1", meaning="highest command", low=-1.0, high=1.0, default=1.0)
    filter: Reads[float] = quantity(
        "s", meaning="time constant by which the rate is smoothed", low=0.0, high=1e3, default=0.0
    )

    def __attrs_post_init__(self) -> None:
        try:
            made = resolved(self.target, UNITS[self.of], "pid.target")
        except SpecError as error:
            raise SpecError(
                "pid.target", error.value, f"{error.allowed}, as {self.of} is held", error.advice
            ) from error
        object.__setattr__(self, "target", made)
        if not is_traced(self.low) and not is_traced(self.high) and not self.low < self.high:
            raise SpecError("pid.low", show(self.low, "1"), f"must be below the highest command, {self.high:g}")


CONTROLS: dict[str, type] = {cls.kind: cls for cls in (PID, Controller)}
"""The controllers by their words in files."""
