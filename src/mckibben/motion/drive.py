"""Through time: SciPy's solvers from jump to jump, ended early where a mode ends; what was reached is kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import attrs
import numpy as np

from mckibben.motion.commands import Commands
from mckibben.motion.kinks import divided, marks_of
from mckibben.motion.modes import Ended, after, margin, margins
from mckibben.motion.plant import Plant
from mckibben.motion.regime import Mode, Rates, Regime
from mckibben.motion.start import Begun
from mckibben.units import show

__all__ = ["METHODS", "Driven", "Stretch", "drive"]

METHODS = ("LSODA", "Radau", "BDF", "RK45", "DOP853")
"""SciPy's solvers that may be asked for."""
CHATTER, SOON = 200, 1e-7
"""As many changes of mode within as short a time [of the whole] end a simulation."""
MOST_STEPS = 2_000_000
NEAR = 1e-3
"""Part of a step by which rates of margins are differenced."""


@attrs.define
class Stretch:
    """A part of a motion in one mode and without a jump: what derivatives of the motion go along."""

    mode: Mode
    times: list[float]  #: its beginning, and where each step of the solver ended; parts of steps between kinks
    flows: list[tuple[int, ...]] = attrs.Factory(list)  #: how air flows in each of them
    ended: Ended | None = None  #: what ended its mode; None where a jump or the end of the motion did
    rate: float = 0.0  #: how fast the margin fell through 0 there; 0 where it was below from the beginning


@attrs.define
class Driven:
    """What a simulation reached: times, states, what was seen, and what happened when."""

    times: list[float] = attrs.Factory(list)
    states: list[list[float]] = attrs.Factory(list)
    seen: list[Rates] = attrs.Factory(list)
    modes: list[str] = attrs.Factory(list)
    events: list[tuple[float, str]] = attrs.Factory(list)
    stretches: list[Stretch] = attrs.Factory(list)
    steps: int = 0
    looked: int = 0
    reason: str = ""


def drive(
    begun: Begun,
    commands: Commands,
    times: np.ndarray,
    method: str,
    tolerance: float,
    watch: Callable[[int, int], None],
    kinks: bool = False,
) -> Driven:
    """A rig from its start at the first of the times to the last of them, looked at at each.

    With `kinks` its stretches are kept, divided where rates have a kink; nothing else is changed by it.
    """
    import scipy.integrate

    solver_class = getattr(scipy.integrate, method)
    done, asked = Driven(), times.tolist()
    plant, y, regime = begun.plant, begun.state, Regime.closed(begun.plant, begun.mode)
    t, until, next_at = asked[0], asked[-1], 0
    small = _scales(plant) * tolerance
    most = min(0.05, max(1e-3, until / 50.0))
    changes: list[float] = []

    def rates(t: float, y: np.ndarray) -> list[float]:
        done.looked += 1
        return regime.rates(t, y.tolist()).state

    def keep(t: float, y: list[float]) -> None:
        done.times.append(t)
        done.states.append(y)
        done.seen.append(regime.rates(t, y))
        done.modes.append(regime.mode.moves)

    for end in commands.breaks:
        commands.sample(t, lambda: _measured(regime, t, y))  # noqa: B023  # called at once
        regime, y = _woken(attrs.evolve(regime, commands=commands.between(t, end)), t, y, done)
        if next_at == 0:
            keep(t, y)
            next_at = 1
        while t < end:
            solver = solver_class(rates, t, np.array(y), end, rtol=tolerance, atol=small, max_step=most)
            ended: Ended | None = None
            stretch = Stretch(regime.mode, [t])
            if kinks:
                done.stretches.append(stretch)
            signs = marks_of(regime, t, y) if kinks else []
            while solver.status == "running" and ended is None:
                said = solver.step()
                done.steps += 1
                if solver.status == "failed" or not np.isfinite(solver.y).all() or done.steps > MOST_STEPS:
                    done.reason = f"stopped at {show(t, 's', 6)}: {said or 'no longer finite, or too many steps'}"
                    return done
                last, now, reached = float(solver.t_old), solver.y.tolist(), float(solver.t)
                smooth = None
                ended = _ended(regime, now, reached)
                if ended is not None:
                    smooth = solver.dense_output()
                    reached, ended, crossed = _when(regime, smooth, ended, last, reached)
                    now = smooth(reached).tolist()
                    stretch.ended = ended
                    if kinks and crossed:
                        stretch.rate = _falling(regime, ended, reached, now, float(solver.t) - last)
                if kinks:
                    before, signs = signs, marks_of(regime, reached, now)
                    parts = divided(regime, solver.dense_output(), last, reached, before, signs)
                    stretch.times += [end for end, _ in parts]
                    stretch.flows += [flows for _, flows in parts]
                while next_at < len(asked) and asked[next_at] <= reached + 1e-12 * until:
                    smooth = smooth or solver.dense_output()
                    keep(asked[next_at], now if asked[next_at] >= reached else smooth(asked[next_at]).tolist())
                    next_at += 1
                t, y = reached, now
            if ended is not None:
                mode, y, told = after(regime, y, ended, regime.rates(t, y))
                regime = attrs.evolve(regime, mode=mode)
                done.events.append((t, told))
                changes = [one for one in changes if t - one < SOON * until] + [t]
                if len(changes) > CHATTER:
                    done.reason = f"stopped at {show(t, 's', 6)}: it chatters between two ways to move ({told})"
                    return done
        watch(next_at, len(asked))
    return done


def _scales(plant: Plant) -> np.ndarray:
    """The size of each number of the state, below which errors do not matter."""
    place = 0.1 if plant.rig.turns else 0.01
    muscle = [1e5, 100.0, 0.01, 10.0, 1e-5, 1e-5, 1.0, 1.0, 1.0]
    return np.array([place, 10.0 * place, 1.0, 1.0] + muscle * plant.n + [0.01] * len(plant.rubs))


def _ended(regime: Regime, y: list[float], t: float) -> Ended | None:
    """What has ended the mode at a time, if anything has."""
    found = margins(regime, t, y) if _changes(regime.plant) else {}
    return next((one for one, margin in found.items() if margin < 0.0), None)


def _changes(plant: Plant) -> bool:
    """Whether a rig has anything that may end a mode."""
    return plant.slackens or plant.friction > 0.0 or plant.stops != (None, None)


def _when(regime: Regime, smooth: Any, ended: Ended, last: float, reached: float) -> tuple[float, Ended, bool]:
    """When a mode ended within a step, and by what: the first of those that ended in it; and whether within it."""
    from scipy.optimize import brentq

    def left(ended: Ended, t: float) -> float:
        margin = margins(regime, t, smooth(t).tolist()).get(ended, math.inf)
        return margin if math.isfinite(margin) else 1.0

    times, crossed = {}, set()
    over = [one for one, margin in margins(regime, reached, smooth(reached).tolist()).items() if margin < 0.0]
    for one in over or [ended]:
        if left(one, reached) >= 0.0:
            times[one] = reached
        elif left(one, last) < 0.0:
            times[one] = last
        else:
            times[one] = float(brentq(lambda t, one=one: left(one, t), last, reached, xtol=1e-13, rtol=1e-14))
            crossed.add(one)
    first = min(times, key=lambda one: times[one])
    return times[first], first, first in crossed


def _falling(regime: Regime, ended: Ended, t: float, y: list[float], step: float) -> float:
    """The rate of a margin along the motion, by a central difference."""
    small, slopes = NEAR * step, regime.rates(t, y).state

    def at(dt: float) -> float:
        there = [one + dt * slope for one, slope in zip(y, slopes, strict=True)]
        return float(margin(regime.plant, ended, regime.mode, there, regime.rates(t + dt, there)))

    return (at(small) - at(-small)) / (2.0 * small)


def _woken(regime: Regime, t: float, y: list[float], done: Driven) -> tuple[Regime, list[float]]:
    """After a jump of a command or a load, friction or a stop may hold no longer."""
    if regime.mode.moves == "free" or regime.plant.rig.fixed:
        return regime, y
    found = regime.rates(t, y)
    for ended, left in margins(regime, t, y).items():
        if left < 0.0 and ended[0] in ("slip", "leave"):
            done.stretches.append(Stretch(regime.mode, [t, t], ended=ended))
            mode, y, told = after(regime, y, ended, found)
            regime = attrs.evolve(regime, mode=mode)
            done.events.append((t, told))
    return regime, y


def _measured(regime: Regime, t: float, y: list[float]) -> Mapping[str, float]:
    """What a controller sees."""
    found: dict[str, float] = {}
    for k, seen in enumerate(regime.rates(t, y).muscles):
        before = "antagonist_" if k else ""
        for name in ("length", "speed", "force", "pressure"):
            found[before + name] = getattr(seen, name)
    if regime.plant.rig.turns:
        found |= {"angle": y[0], "angular_speed": y[1]}
    return found
