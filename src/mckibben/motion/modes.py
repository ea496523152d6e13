"""What ends a mode of motion, and what follows: end stops, friction that holds, cables that go slack."""

from __future__ import annotations

import math
from collections.abc import Sequence

import attrs

from mckibben.motion.plant import FIRST, PER, Mode, Plant, Rates

__all__ = ["Ended", "after", "begun", "margins"]

SPEED = 1e-9
"""Speed [m/s or rad/s] below which friction may hold."""
PLAY = 1e-9
"""Length [m] by which a cable must be too short before it pulls again."""
PUSH = 1e-7
"""Force [N] that a cable must be asked to push before it is slack."""

Ended = tuple[str, int]
"""What ended a mode, and of which muscle."""


def margins(plant: Plant, t: float, y: Sequence[float]) -> dict[Ended, float]:
    """How far the present mode is from its end, by each way to end it: below 0 it has ended."""
    mode, (low, high) = plant.mode, plant.stops
    found: dict[Ended, float] = {}
    rates = plant.rates(t, y) if plant.slackens or mode.moves != "free" else None  # seldom needed, and dear
    if mode.moves == "free":
        if low is not None:
            found["low", 0] = y[0] - low if y[1] < 0.0 else math.inf
        if high is not None:
            found["high", 0] = high - y[0] if y[1] > 0.0 else math.inf
        if plant.friction and not plant.rig.fixed:
            found["turn", 0] = mode.sliding * y[1] + SPEED
    elif rates is not None and mode.moves == "stuck":
        found["slip", 0] = plant.friction - abs(rates.push)
    elif rates is not None:
        away = rates.push if mode.moves == "low" else -rates.push
        found["leave", 0] = plant.friction - away
    if rates is not None and plant.slackens:
        for k, seen in enumerate(rates.muscles):
            if mode.slack[k]:
                distance = plant.offsets[k] + plant.ratios[k] * y[0]
                found["tight", k] = y[FIRST + PER * k + 2] - distance + PLAY
            else:
                found["slack", k] = seen.force + PUSH
    return found


def after(plant: Plant, y: list[float], ended: Ended, rates: Rates) -> tuple[Mode, str]:
    """The mode that follows, and what happened in words. The state is put on the stop, or to rest, in place."""
    mode, (what, k) = plant.mode, ended
    if what in ("low", "high"):
        y[2] += 0.5 * plant.mass * y[1] ** 2
        stop = plant.stops[0] if what == "low" else plant.stops[1]
        assert stop is not None
        y[0], y[1] = stop, 0.0
        return attrs.evolve(mode, moves=what, sliding=0.0), f"reached the {what} end stop"
    if what == "turn":
        y[2] += 0.5 * plant.mass * y[1] ** 2
        y[1] = 0.0
        if abs(rates.push) <= plant.friction:
            return attrs.evolve(mode, moves="stuck", sliding=0.0), "came to rest: friction holds"
        return attrs.evolve(mode, sliding=math.copysign(1.0, rates.push)), "turned round"
    if what in ("slip", "leave"):
        said = "friction gave way" if what == "slip" else f"left the {mode.moves} end stop"
        return attrs.evolve(mode, moves="free", sliding=math.copysign(1.0, rates.push)), said
    name = "the muscle" if plant.n == 1 else ("the first muscle", "the antagonist")[k]
    slack = tuple(what == "slack" if j == k else one for j, one in enumerate(mode.slack))
    if what == "slack":
        y[FIRST + PER * k + 2] = plant.offsets[k] + plant.ratios[k] * y[0]
    return attrs.evolve(mode, slack=slack), f"{name} went slack" if what == "slack" else f"{name} pulls again"


def begun(plant: Plant, t: float, y: list[float]) -> Mode:
    """The mode in which a rig begins, at rest."""
    low, high = plant.stops
    plant.mode = Mode("stuck", 0.0, plant.mode.slack)
    push = plant.rates(t, y).push
    if low is not None and y[0] <= low and push <= plant.friction:
        return attrs.evolve(plant.mode, moves="low")
    if high is not None and y[0] >= high and push >= -plant.friction:
        return attrs.evolve(plant.mode, moves="high")
    if plant.friction and abs(push) <= plant.friction:
        return plant.mode
    return attrs.evolve(plant.mode, moves="free", sliding=math.copysign(1.0, push))
