"""The start of a motion as a function of the numbers of its rig, from one that is known."""

from __future__ import annotations

from typing import Any

import attrs
import jax
import jax.numpy as jnp

from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER
from mckibben.motion.start import state_of
from mckibben.motiongradients.moments import outer_of, value
from mckibben.motiongradients.rows import Begin
from mckibben.motiongradients.traced import TracedMode, TracedRegime

__all__ = ["started"]

NEWTON = 2
"""Steps of Newton's method from what was found: two are exact in first and second derivatives."""


def started(plant: Plant, begin: Begin) -> tuple[Plant, Any]:
    """The rig and its state at the start, as `at_rest` has them."""
    rig, load = plant.rig, plant.rig.load
    given = load.length if rig.fixed else load.start
    wanders = not rig.fixed and not rig.turns and load.spring_at is None
    x = _equilibrium(plant, begin, wanders) if given is None else jnp.asarray(given, float)
    if wanders:
        plant = attrs.evolve(plant, rest=x)  # type: ignore[arg-type]  # traced
    y = [jnp.asarray(one, float) for one in state_of(plant, x)]
    for k in range(plant.n):
        if plant.slackens:
            at = FIRST + PER * k + 2
            y[at] = jnp.where(begin.slack[k], _free(plant, k, begin.own[k]), y[at])
    return plant, jnp.stack(y)


def _equilibrium(plant: Plant, begin: Begin, wanders: bool) -> Any:
    """The place at which nothing pushes, or the stop against which something does."""

    signal = outer_of(plant.rig)
    outer = None if signal is None else lambda t: value(signal, begin.outer, t)

    def push(x: Any) -> Any:
        there = attrs.evolve(plant, rest=x) if wanders else plant
        mode: Any = TracedMode(False, 0.0, 0.0, [False] * plant.n, [0] * plant.n)
        closed: Any = [lambda t: jnp.asarray(0.0)] * plant.n
        found = TracedRegime(plant=attrs.evolve(there, slackens=False), mode=mode, commands=closed, outer=outer)
        rates = found.rates(0.0, state_of(there, x))
        loose = [jnp.where(begin.slack[k], seen.force, 0.0) for k, seen in enumerate(rates.muscles)]
        return rates.push + sum(plant.ratios[k] * one for k, one in enumerate(loose))

    x = begin.x
    for _ in range(NEWTON):
        left, slope = jax.value_and_grad(push)(x)
        x = x - left / slope
    for number, stop in enumerate(plant.stops, 1):
        if stop is not None:
            x = jnp.where(begin.at == number, stop, x)
    return x


def _free(plant: Plant, k: int, h: Any) -> Any:
    """The length at which a muscle has no force at the pressure of the start."""
    for _ in range(NEWTON):
        found = plant.ats[k](h, plant.rig.pressures[k])
        h = h - found.force / found.stiffness
    return h
