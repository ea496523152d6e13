"""Fronts: for several goals, the designs of which none is better in every way. By NSGA-II of pymoo, over batches."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from mckibben.designing.search import scatter, smooth_end
from mckibben.designing.tried import LOST, Tried, Worth
from mckibben.spec import SpecError

__all__ = ["MANY", "check_pymoo", "evolve_front", "front_of", "middle_of", "smooth_front"]

CROWD = 128
"""Designs of a generation: two batches."""
ENDS = 10
"""Places along a front at which a smooth end is sought."""
ROUNDS = 8
"""Steps of each at most."""
MANY = 100
"""Most designs of a front."""


def check_pymoo() -> None:
    """SpecError where pymoo is not installed."""
    try:
        import pymoo  # noqa: F401  # only to see whether it is there
    except ImportError as error:
        said = "several goals need the package pymoo, which is not installed"
        raise SpecError("objective", allowed=said, advice="pip install mckibben[optimise], or give one goal") from error


def evolve_front(tried: Tried, designs: int, seed: int) -> None:
    """Try so many designs, each generation nearer to the front and spread more evenly along it."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem as Asked
    from pymoo.optimize import minimize

    task = tried.task
    low, high = task.space.bounds.T

    class Batches(Asked):  # type: ignore[misc]  # pymoo ships no types
        """Many designs at a time, as pymoo asks for them."""

        def __init__(self) -> None:
            super().__init__(n_var=len(low), n_obj=len(task.goals), n_ieq_constr=len(task.limits) + 1, xl=low, xu=high)

        def _evaluate(self, x: np.ndarray, out: dict[str, Any], *_: Any, **__: Any) -> None:
            worth = tried(x)
            out["F"], out["G"] = np.nan_to_num(worth.costs, nan=1e30), worth.over

    size = min(CROWD, designs)
    first = scatter(task, size, seed)
    minimize(Batches(), NSGA2(pop_size=size, sampling=first), ("n_gen", max(designs // size, 1)), seed=seed)


class NoWorse:
    """Designs as they are judged with all goals but the first held at least as good as they were."""

    def __init__(self, tried: Tried, costs: np.ndarray) -> None:
        self.task, self._tried, self._costs = tried.task, tried, costs

    def __call__(self, x: np.ndarray, /) -> Worth:
        """What designs at places (d, axes) are worth."""
        worth = self._tried(x)
        size = np.where(self._costs != 0.0, np.abs(self._costs), 1.0)
        lost = np.isnan(worth.costs[:, 1:])
        held = np.where(lost, LOST, np.clip((worth.costs[:, 1:] - self._costs) / size, -LOST, LOST))
        return attrs.evolve(worth, over=np.concatenate([worth.over[:, :-1], held, worth.over[:, -1:]], axis=1))


def smooth_front(coarse: Tried, fine: Tried) -> None:
    """From the designs of a front to better ones near: each goal alone, then the first with the others held.

    Of two goals the second is held at values evenly spread between its ends.
    """
    own = front_of(coarse)
    for goal in range(len(coarse.task.goals) if len(own) else 0):
        smooth_end(fine, coarse.x[own[np.argmin(coarse.worth.costs[own, goal])]], goal)
    fine(coarse.x[own])
    own = front_of(fine)
    if not len(own):
        return
    costs = fine.worth.costs[own]
    if costs.shape[1] == 2:
        order = np.argsort(costs[:, 1], kind="stable")
        wanted = np.linspace(costs[:, 1].min(), costs[:, 1].max(), ENDS + 2)[1:-1, None]
        starts = _between(fine, own[order], costs[order, 1], wanted[:, 0])
    else:
        some = np.unique(np.linspace(0, len(own) - 1, ENDS).astype(int))
        starts, wanted = fine.x[own[some]], costs[some, 1:]
    for x, held in zip(starts, wanted, strict=True):
        smooth_end(NoWorse(fine, held), x, rounds=ROUNDS)


def _between(fine: Tried, own: np.ndarray, cost: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Places (wanted, axes) between designs of a front with rising costs; words and parts are the nearest one's."""
    x = fine.x[own]
    nearest = x[np.abs(cost[None] - wanted[:, None]).argmin(axis=1)]
    numeric = np.array([axis.numeric for axis in fine.task.space.axes])
    between = np.stack([np.interp(wanted, cost, column) for column in x.T], axis=1)
    return fine.task.space.settled(np.where(numeric, between, nearest))


def front_of(tried: Tried) -> np.ndarray:
    """Which of those tried are on the front, in the order of the first goal; at most so many, evenly spread."""
    from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

    met = np.flatnonzero(tried.worth.met)
    if not len(met):
        return met
    own = met[NonDominatedSorting().do(tried.worth.costs[met], only_non_dominated_front=True)]
    own = own[np.unique(tried.worth.costs[own], axis=0, return_index=True)[1]]
    costs = _scaled(tried.worth.costs[own])
    chosen = [int(k) for k in dict.fromkeys(costs.argmin(axis=0).tolist())]
    apart = np.min([np.linalg.norm(costs - costs[k], axis=1) for k in chosen], axis=0)
    while len(chosen) < min(MANY, len(own)):  # the one farthest from all that are chosen
        chosen.append(int(apart.argmax()))
        apart = np.minimum(apart, np.linalg.norm(costs - costs[chosen[-1]], axis=1))
    kept = own[chosen]
    return np.asarray(kept[np.argsort(tried.worth.costs[kept, 0], kind="stable")])


def middle_of(costs: np.ndarray) -> int:
    """Which design of a front is nearest to having the best of every goal, each over its range on the front."""
    return int(np.linalg.norm(_scaled(costs), axis=1).argmin())


def _scaled(costs: np.ndarray) -> np.ndarray:
    span = np.ptp(costs, axis=0)
    return np.asarray((costs - costs.min(axis=0)) / np.where(span > 0.0, span, 1.0))
