"""What ends a mode of motion, and what follows: end stops, friction that holds, cables that go slack."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import attrs

from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER, Mode, Rates, Regime

__all__ = ["After", "Ended", "after", "begun", "landed", "margin", "margins"]

SPEED = 1e-9
"""Speed [m/s or rad/s] below which friction may hold."""
PLAY = 1e-9
"""Length [m] by which a cable must be too short before it pulls again."""
PUSH = 1e-7
"""Force [N] that a cable must be asked to push before it is slack."""

Ended = tuple[str, int]
"""What ended a mode, and of which muscle."""


class After(NamedTuple):
    """What follows a mode that has ended."""

    mode: Mode
    state: list[float]
    told: str


def margins(regime: Regime, t: float, y: Sequence[float]) -> dict[Ended, float]:
    """How far the mode is from its end, by each way to end it: below 0 it has ended."""
    plant, mode = regime.plant, regime.mode
    (low, high), found = plant.stops, dict[Ended, float]()
    rates = regime.rates(t, y) if plant.slackens or mode.moves != "free" else None  # seldom needed, and dear
    if mode.moves == "free":
        if low is not None:
            found["low", 0] = margin(plant, ("low", 0), mode, y, rates) if y[1] < 0.0 else math.inf
        if high is not None:
            found["high", 0] = margin(plant, ("high", 0), mode, y, rates) if y[1] > 0.0 else math.inf
        if plant.friction and not plant.rig.fixed:
            found["turn", 0] = margin(plant, ("turn", 0), mode, y, rates)
    else:
        one = ("slip", 0) if mode.moves == "stuck" else ("leave", 0)
        found[one] = margin(plant, one, mode, y, rates)
    if plant.slackens:
        for k in range(plant.n):
            one = ("tight", k) if mode.slack[k] else ("slack", k)
            found[one] = margin(plant, one, mode, y, rates)
    return found


def margin(plant: Plant, ended: Ended, mode: Any, y: Any, rates: Rates | None) -> Any:
    """How far a mode is from one way to end it, on floats or JAX arrays; the rates serve what depends on forces."""
    what, k = ended
    if what in ("low", "high"):
        stop = plant.stops[0] if what == "low" else plant.stops[1]
        return y[0] - stop if what == "low" else stop - y[0]
    if what == "turn":
        return mode.sliding * y[1] + SPEED
    if what == "tight":
        return y[FIRST + PER * k + 2] - (plant.offsets[k] + plant.ratios[k] * y[0]) + PLAY
    assert rates is not None
    if what == "slip":
        return plant.friction - abs(rates.push)
    if what == "leave":
        return plant.friction - (rates.push if mode.moves == "low" else -rates.push)
    return rates.muscles[k].force + PUSH


def landed(plant: Plant, y: list[Any], ended: Ended) -> list[Any]:
    """The state after what has ended a mode: on the stop, at rest, or with a cable that lies straight."""
    (what, k), y = ended, list(y)
    if what in ("low", "high", "turn"):
        y[2] = y[2] + 0.5 * plant.mass * y[1] ** 2
        y[1] = 0.0
    if what in ("low", "high"):
        stop = plant.stops[0] if what == "low" else plant.stops[1]
        assert stop is not None
        y[0] = stop
    if what == "slack":
        y[FIRST + PER * k + 2] = plant.offsets[k] + plant.ratios[k] * y[0]
    return y


def after(regime: Regime, y: Sequence[float], ended: Ended, rates: Rates) -> After:
    """The mode that follows, the state in it, put on the stop or to rest, and what happened in words."""
    plant, mode, (what, k), y = regime.plant, regime.mode, ended, landed(regime.plant, list(y), ended)
    if what in ("low", "high"):
        return After(attrs.evolve(mode, moves=what, sliding=0.0), y, f"reached the {what} end stop")
    if what == "turn" and abs(rates.push) <= plant.friction:
        return After(attrs.evolve(mode, moves="stuck", sliding=0.0), y, "came to rest: friction holds")
    sliding = math.copysign(1.0, rates.push)
    if what == "turn":
        return After(attrs.evolve(mode, sliding=sliding), y, "turned round")
    if what in ("slip", "leave"):
        said = "friction gave way" if what == "slip" else f"left the {mode.moves} end stop"
        return After(attrs.evolve(mode, moves="free", sliding=sliding), y, said)
    name = "the muscle" if plant.n == 1 else ("the first muscle", "the antagonist")[k]
    slack = tuple(what == "slack" if j == k else one for j, one in enumerate(mode.slack))
    return After(attrs.evolve(mode, slack=slack), y, f"{name} went slack" if what == "slack" else f"{name} pulls again")


def begun(plant: Plant, y: Sequence[float], slack: tuple[bool, ...]) -> Mode:
    """The mode in which a rig begins, at rest."""
    (low, high), stuck = plant.stops, Mode("stuck", 0.0, slack)
    push = Regime.closed(plant, stuck).rates(0.0, y).push
    if low is not None and y[0] <= low and push <= plant.friction:
        return attrs.evolve(stuck, moves="low")
    if high is not None and y[0] >= high and push >= -plant.friction:
        return attrs.evolve(stuck, moves="high")
    if plant.friction and abs(push) <= plant.friction:
        return stuck
    return attrs.evolve(stuck, moves="free", sliding=math.copysign(1.0, push))
