"""When commands and loads jump, and what they are between two jumps, as functions of the numbers of their signals.

A signal is a row of pieces: piece 0 before its first break, piece j + 1 from break j on. Which piece is at work is
known from the motion itself; what follows from that is written here on JAX arrays, so that the time of a jump has
derivatives too.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any, NamedTuple

import jax.numpy as jnp

from mckibben.spec.controls import PID
from mckibben.spec.rig import Rig
from mckibben.spec.series import Between, Series
from mckibben.spec.signal import TINY, Signal
from mckibben.spec.signals import PWM, Jump, Ramp, Sine
from mckibben.units import is_traced

__all__ = ["Moment", "Source", "commanding", "duty_piece", "moment", "moments", "outer_of", "sources_of", "value"]


class Source(NamedTuple):
    """Something that jumps at times of its own."""

    what: str  #: "signal", "delay" (a valve begins to follow its command), "sample" or "said" (it reaches the valve)
    of: int  #: of which muscle; -1 for the load


class Moment(NamedTuple):
    """One such time."""

    time: float
    source: int  #: which of the sources
    number: int  #: which of its breaks
    inner: int  #: piece of the duty of a PWM there


def outer_of(rig: Rig) -> Any:
    """Push or torque from outside: a signal, or None."""
    load = rig.load
    return getattr(load, "torque", None) if rig.turns else getattr(load, "push", None)


def commanding(rig: Rig, k: int) -> tuple[Any, float]:
    """What commands the valve of a muscle, and with which sign."""
    if k == 1 and rig.antagonist_command is None:
        return rig.command, -1.0
    return (rig.command, rig.antagonist_command)[k], 1.0


def sources_of(rig: Rig) -> tuple[Source, ...]:
    """All that jumps, in the order in which it does at the same time."""
    found = [] if outer_of(rig) is None else [Source("signal", -1)]
    for k in range(len(rig.muscles)):
        command, delay = commanding(rig, k)[0], rig.valves[k].delay
        if isinstance(command, PID):
            own = k == 0 or rig.antagonist_command is not None
            found += [Source("sample", k)] * own
        elif command is not None:
            found += [Source("delay", k)] * (is_traced(delay) or delay > 0.0) + [Source("signal", k)]
    said = [Source("said", k) for k in range(len(rig.muscles)) if isinstance(commanding(rig, k)[0], PID)]
    return (*found, *said)


def moments(rig: Rig, sources: tuple[Source, ...], until: float) -> list[Moment]:
    """All times up to the end at which something jumps, in order; of a rig whose numbers are known."""
    found = []
    for s, (what, k) in enumerate(sources):
        if what == "delay":
            times: list[float] = [rig.valves[k].delay]
        elif what == "signal":
            signal = outer_of(rig) if k < 0 else commanding(rig, k)[0]
            times = [t + (0.0 if k < 0 else rig.valves[k].delay) for t in signal.breaks(until)]
        else:
            every, delay = commanding(rig, k)[0].every, rig.valves[k].delay if what == "said" else 0.0
            times = [j * every + delay for j in range(math.floor(until / every + TINY) + 1)]
        for j, t in enumerate(times):
            if t <= until:
                found.append(Moment(float(t), s, j, duty_piece(signal, j) if what == "signal" else 0))
    return sorted(found, key=lambda one: (one.time, one.source, one.number))


def duty_piece(signal: Signal, j: int) -> int:
    """At which piece the duty of a PWM is at its break j."""
    if not isinstance(signal, PWM):
        return 0
    t = (j // 2) / signal.frequency + TINY
    return bisect_right(signal.duty.breaks(t), t)


def moment(rig: Rig, source: Source, j: Any, inner: Any) -> Any:
    """When a source has its break j."""
    what, k = source
    delay = 0.0 if k < 0 or what == "sample" else rig.valves[k].delay
    if what == "delay":
        return delay
    if what in ("sample", "said"):
        return jnp.asarray(j, float) * commanding(rig, k)[0].every + delay
    return delay + _break(outer_of(rig) if k < 0 else commanding(rig, k)[0], j, inner)


def _break(signal: Signal, j: Any, inner: Any) -> Any:
    if isinstance(signal, Jump):
        return signal.at
    if isinstance(signal, Ramp):
        return jnp.where(j == 0, signal.start, signal.stop)
    if isinstance(signal, Series):
        return jnp.stack([jnp.asarray(t, float) for t in signal.time])[jnp.clip(j, 0, len(signal.time) - 1)]
    if isinstance(signal, PWM):
        period = jnp.asarray(j // 2, float)
        share = jnp.clip(value(signal.duty, inner, period / signal.frequency), 0.0, 1.0)
        return (period + jnp.where(j % 2 == 1, share, 0.0)) / signal.frequency
    return 0.0


def value(signal: Any, piece: Any, t: Any) -> Any:
    """A signal on one of its pieces at a time."""
    if isinstance(signal, Jump):
        return jnp.where(piece > 0, signal.after, signal.before)
    if isinstance(signal, Ramp):
        share = (t - signal.start) / (signal.stop - signal.start)
        between = signal.begin + share * (signal.to - signal.begin)
        return jnp.where(piece == 0, signal.begin, jnp.where(piece == 1, between, signal.to))
    if isinstance(signal, Sine):
        return signal.mean + signal.amplitude * jnp.sin(2.0 * math.pi * signal.frequency * t + signal.phase)
    if isinstance(signal, PWM):
        return jnp.where(piece % 2 == 1, signal.high, signal.low)
    if isinstance(signal, Series):
        return _series(signal, piece, t)
    return jnp.asarray(signal.value, float)


def _series(signal: Series, piece: Any, t: Any) -> Any:
    times, values = (jnp.stack([jnp.asarray(one, float) for one in some]) for some in (signal.time, signal.value))
    n = len(signal.time)
    before = values[jnp.clip(piece - 1, 0, n - 1)]
    if signal.between == Between.HOLD or n == 1:
        return before
    k = jnp.clip(piece, 1, n - 1)
    slope = (values[k] - values[k - 1]) / (times[k] - times[k - 1])
    return jnp.where((piece == 0) | (piece == n), before, values[k - 1] + slope * (t - times[k - 1]))
