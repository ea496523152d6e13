"""What limits a design, and what a little more room would give: Lagrange multipliers in plain words."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from scipy.optimize import nnls

from mckibben.designing.search import slopes_at
from mckibben.designing.tried import Task, Tried
from mckibben.spec.wishes import Goal, Measure, text_of

__all__ = ["Prices", "prices_of"]

ACTIVE = 1e-3
"""Room up to which a limit counts as reached, over the limit."""
AT = 1e-4
"""Distance from a bound, over the range, at which a number counts as being there."""
SETTLED = 0.05
"""Part of the slope of the goal that may be left over where the design is the best one near."""
FLAT = 0.02
"""Slope of the goal over itself, by the whole range of a number, up to which it is level."""
CHANGE = 0.01
"""By which part a limit is changed."""


@attrs.frozen(eq=False)
class Prices:
    """What more room would give: gains in the goal for a hundredth of each limit, NaN where that is not known."""

    limits: np.ndarray  #: (limits) 0 where a limit is not reached
    active: np.ndarray  #: (limits) whether it is reached
    notes: tuple[str, ...]


def prices_of(tried: Tried, x: np.ndarray) -> Prices:
    """Prices at the best design (axes), with options as they are."""
    task = tried.task
    axes = [axis for axis in task.space.axes if axis.smooth]
    seen = slopes_at(tried, x)
    active = np.abs(seen.over[:-1]) < ACTIVE
    unknown = np.where(active, np.nan, 0.0)
    if not axes or not seen.known:
        said = ("limits the design: " + task.limits[k].said for k in np.flatnonzero(active))
        return Prices(unknown, active, tuple(said))
    own = x[task.space.smooth]
    low, high = own < AT, own > 1.0 - AT
    bounds = np.concatenate([-np.eye(len(own))[low], np.eye(len(own))[high]])
    rows = np.concatenate([seen.of_over[:-1][active], bounds])
    size = float(np.linalg.norm(seen.of_cost))
    if size < 1e-9 * max(abs(seen.cost), 1e-12):
        said = ("at its limit: " + task.limits[k].said for k in np.flatnonzero(active))
        return Prices(np.zeros(len(active)), active, tuple(said))
    if not len(rows) and size < FLAT * abs(seen.cost):
        return Prices(unknown, active, ("nothing holds the design: the goal is best within the ranges",))
    multipliers, left = nnls(rows.T, -seen.of_cost) if len(rows) else (np.zeros(0), size)
    notes: list[str] = []
    if left > SETTLED * size:
        notes.append("the best design is no smooth optimum of its limits (options, or an edge of what can be computed "
                     "or of a largest value, hold it): what more room would give is not told")  # fmt: skip
        notes += ["at its limit: " + task.limits[k].said for k in np.flatnonzero(active)]
        return Prices(unknown, active, tuple(notes))
    gains = unknown.copy()
    gains[active] = CHANGE * multipliers[: int(active.sum())]
    goal = task.goals[0]
    notes += [_of_limit(task, k, float(gains[k])) for k in np.flatnonzero(active).tolist()]
    at_bound = [k for k in np.flatnonzero(low).tolist()] + [k for k in np.flatnonzero(high).tolist()]
    for k, price in zip(at_bound, multipliers[int(active.sum()) :].tolist(), strict=True):
        number, upper = axes[k].number, bool(high[k])
        assert number is not None
        bound = number.high if upper else number.low
        gain = price * CHANGE * abs(bound) / abs(number.slope(float(own[k])))
        more = "more" if upper else "less"
        side = f"{number.name} is at its {'upper' if upper else 'lower'} bound, {number.text(bound)}"
        notes.append(f"{side}: 1 % {more} would {_gives(goal, gain)}")
    pressed = _of_pressure(tried, x, gains)
    if pressed is not None:
        notes.append(f"1 % more pressure everywhere would {_gives(goal, pressed)}")
    return Prices(gains, active, tuple(notes))


def _of_limit(task: Task, k: int, gain: float) -> str:
    limit, goal = task.limits[k], task.goals[0]
    amount = limit.demand.measure.text(CHANGE * abs(limit.at)) if limit.at else "0.01"
    more = "more" if limit.sign > 0.0 else "less"
    return f"at its limit: {limit.said}; 1 % {more} ({amount}) would {_gives(goal, gain)}"


def _gives(goal: Goal, gain: float) -> str:
    """What a gain in a goal is, in words."""
    way = "raise" if (goal.sign < 0.0) == (gain >= 0.0) else "lower"
    measure = goal.measure
    return f"{way} the {measure.meaning} by {text_of(abs(gain), measure.unit, measure.display, 3)}"


def _of_pressure(tried: Tried, x: np.ndarray, gains: np.ndarray) -> float | None:
    """Gain in the goal by a hundredth more of every pressure, the design being adapted; None without
    pressures, or where nothing comes of it."""
    task = tried.task
    worths = []
    for share in (1.0 - 0.5 * CHANGE, 1.0 + 0.5 * CHANGE):
        pressed = _pressed(task, share)
        if pressed is None:
            return None
        worths.append(Tried(pressed, tried.tolerance, lambda count: None)(x[None]))
    less, more = worths
    of_cost = float(more.costs[0, 0] - less.costs[0, 0])
    of_over = more.over[0, :-1] - less.over[0, :-1]
    multipliers = np.nan_to_num(gains) / CHANGE
    gain = -(of_cost + float(multipliers @ of_over))
    size = abs(float(more.costs[0, 0])) or 1.0
    return gain if np.isfinite(gain) and abs(gain) > 1e-6 * size else None


def _pressed(task: Task, share: float) -> Task | None:
    """The same with every pressure times a share; None where there is none."""

    def scaled(measure: Measure) -> Any:
        own: Any = measure
        return attrs.evolve(own, pressure=own.pressure * share) if hasattr(own, "pressure") else own

    if not any(hasattr(measure, "pressure") for measure in task.measures):
        return None
    from mckibben.spec.plausible import trusted

    with trusted():
        goals = tuple(attrs.evolve(goal, measure=scaled(goal.measure)) for goal in task.goals)
        limits = tuple(
            attrs.evolve(limit, demand=attrs.evolve(limit.demand, measure=scaled(limit.demand.measure)))
            for limit in task.limits
        )
    return attrs.evolve(task, goals=goals, limits=limits)
