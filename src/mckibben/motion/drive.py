"""Through time: SciPy's solvers from jump to jump, ended early where a mode ends; what was reached is kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import attrs
import numpy as np

from mckibben.motion.commands import Commands
from mckibben.motion.modes import Ended, after, margins
from mckibben.motion.plant import Plant
from mckibben.motion.regime import Rates, Regime
from mckibben.motion.start import Begun
from mckibben.units import show

__all__ = ["METHODS", "Driven", "drive"]

METHODS = ("LSODA", "Radau", "BDF", "RK45", "DOP853")
"""SciPy's solvers that may be asked for."""
CHATTER, SOON = 200, 1e-7
"""As many changes of mode within as short a time [of the whole] end a simulation."""
MOST_STEPS = 2_000_000


@attrs.define
class Driven:
    """What a simulation reached: times, states, what was seen, and what happened when."""

    times: list[float] = attrs.Factory(list)
    states: list[list[float]] = attrs.Factory(list)
    seen: list[Rates] = attrs.Factory(list)
    modes: list[str] = attrs.Factory(list)
    events: list[tuple[float, str]] = attrs.Factory(list)
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
) -> Driven:
    """A rig from its start at the first of the times to the last of them, looked at at each."""
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
                    reached, ended = _when(regime, smooth, ended, last, reached)
                    now = smooth(reached).tolist()
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


def _when(regime: Regime, smooth: Any, ended: Ended, last: float, reached: float) -> tuple[float, Ended]:
    """When a mode ended within a step, and by what: the first of those that ended in it."""
    from scipy.optimize import brentq

    def left(ended: Ended, t: float) -> float:
        margin = margins(regime, t, smooth(t).tolist()).get(ended, math.inf)
        return margin if math.isfinite(margin) else 1.0

    times = {}
    over = [one for one, margin in margins(regime, reached, smooth(reached).tolist()).items() if margin < 0.0]
    for one in over or [ended]:
        if left(one, reached) >= 0.0:
            times[one] = reached
        elif left(one, last) < 0.0:
            times[one] = last
        else:
            times[one] = float(brentq(lambda t, one=one: left(one, t), last, reached, xtol=1e-13, rtol=1e-14))
    first = min(times, key=lambda one: times[one])
    return times[first], first


def _woken(regime: Regime, t: float, y: list[float], done: Driven) -> tuple[Regime, list[float]]:
    """After a jump of a command or a load, friction or a stop may hold no longer."""
    if regime.mode.moves == "free" or regime.plant.rig.fixed:
        return regime, y
    found = regime.rates(t, y)
    for ended, margin in margins(regime, t, y).items():
        if margin < 0.0 and ended[0] in ("slip", "leave"):
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
