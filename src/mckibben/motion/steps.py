"""`step_response()`: rise time, overshoot and settling time of a motion; `per_cycle()`: air and energy of a cycle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mckibben.motion.flow import GAS, NORMAL
from mckibben.motion.simulate import read_time
from mckibben.results.answers import Cycle, StepResponse
from mckibben.results.motion import Motion
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import show

__all__ = ["per_cycle", "step_response"]

LEVELS = (0.1, 0.9)
"""Parts of the way between which the rise time is taken."""
SETTLED = 0.05
"""Last part of a motion whose mean is the final value, where none is given."""
LEAST = 1e-9
"""Change, over the largest value, below which nothing has moved."""


def step_response(
    motion: Motion, of: str = "", *, at: Any = 0.0, final: Any = None, band: float = 0.02, muscle: int = 0
) -> StepResponse:
    """Rise time, overshoot and settling time of a quantity that goes from one value to another.

    Args:
        motion: what `simulate` gave.
        of: the quantity, such as "length", "angle", "pressure" or "force"; the angle of a pulley and the length of a
            muscle where it is left out, the pressure of one that is held.
        at: time of the step [s].
        final: value to which it settles (SI), such as a target; the mean of the last 5 % of the time where left out.
        band: half of the band within which it counts as settled, over the way.
        muscle: which muscle, 0 or 1.

    Returns:
        A `StepResponse`: rise (10 to 90 %), overshoot, settling time and so on. Times that were not reached are NaN.

    Raises:
        SpecError: for an unknown quantity, a time outside of the motion, or a quantity that does not change.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=mk.Jump(1.0, at="0.1 s"),
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> print(mk.step_response(mk.simulate(rig, until="1 s"), of="pressure", at="0.1 s"))
    pressure from 0 bar to 2 bar: rise 0.263 s, overshoot 0.0 %, settled after 0.354 s
    """
    if not isinstance(motion, Motion):
        raise SpecError("step_response.motion", motion, "must be what simulate gives")
    name = of or (
        "angle" if "angle" in motion.data else "pressure" if motion.data.attrs["load"] == "fixed" else "length"
    )
    values, unit = _values(motion, name, muscle)
    begin = float(at) if isinstance(at, (int, float)) and at == 0 else read_time(at, "step_response.at")
    time = motion.time
    if not begin < time[-1]:
        raise SpecError("step_response.at", show(begin, "s"), f"must be before the end, {show(float(time[-1]), 's')}")
    start = float(np.interp(begin, time, values))
    last = time >= time[-1] - SETTLED * (time[-1] - begin)
    end = float(values[last].mean()) if final is None else float(final)
    way = end - start
    if abs(way) <= LEAST * max(float(np.abs(values).max()), 1e-12):
        raise SpecError("step_response.of", name, f"does not change from {show(start, unit, 4)}")
    t, share = _from(time, (values - start) / way, begin)
    low, high = (_first(t, share, level) for level in LEVELS)
    over = float(share.max()) - 1.0
    peak = start + way * float(share.max())
    return StepResponse(
        of=name, unit=unit, start=start, final=end, delay=low - begin, rise=high - low,
        overshoot=max(0.0, over), peak=peak, settling=_settling(t, share, band) - begin, band=band,
    )  # fmt: skip


def _values(motion: Motion, name: str, muscle: int) -> tuple[np.ndarray, str]:
    known = [str(one) for one, variable in motion.data.data_vars.items() if variable.dtype.kind == "f"]
    if name not in known:
        raise SpecError("step_response.of", name, "is unknown", nearest(name, known))
    values = motion.of(name)
    if values.ndim == 2:
        if muscle not in range(values.shape[1]):
            raise SpecError("step_response.muscle", muscle, f"must be 0 to {values.shape[1] - 1}")
        values = values[:, muscle]
    return values, str(motion.data[name].attrs["units"])


def _from(time: np.ndarray, share: np.ndarray, begin: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and values from a time on, with the value at that time itself."""
    later = time > begin
    return np.concatenate([[begin], time[later]]), np.concatenate([[np.interp(begin, time, share)], share[later]])


def _first(t: np.ndarray, share: np.ndarray, level: float) -> float:
    """The first time at which a level is reached, between two times; NaN where it is not."""
    over = np.flatnonzero(share >= level)
    if not len(over):
        return math.nan
    k = int(over[0])
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (t[k] - t[k - 1]) * (level - share[k - 1]) / (share[k] - share[k - 1]))


def _settling(t: np.ndarray, share: np.ndarray, band: float) -> float:
    """The time from which on all values are within the band."""
    out = np.flatnonzero(np.abs(share - 1.0) > band)
    if not len(out):
        return float(t[0])
    k = int(out[-1])
    if k == len(t) - 1:
        return math.nan
    edge = 1.0 + math.copysign(band, share[k] - 1.0)
    return float(t[k] + (t[k + 1] - t[k]) * (edge - share[k]) / (share[k + 1] - share[k]))


def per_cycle(motion: Motion, period: Any, *, end: Any = None) -> Cycle:
    """Air and energy of one cycle of a motion that repeats itself: of the last one, where nothing is said.

    Args:
        motion: what `simulate` gave.
        period: how long a cycle is [s].
        end: when the cycle ends [s]; with the motion where it is left out.

    Returns:
        A `Cycle`: air in normal litres, exergy of that air, work on the load, and how far it is from a true cycle.

    Raises:
        SpecError: for a period longer than the motion.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=mk.PWM(0.5, frequency="1 Hz"),
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.05 L/s/bar", b=0.3),
    ... )
    >>> cycle = mk.per_cycle(mk.simulate(rig, until="2 s"), period="1 s")
    >>> round(cycle.air, 3), cycle.drift  # normal litres
    (0.05, 0.0)
    """
    span = read_time(period, "per_cycle.period")
    time, data = motion.time, motion.data
    last = float(time[-1]) if end is None else read_time(end, "per_cycle.end")
    if not 0.0 <= last - span <= last <= time[-1] * (1.0 + 1e-9):
        raise SpecError(
            "per_cycle.period", show(span, "s"), f"does not fit into a motion of {show(float(time[-1]), 's')}"
        )
    begin = last - span

    def of(name: str, t: float) -> float:
        values = motion.of(name).reshape(len(time), -1).sum(axis=1)
        return float(np.interp(t, time, values))

    def over(name: str) -> float:
        return of(name, last) - of(name, begin)

    about = data.attrs
    mass = NORMAL * 1e-3 * over("consumed")
    exergy = mass * GAS * about["temperature"] * math.log(about["supplied"] / about["atmosphere"])
    inside = (time > begin) & (time < last)
    at = np.concatenate([[begin], time[inside], [last]])
    work = motion.of("work").reshape(len(time), -1).sum(axis=1)
    parts = np.diff(np.interp(at, time, work))
    moving = "angle" if "angle" in data else "length"
    place = motion.of(moving).reshape(len(time), -1)[:, 0]
    spread = float(np.ptp(place))
    drift = abs(float(np.interp(last, time, place) - np.interp(begin, time, place))) / spread if spread > 0.0 else 0.0
    return Cycle(
        begin=begin, end=last, air=over("consumed"), exergy=exergy, delivered=float(parts[parts > 0.0].sum()),
        returned=float(-parts[parts < 0.0].sum()), lost=over("lost"), heat=over("heat"), drift=drift,
    )  # fmt: skip
