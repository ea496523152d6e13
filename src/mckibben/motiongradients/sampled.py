"""PID controllers along the rows of a motion: the same law as in `commands`, with its limits by selection."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax.numpy as jnp

from mckibben.motion.regime import Seen
from mckibben.motiongradients.moments import Source, commanding, value
from mckibben.motiongradients.rows import Rows
from mckibben.spec.controls import PID, Controlled
from mckibben.spec.rig import Rig
from mckibben.spec.signal import TINY

__all__ = ["PIDMemory", "commanded", "first_memory", "sampled"]


class PIDMemory(NamedTuple):
    """What the controllers of the muscles remember."""

    integral: Any  #: (muscles)
    seen: Any  #: (muscles) at the last sample
    rate: Any  #: (muscles) of what is seen, smoothed
    said: Any  #: (muscles, so many) commands that have not all reached the valve


def first_memory(muscles: int, kept: int) -> PIDMemory:
    """Before the first sample."""
    none = jnp.zeros(muscles)
    return PIDMemory(none, none, none, jnp.zeros((muscles, kept)))


def commanded(sources: tuple[Source, ...], rig: Rig, memory: PIDMemory, piece: Any) -> list[Any]:
    """The command of each muscle whose controller gives it, as it has reached the valve; None for the others."""
    found: list[Any] = [None] * len(rig.muscles)
    for s, (what, k) in enumerate(sources):
        if what == "said":
            _, sign = commanding(rig, k)
            whose = 0 if sign < 0.0 else k
            held = memory.said[whose, (piece[s] - 1) % memory.said.shape[1]]
            found[k] = jnp.where(piece[s] > 0, sign * held, 0.0)
    return found


def sampled(sources: tuple[Source, ...], rig: Rig, memory: PIDMemory, row: Rows, seen: Seen, y: Any) -> PIDMemory:
    """The memory after a row, at whose end there may be a sample of what is seen of the first muscle."""
    for s, (what, k) in enumerate(sources):
        if what == "sample":
            pid = commanding(rig, k)[0]
            after = _sampled(pid, k, memory, row, y[0] if pid.of == Controlled.ANGLE else getattr(seen, str(pid.of)))
            due = (row.source == s) & (row.b == 1.0)
            memory = PIDMemory(*(jnp.where(due, new, old) for new, old in zip(after, memory, strict=True)))
    return memory


def _sampled(pid: PID, k: int, memory: PIDMemory, row: Rows, now: Any) -> PIDMemory:
    sign = -1.0 if pid.of == Controlled.LENGTH else 1.0
    t = jnp.asarray(row.number, float) * pid.every
    error = sign * (value(pid.target, row.target[k], t + TINY) - now)
    raw = jnp.where(row.number == 0, 0.0, -sign * (now - memory.seen[k]) / pid.every)
    share = pid.every / (pid.every + pid.filter)
    rate = memory.rate[k] + share * (raw - memory.rate[k])
    step = pid.ki * error * pid.every
    wanted = pid.kp * error + memory.integral[k] + step + pid.kd * rate
    command = jnp.where(wanted < pid.low, pid.low, jnp.where(wanted > pid.high, pid.high, wanted))
    summed = (command == wanted) | ((wanted - command) * step < 0.0)
    return PIDMemory(
        memory.integral.at[k].set(memory.integral[k] + jnp.where(summed, step, 0.0)), memory.seen.at[k].set(now),
        memory.rate.at[k].set(rate), memory.said.at[k, row.number % memory.said.shape[1]].set(command),
    )  # fmt: skip
