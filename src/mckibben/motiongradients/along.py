"""Along the rows of a motion once more, as a function of the numbers of its rig that JAX can differentiate.

The steps are those of Dormand and Prince, as SciPy's RK45 has them. They stay what parts of their stretches they were;
the stretches themselves move with the numbers: a jump with its time, the end of a mode with the state (page of motion).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from scipy.integrate import RK45

from mckibben.motion.modes import Ended, landed, margin
from mckibben.motion.plant import Plant
from mckibben.motion.regime import Rates, Seen
from mckibben.motiongradients.moments import Source, commanding, moment, outer_of, value
from mckibben.motiongradients.rows import Rows
from mckibben.motiongradients.sampled import PIDMemory, commanded, first_memory, sampled
from mckibben.motiongradients.traced import TracedMode, TracedRegime

__all__ = ["Pattern", "RowEnd", "gone_along"]

A, B, C = (np.array(one) for one in (RK45.A, RK45.B, RK45.C))
STAGES = np.vstack([np.pad(A, ((0, 0), (0, 2))), np.append(B, 0.0)]), np.append(C, 1.0)
"""Weights and times of the stages; the last one is the end of the step."""


class Pattern(NamedTuple):
    """What is the same for all motions of one kind of rig."""

    sources: tuple[Source, ...]
    kinds: tuple[Ended, ...]
    kept: int  #: commands that are on their way through a valve's dead time at most


class RowEnd(NamedTuple):
    """What is there at the end of a row, before what happens there."""

    y: Any
    push: Any
    muscles: list[Seen]


def gone_along(way: Pattern, plant: Plant, y: Any, rows: Rows) -> RowEnd:
    """All rows, from the state at the start; arrays over rows."""
    rig, marks = plant.rig, _marks(way, plant, rows)

    @jax.checkpoint  # backwards, a row is gone through again: less to keep and to move
    def step(carry: tuple[Any, RowEnd, PIDMemory], row: tuple[Rows, Any]) -> tuple[Any, RowEnd]:
        (begin, at, memory), (now, mark) = carry, row
        regime = _regime(way, plant, now, commanded(way.sources, rig, memory, now.piece))
        mark = jnp.where(now.seeks > 0, begin - _margin(way, regime, now, at) / now.rate, mark)
        span = mark - begin
        at = _step(regime, begin + now.a * span, begin + now.b * span, at)
        memory = sampled(way.sources, rig, memory, now, at.muscles[0], at.y)
        landed = _landed(way, plant, now, at)
        return (jnp.where(now.b == 1.0, mark, begin), landed, memory), at

    first = RowEnd(y, jnp.zeros(()), [_arrays(Seen(*[0.0] * len(Seen._fields)))] * plant.n)
    return jax.lax.scan(step, (jnp.zeros(()), first, first_memory(plant.n, way.kept)), (rows, marks))[1]


def _marks(way: Pattern, plant: Plant, rows: Rows) -> Any:
    """The next mark of each row, as far as the state has no part in it."""
    times = jnp.asarray(rows.time)
    for s, source in enumerate(way.sources):
        times = jnp.where(rows.source == s, moment(plant.rig, source, rows.number, rows.inner), times)
    return times


def _regime(way: Pattern, plant: Plant, row: Rows, commands: list[Any]) -> TracedRegime:
    """How the rig moves along a row: `commands` are those that controllers gave, None for signals."""
    rig = plant.rig

    def place(what: str, k: int) -> int | None:
        return next((s for s, one in enumerate(way.sources) if one == (what, k)), None)

    def follows(k: int) -> Callable[[Any], Any]:
        if commands[k] is not None:
            return lambda t: commands[k]
        signal, sign = commanding(rig, k)
        if signal is None:
            return lambda t: jnp.asarray(0.0)
        at, opens, delay = place("signal", k), place("delay", k), rig.valves[k].delay
        begun = 1.0 if opens is None else jnp.where(row.piece[opens] > 0, 1.0, 0.0)
        return lambda t: begun * sign * value(signal, row.piece[at], t - delay)

    signal, at = outer_of(rig), place("signal", -1)
    outer = None if signal is None else lambda t: value(signal, row.piece[at], t)
    mode: Any = TracedMode(row.moves, row.side, row.sliding, row.slack, row.flows)
    return TracedRegime(plant=plant, mode=mode, commands=[follows(k) for k in range(plant.n)], outer=outer)


def _step(regime: TracedRegime, begin: Any, end: Any, at: RowEnd) -> RowEnd:
    """One step of order 5, and what is seen at its end."""
    h, y = end - begin, at.y

    def stage(carry: tuple[Any, RowEnd], one: tuple[Any, Any, Any]) -> tuple[Any, None]:
        (slopes, _), (i, weights, c) = carry, one
        there = y + h * (weights @ slopes)
        rates = regime.rates(begin + c * h, list(there))
        seen = RowEnd(there, rates.push, [_arrays(one) for one in rates.muscles])
        return (slopes.at[i].set(_stack(rates.state)), seen), None

    count = len(STAGES[1])
    return jax.lax.scan(stage, (jnp.zeros((count, *y.shape)), at), (np.arange(count), *STAGES))[0][1]


def _arrays(seen: Seen) -> Seen:
    flags = ("inside", "slack")
    made: Any = [jnp.asarray(one, bool if name in flags else float) for name, one in seen._asdict().items()]
    return Seen(*made)


def _stack(state: list[Any]) -> Any:
    return jnp.stack([jnp.asarray(one, float) for one in state])


def _margin(way: Pattern, regime: TracedRegime, row: Rows, at: RowEnd) -> Any:
    """How far from its end the mode is that a row leads to the end of."""
    mode: Any = regime.mode

    def of(ended: Ended) -> Any:
        if ended[0] == "leave":  # at which stop it is, is a number here
            return regime.plant.friction - row.side * at.push
        return margin(regime.plant, ended, mode, at.y, Rates([], at.muscles, at.push))

    return jnp.stack([of(one) for one in way.kinds])[row.seeks - 1] if way.kinds else 0.0


def _landed(way: Pattern, plant: Plant, row: Rows, at: RowEnd) -> RowEnd:
    """The state after what happens at the end of a row."""
    states = [at.y, *(_stack(landed(plant, list(at.y), one)) for one in way.kinds)]
    return at._replace(y=jnp.stack(states)[row.ends])
