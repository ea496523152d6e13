"""The commands of the valves while a rig moves: signals, functions called at their samples, PID controllers."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping
from typing import Any

import attrs

from mckibben.spec.controls import PID, Controlled, Controller
from mckibben.spec.errors import SpecError
from mckibben.spec.rig import Rig
from mckibben.spec.signal import TINY, Signal
from mckibben.units import show

__all__ = ["Commands"]

Look = Callable[[], Mapping[str, float]]
"""Gives what is measured now."""
MOST = 1_000_000
"""Samples and jumps of a simulation at most."""


@attrs.define
class _Sampled:
    """A controller with what it said so far."""

    given: PID | Controller
    field: str
    times: list[float] = attrs.Factory(list)  #: when each command reaches the valve, without its dead time
    said: list[tuple[float, float]] = attrs.Factory(list)
    integral: float = 0.0
    seen: float | None = None
    rate: float = 0.0

    def sample(self, t: float, measured: Mapping[str, float]) -> None:
        """One more command."""
        answer = self._pid(t, measured) if isinstance(self.given, PID) else self._asked(t, measured)
        self.times.append(t)
        self.said.append(answer)

    def _pid(self, t: float, measured: Mapping[str, float]) -> tuple[float, float]:
        pid = self.given
        assert isinstance(pid, PID)
        now, sign = measured[str(pid.of)], -1.0 if pid.of == Controlled.LENGTH else 1.0
        error = sign * (pid.target(t + TINY) - now)
        raw = 0.0 if self.seen is None else -sign * (now - self.seen) / pid.every
        self.seen = now
        share = pid.every / (pid.every + pid.filter)
        self.rate += share * (raw - self.rate)
        step = pid.ki * error * pid.every
        wanted = pid.kp * error + self.integral + step + pid.kd * self.rate
        command = min(max(wanted, pid.low), pid.high)
        if command == wanted or (wanted - command) * step < 0.0:  # at a limit only what leads away from it is summed up
            self.integral += step
        return command, -command

    def _asked(self, t: float, measured: Mapping[str, float]) -> tuple[float, float]:
        assert isinstance(self.given, Controller)
        answer = self.given.function(t, measured)
        several = isinstance(answer, (tuple, list))
        pair = tuple(answer) if several else (answer, None)
        if len(pair) != 2:
            raise SpecError(
                self.field, repr(answer), f"gave {len(pair)} commands at {show(t, 's', 6)}", "give one, or two"
            )
        first = self._checked(t, pair[0])
        return first, -first if pair[1] is None else self._checked(t, pair[1])

    def _checked(self, t: float, command: Any) -> float:
        try:
            number = float(command)
        except (TypeError, ValueError) as error:
            raise SpecError(
                self.field, repr(command), f"is no number, at {show(t, 's', 6)}", "give a command from -1 to 1"
            ) from error
        if not math.isfinite(number):
            said = f"is no command: the controller gave it at {show(t, 's', 6)}"
            raise SpecError(self.field, str(number), said, "give a number from -1 to 1")
        return min(max(number, -1.0), 1.0)


class Commands:
    """Who commands which valve, and when something jumps."""

    def __init__(self, rig: Rig, until: float) -> None:
        self.until = until
        self.delays = [valve.delay for valve in rig.valves]
        names = ("rig.command", "rig.antagonist_command")
        givens = (rig.command, rig.antagonist_command)[: len(rig.muscles)]
        self.samplers: list[_Sampled] = []
        self.sources: list[tuple[Any, int, float]] = []  #: per muscle: signal or sampler, which of its two, sign
        for k, given in enumerate(givens):
            if isinstance(given, (PID, Controller)):
                sampler = _Sampled(given, names[k])
                self.samplers.append(sampler)
                self.sources.append((sampler, 0, 1.0))
            elif k == 1 and given is None:
                first = self.sources[0][0]
                self.sources.append((first, 1, 1.0) if isinstance(first, _Sampled) else (first, 0, -1.0))
            else:
                self.sources.append((given, 0, 1.0))
        self.breaks = self._breaks(rig)

    def _breaks(self, rig: Rig) -> list[float]:
        """All times at which something jumps, in order, the end of the simulation last."""
        until, found = self.until, [self.until]
        outer = getattr(rig.load, "push", None) or getattr(rig.load, "torque", None)
        signals = [(outer, 0.0, f"{rig.load.kind}.{'torque' if rig.turns else 'push'}")]
        signals += [(given, self.delays[k], "rig.command" if k == 0 else "rig.antagonist_command")
                    for k, (given, _, _) in enumerate(self.sources)]  # fmt: skip
        signals += [(s.given.target, 0.0, "pid.target") for s in self.samplers if isinstance(s.given, PID)]
        for signal, delay, field in signals:
            if not isinstance(signal, Signal):
                continue
            if signal.end < until - 1e-9 * max(until, 1.0):
                said = f"ends at {show(signal.end, 's')}, before the simulation does, at {show(until, 's')}"
                raise SpecError(field, allowed=said, advice="give it values to the end, or simulate less")
            if field != "pid.target":
                found += [t + delay for t in signal.breaks(until)] + [delay] * (delay > 0.0)
        for sampler in self.samplers:
            count = math.floor(until / sampler.given.every + TINY) + 1
            if count > MOST:
                raise SpecError(sampler.field, allowed=f"asks for {count} samples", advice=f"at most {MOST} are made")
            samples = [k * sampler.given.every for k in range(count)]
            found += samples
            for delay in {self.delays[k] for k, (source, _, _) in enumerate(self.sources) if source is sampler}:
                found += [t + delay for t in samples] if delay else []
        if len(found) > MOST:
            raise SpecError("rig.command", allowed=f"jumps {len(found)} times", advice=f"at most {MOST} are simulated")
        ordered: list[float] = []
        for t in sorted(t for t in found if 0.0 < t <= until):
            if not ordered or t - ordered[-1] > TINY * max(1.0, until):
                ordered.append(t)
        if ordered[-1] < until:
            ordered[-1] = until
        return ordered

    def sample(self, t: float, look: Look) -> None:
        """Ask the controllers whose time has come."""
        measured: Mapping[str, float] | None = None
        for sampler in self.samplers:
            if t >= len(sampler.times) * sampler.given.every - 2.0 * TINY * max(1.0, self.until):
                measured = look() if measured is None else measured
                sampler.sample(t, measured)

    def between(self, a: float, b: float) -> list[Callable[[float], float]]:
        """The command of each muscle between two times without a jump."""
        return [self._one(k, a, b) for k in range(len(self.sources))]

    def _one(self, k: int, a: float, b: float) -> Callable[[float], float]:
        source, which, sign = self.sources[k]
        delay, middle = self.delays[k], 0.5 * (a + b)
        if source is None or middle < delay:
            return lambda t: 0.0
        if isinstance(source, _Sampled):
            at = bisect_right(source.times, middle - delay) - 1
            held = sign * source.said[at][which]
            return lambda t: held
        if source.steady:
            held = sign * source(middle - delay)
            return lambda t: held
        return lambda t: sign * source(t - delay)
