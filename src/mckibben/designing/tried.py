"""`Tried`: the designs that a search has tried, and what came of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import attrs
import numpy as np

from mckibben.designing.places import Place
from mckibben.designing.reading import lined_of, places_of, value_of
from mckibben.designing.space import Space
from mckibben.designing.states import states_at
from mckibben.spec.wishes import Demand, Goal, Measure

__all__ = ["LOST", "MET", "Limit", "Task", "Tried", "Worth", "limits_of"]

LOST = 10.0
"""Violation of a limit by a design whose measure is not known, over the limit; no other counts for more."""
MET = 1e-5
"""Violation up to which a limit counts as met, over the limit: rounding, and the discretisation."""


@attrs.frozen
class Limit:
    """One side of a demand: sign (value - at) <= 0 where it is met."""

    demand: Demand
    at: float
    sign: float  #: 1 for at most, -1 for at least

    @property
    def scale(self) -> float:
        """What a violation is divided by."""
        return abs(self.at) or 1.0

    def over(self, value: np.ndarray) -> np.ndarray:
        """Violation of values over the limit; negative where there is room."""
        return np.where(np.isnan(value), LOST, np.clip(self.sign * (value - self.at) / self.scale, -LOST, LOST))

    @property
    def said(self) -> str:
        """The limit in words."""
        side = "at most" if self.sign > 0.0 else "at least"
        return f"{self.demand.measure.said} {side} {self.demand.measure.text(self.at)}"


def limits_of(demands: Sequence[Demand]) -> tuple[Limit, ...]:
    """The limits of all demands, one by one."""
    sides = [(demand, at, sign) for demand in demands for at, sign in ((demand.least, -1.0), (demand.most, 1.0))]
    return tuple(Limit(demand, at, sign) for demand, at, sign in sides if at is not None)


@attrs.frozen(eq=False)
class Task:
    """What is free, what is wanted, and within which limits."""

    space: Space
    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...]

    @property
    def measures(self) -> tuple[Measure, ...]:
        """All measures that are needed, each once."""
        every = [goal.measure for goal in self.goals] + [limit.demand.measure for limit in self.limits]
        return tuple(dict.fromkeys(every))

    @property
    def places(self) -> tuple[Place, ...]:
        """All states that are needed."""
        return tuple(dict.fromkeys(place for measure in self.measures for place in places_of(measure)))


@attrs.frozen(eq=False)
class Worth:
    """What some designs are worth: d designs, NaN for what is not known."""

    goals: np.ndarray  #: (d, goals) values, SI
    limited: np.ndarray  #: (d, limits) values of what is limited, SI
    costs: np.ndarray  #: (d, goals) what is to be small
    over: np.ndarray  #: (d, limits + 1) violations; the last says whether the goals are known

    @property
    def violation(self) -> np.ndarray:
        """Sum of the violations (d)."""
        return np.asarray(np.maximum(self.over, 0.0).sum(axis=1))

    @property
    def met(self) -> np.ndarray:
        """Which designs keep every limit."""
        return np.asarray((self.over <= MET).all(axis=1))


def worth_of(task: Task, x: np.ndarray, tolerance: float) -> Worth:
    """What designs at places (d, axes) are worth, through the batches."""
    count = len(x)
    lined = lined_of(task.measures)
    values = {measure: np.full(count, np.nan) for measure in task.measures}
    for muscle, numbers, index in task.space.kinds(x):
        seen = states_at(muscle, numbers, len(index), task.places, tolerance, lined)
        if seen is not None:
            for measure in task.measures:
                values[measure][index] = value_of(measure, seen)
    goals = np.stack([values[goal.measure] for goal in task.goals], axis=1)
    costs = goals * np.array([goal.sign for goal in task.goals])
    none = np.zeros((count, 0))
    limited = [values[limit.demand.measure] for limit in task.limits]
    over = [limit.over(value) for limit, value in zip(task.limits, limited, strict=True)]
    known = np.where(np.isfinite(goals).all(axis=1), -1.0, LOST)
    return Worth(goals, np.stack(limited, axis=1) if limited else none, costs, np.stack([*over, known], axis=1))


class Tried:
    """Everything that was tried at one tolerance; what was tried before is not tried again."""

    def __init__(self, task: Task, tolerance: float, watch: Callable[[int], None]) -> None:
        self.task, self.tolerance, self._watch = task, tolerance, watch
        self.x = np.zeros((0, len(task.space.axes)))
        goals, limits = len(task.goals), len(task.limits)
        self.worth = Worth(*(np.zeros((0, size)) for size in (goals, limits, goals, limits + 1)))
        self._at: dict[bytes, int] = {}

    def __len__(self) -> int:
        return len(self.x)

    def __call__(self, x: np.ndarray, /) -> Worth:
        """What designs at places (d, axes) are worth."""
        x = self.task.space.settled(np.asarray(x, float)) + 0.0
        keys = [row.tobytes() for row in x]
        new = list({key: k for k, key in enumerate(keys) if key not in self._at}.values())
        if new:
            worth = worth_of(self.task, x[new], self.tolerance)
            self._at |= {keys[k]: len(self.x) + place for place, k in enumerate(new)}
            self.x = np.concatenate([self.x, x[new]])
            self.worth = Worth(*(np.concatenate([getattr(self.worth, name), getattr(worth, name)])
                                 for name in ("goals", "limited", "costs", "over")))  # fmt: skip
            self._watch(len(new))
        return self.some(np.array([self._at[key] for key in keys], int))

    def some(self, which: np.ndarray) -> Worth:
        """What some of those tried are worth."""
        worth = self.worth
        return Worth(worth.goals[which], worth.limited[which], worth.costs[which], worth.over[which])

    def ranked(self) -> np.ndarray:
        """All of them, best first: those that keep the limits by their first goal, the others by their violation."""
        met, violation = self.worth.met, self.worth.violation
        cost = np.nan_to_num(self.worth.costs[:, 0], nan=np.inf)
        return np.lexsort((np.where(met, cost, violation), ~met))
