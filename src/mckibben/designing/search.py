"""The search for one goal: quasi-random designs, differential evolution over batches, and a smooth end by SQP."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import attrs
import numpy as np
from scipy.optimize import NonlinearConstraint, differential_evolution, minimize
from scipy.stats import qmc

from mckibben.designing.space import Space
from mckibben.designing.tried import LOST, Task, Tried, Worth

__all__ = ["Judge", "Slopes", "evolve", "neighbours", "scatter", "slopes_at", "smooth_end"]

CROWD = 64
"""Designs of a generation: as many as a batch takes."""
FIRST = 4
"""Times as many are looked at before, and the best go on."""
STEP = 1e-3
"""Half of the difference in x by which slopes are taken."""
ROUNDS = 20
"""Steps of the smooth end at most."""
ALIKE = 0.01
"""Spread of a generation's goals at which it ends: what is left, the smooth end finds sooner."""
STUCK = 8
"""What SLSQP ends with where no direction leads on: rounding is all that is left."""
NEARLY = 2e-3
"""Violation of a limit that is mended on the way to the best."""
BAD = 1e3
"""Cost of a design that is not known, over the size of the goal."""


def scatter(task: Task, count: int, seed: int) -> np.ndarray:
    """Quasi-random places (count, axes), even over every range and list."""
    low, high = task.space.bounds.T
    sampler = qmc.Sobol(len(low), seed=seed)
    points = sampler.random_base2(int(np.ceil(np.log2(max(count, 2)))))[:count]
    smooth = task.space.smooth
    # an option gets as much room as any other, those at the ends too
    return np.where(smooth, low + points * (high - low), np.floor(points * (high - low + 1.0)).clip(0.0, high))


def evolve(tried: Tried, designs: int, seed: int) -> None:
    """Try so many designs, each generation nearer to the best."""
    task = tried.task
    first = scatter(task, min(FIRST * CROWD, max(designs // 2, CROWD)), seed)
    for at in range(0, len(first), 2 * CROWD):  # in parts, so that there is something to keep soon
        tried(first[at : at + 2 * CROWD])
    generations = (designs - len(tried)) // CROWD
    if generations < 1:
        return
    start = tried.x[tried.ranked()[:CROWD]]
    if len(start) < CROWD:  # lists with few options
        start = np.concatenate([start, first[: CROWD - len(start)]])

    def cost(x: np.ndarray) -> np.ndarray:
        return np.nan_to_num(tried(x.T).costs[:, 0], nan=1e30)

    def over(x: np.ndarray) -> np.ndarray:
        return tried(np.atleast_2d(x.T)).over.T

    low, high = task.space.bounds.T
    differential_evolution(
        cost, list(zip(low, np.maximum(high, low), strict=True)), maxiter=generations, init=start, tol=ALIKE, seed=seed,
        polish=False, updating="deferred", vectorized=True, integrality=~task.space.smooth, mutation=(0.4, 0.9),
        recombination=0.9, constraints=NonlinearConstraint(over, -np.inf, 0.0),
    )  # fmt: skip


@runtime_checkable
class Judge(Protocol):
    """What says of designs what they are worth."""

    task: Task

    def __call__(self, x: np.ndarray, /) -> Worth: ...


@attrs.frozen(eq=False)
class Slopes:
    """What a design is worth, and how that changes with each smooth number (n of them)."""

    cost: float
    over: np.ndarray  #: (limits + 1)
    of_cost: np.ndarray  #: (n) by x
    of_over: np.ndarray  #: (limits + 1, n)

    @property
    def known(self) -> bool:
        """Whether everything is a number."""
        numbers = (self.cost, *self.of_cost, *self.of_over.ravel())
        return bool(np.isfinite(numbers).all()) and bool((self.over < LOST).all())


def slopes_at(tried: Judge, x: np.ndarray, goal: int = 0) -> Slopes:
    """Central differences at a place (axes) by its smooth numbers; one-sided at a bound. All in one batch."""
    which = np.flatnonzero(tried.task.space.smooth)
    rows = np.repeat(x[None], 1 + 2 * len(which), axis=0)
    for k, axis in enumerate(which):
        rows[1 + 2 * k, axis] = min(x[axis] + STEP, 1.0)
        rows[2 + 2 * k, axis] = max(x[axis] - STEP, 0.0)
    worth = tried(rows)
    gaps = np.array([rows[1 + 2 * k, axis] - rows[2 + 2 * k, axis] for k, axis in enumerate(which)])
    lost = np.where(worth.over >= LOST, np.nan, worth.over)
    return Slopes(
        float(worth.costs[0, goal]), worth.over[0], (worth.costs[1::2, goal] - worth.costs[2::2, goal]) / gaps,
        ((lost[1::2] - lost[2::2]) / gaps[:, None]).T,
    )  # fmt: skip


def smooth_end(tried: Judge, x: np.ndarray, goal: int = 0, rounds: int = ROUNDS) -> bool:
    """From a place (axes) on, with options as they are, to the best one near: sequential quadratic programming.

    Where the limits are not kept, the sum of the violations is made least first. Whether the search came to an end by
    itself.
    """
    if not tried.task.space.smooth.any():
        tried(x[None])
        return True
    begin = slopes_at(tried, x, goal)
    if begin.known and (begin.over > NEARLY).any():
        x, ended = _end(tried, x, begin, goal, rounds, True)
        begin = slopes_at(tried, x, goal)
        if not begin.known or (begin.over > NEARLY).any():
            return ended
    return _end(tried, x, begin, goal, rounds, False)[1] if begin.known else False


def _end(tried: Judge, x: np.ndarray, begin: Slopes, goal: int, rounds: int, mend: bool) -> tuple[np.ndarray, bool]:
    """Where sequential quadratic programming comes from a place, and whether it ended by itself.

    To `mend`, each limit may be exceeded by a variable of its own, and the sum of these is made least.
    """
    which = np.flatnonzero(tried.task.space.smooth)
    size, flat = max(abs(begin.cost), 1e-12), np.zeros(len(which))

    def placed(y: np.ndarray) -> np.ndarray:
        full = x.copy()
        full[which] = np.clip(y[: len(which)], 0.0, 1.0)
        return full

    def cost(y: np.ndarray) -> tuple[float, np.ndarray]:
        if mend:
            return float(y[len(which) :].sum()), np.concatenate([flat, np.ones(len(y) - len(which))])
        seen = slopes_at(tried, placed(y), goal)
        return (seen.cost / size, seen.of_cost / size) if seen.known else (BAD, flat)

    def room(y: np.ndarray) -> np.ndarray:
        over = slopes_at(tried, placed(y), goal).over[:-1]
        return (y[len(which) :] - over) if mend else -over

    def of_room(y: np.ndarray) -> np.ndarray:
        slopes = np.nan_to_num(slopes_at(tried, placed(y), goal).of_over[:-1])
        return np.hstack([-slopes, np.eye(len(slopes))]) if mend else -slopes

    limits = len(begin.over) - 1
    start: Any = np.concatenate([x[which], np.maximum(begin.over[:-1], 0.0)]) if mend else x[which]
    bounds = [(0.0, 1.0)] * len(which) + ([(0.0, LOST)] * limits if mend else [])
    constraints = [{"type": "ineq", "fun": room, "jac": of_room}] if limits else []
    found = minimize(cost, start, jac=True, bounds=bounds, constraints=constraints, method="SLSQP",
                     options={"maxiter": rounds, "ftol": 1e-7})  # fmt: skip
    full = placed(found.x)
    tried(full[None])
    return full, bool(found.success) or found.status == STUCK


def neighbours(space: Space, x: np.ndarray) -> np.ndarray:
    """Places (designs, axes) that differ from one in a single number of a list, by few or many places of it."""
    found = []
    for k, axis in enumerate(space.axes):
        if not axis.smooth and axis.numeric:
            for step in (*(1 << power for power in range(6)), *(-(1 << power) for power in range(6))):
                if 0.0 <= x[k] + step <= axis.bounds[1]:
                    found.append(x.copy())
                    found[-1][k] += step
    return np.array(found).reshape(-1, len(x))
