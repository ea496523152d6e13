"""The state in which a rig begins: as given, or the equilibrium at the pressure of the start."""

from __future__ import annotations

from typing import Any, NamedTuple

import attrs

from mckibben.motion.mapped import ends_of
from mckibben.motion.modes import begun
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER, Mode, Regime
from mckibben.spec.errors import SpecError
from mckibben.units import show

__all__ = ["Begun", "at_rest", "state_of"]

LOOKED_AT = 33
"""Places between which an equilibrium is looked for."""


class Begun(NamedTuple):
    """A rig at the start: the springs of some are at rest where it begins."""

    plant: Plant
    state: list[float]
    mode: Mode


def state_of(plant: Plant, x: Any) -> list[Any]:
    """The state at rest at a place, without slack, at the pressures of the start."""
    rig = plant.rig
    y = [x, 0.0, 0.0, 0.0] + [0.0] * (PER * plant.n + len(plant.rubs))
    for k, P in enumerate(rig.pressures):
        y[FIRST + PER * k : FIRST + PER * k + 3] = [
            P + rig.atmosphere,
            rig.temperature,
            plant.offsets[k] + plant.ratios[k] * x,
        ]
    return y


def at_rest(plant: Plant) -> Begun:
    """The start. SpecError where it is outside of the map, or where there is no equilibrium."""
    rig = plant.rig
    load = rig.load
    given = load.length if rig.fixed else load.start
    low, high = _room(plant)
    name = "fixed.length" if rig.fixed else f"{load.kind}.start"
    unit = "rad" if rig.turns else "m"
    for k, P in enumerate(rig.pressures):
        first, last = plant.charts[k].pressures
        if not first - 1e-6 * (last - first) <= P <= last * (1.0 + 1e-9):
            said = f"is outside of the map, {show(first, 'Pa', 4)} to {show(last, 'Pa', 4)}"
            raise SpecError("rig.pressure", show(P, "Pa"), said, "give a map that reaches it")
    if given is not None:
        if not low <= given <= high:
            said = f"is outside of the map or of the end stops: {show(low, unit, 5)} to {show(high, unit, 5)} will do"
            raise SpecError(name, show(given, unit), said, "mk.limits tells what the muscle can do")
        x = float(given)
    else:
        x = _equilibrium(plant, low, high, name, unit)
    if rig.mass and not rig.turns and load.spring_at is None:
        plant = attrs.evolve(plant, rest=x)
    y, slack = _slackened(plant, state_of(plant, x))
    return Begun(plant, y, begun(plant, y, slack))


def _room(plant: Plant) -> tuple[float, float]:
    """The places that map and stops allow at the start."""
    low, high = float("-inf"), float("inf")
    for k, P in enumerate(plant.rig.pressures):
        ends = ends_of(plant.charts[k], P)
        reach = sorted((end - plant.offsets[k]) / plant.ratios[k] for end in ends)
        low, high = max(low, reach[0]), min(high, reach[1])
    if plant.stops[0] is not None:
        low = max(low, plant.stops[0])
    if plant.stops[1] is not None:
        high = min(high, plant.stops[1])
    if low > high:
        raise SpecError(f"{plant.rig.load.kind}", allowed="leaves no place at which all muscles are in their maps",
                        advice="change the lengths at angle 0, or the end stops")  # fmt: skip
    return low, high


def _equilibrium(plant: Plant, low: float, high: float, name: str, unit: str) -> float:
    """The place at which nothing pushes, or the stop against which it does."""
    from scipy.optimize import brentq

    wanders = not plant.rig.turns and plant.rig.load.spring_at is None

    def push(x: float) -> float:
        there = attrs.evolve(plant, rest=x) if wanders else plant  # a spring without a place of its own has no force
        found = Regime.closed(there, Mode("stuck")).rates(0.0, state_of(plant, x))
        if not plant.slackens:
            return found.push
        return found.push - sum(-plant.ratios[k] * min(seen.force, 0.0) for k, seen in enumerate(found.muscles))

    places = [low + (high - low) * k / (LOOKED_AT - 1) for k in range(LOOKED_AT)]
    seen = [push(x) for x in places]
    for k in range(LOOKED_AT - 1):
        if seen[k] >= 0.0 > seen[k + 1]:
            return float(brentq(push, places[k], places[k + 1], xtol=1e-14, rtol=1e-14))
    if seen[0] < 0.0 and plant.stops[0] == low:
        return low
    if seen[-1] >= 0.0 and plant.stops[1] == high:
        return high
    if seen[-1] == 0.0:
        return high
    way = "longer than the map goes" if (seen[-1] > 0.0) == (not plant.rig.turns) else "out of the map"
    between = f"{show(low, unit, 5)} and {show(high, unit, 5)}"
    said = f"is not given, and no equilibrium is between {between}: the load draws it {way}"
    raise SpecError(name, allowed=said, advice="give a start, another load, a pressure at the start, or an end stop")


def _slackened(plant: Plant, y: list[float]) -> tuple[list[float], tuple[bool, ...]]:
    """Muscles that would push at the start are slack where their cables allow it: the state, and which are."""
    slack = [False, False]
    if not plant.slackens:
        return y, tuple(slack)
    from scipy.optimize import brentq

    y = list(y)
    for k, one in enumerate(Regime.closed(plant, Mode("stuck")).rates(0.0, y).muscles):
        if one.force >= 0.0:
            continue
        P = plant.rig.pressures[k]
        ends, at = ends_of(plant.charts[k], P), plant.ats[k]
        if at(ends.high, P).force > 0.0 > at(one.length, P).force:
            y[FIRST + PER * k + 2] = float(
                brentq(lambda h, at=at, P=P: at(h, P).force, one.length, ends.high, xtol=1e-14)
            )
            slack[k] = True
    return y, tuple(slack)
