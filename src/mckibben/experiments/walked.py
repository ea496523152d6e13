"""A test on a muscle whose crossings rub, walked once: state by state, each from what the one before left behind.

The muscle starts as it was made, at its own length and without pressure, its crossings free of moment. Where a test
holds the pressure, that comes first, at the length as made; then the other quantity goes to its first value.
"""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import attrs
import numpy as np

from mckibben.experiments.going import LARGEST_TURN, Going, mounted, step_to, steps_along
from mckibben.solver.bench import Bench
from mckibben.solver.held import Held
from mckibben.solver.path import INTERRUPTED, Watch
from mckibben.solver.problem import Problem
from mckibben.spec import Step

__all__ = ["Leg", "walked"]

EARLY = (1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0)
"""Parts of the first step after a path turns, where it stops in between."""
STRAIGHT = 1e-6
"""How far the cosine between two ways may be from 1 for a path to go straight on."""
LOST = "no state was found on from the one before: the shape gives way, or there is none"


@attrs.frozen
class Leg:
    """One step of a test as far as it was walked."""

    held: tuple[str, ...]
    asked: int
    possible: int  #: states before full extension
    way: list[Going | None]  #: None where a walk in larger steps has gone over a state
    why: str  #: why it ended

    @property
    def states(self) -> list[Going]:
        """Those that are there."""
        return [one for one in self.way if one is not None]


def walked(
    bench: Bench, problem: Problem, steps: tuple[Step, ...], watch: Watch, halved: bool = False, most: int | None = None
) -> list[Leg]:
    """Every step in turn; after one that was not finished none is tried.

    `halved` takes half as many steps. `most` states are walked, as many as an interrupted walk had come to.
    """
    here: Going | None = Going.as_made(problem)
    legs: list[Leg] = []
    total, done = sum(step.points for step in steps), 0
    for step in steps:
        n, held = step.points, tuple(str(name) for name in step.controls)
        if here is None:
            legs.append(Leg(held, n, n, [], "the step before was not finished"))
            continue
        wanted = np.stack([getattr(step, name).sample(n, here.present[name]) for name in held], axis=1)
        beyond = np.flatnonzero(wanted[:, 0] >= bench.longest) if held[0] == "length" else np.zeros(0, int)
        possible = int(beyond[0]) if len(beyond) else n
        path = [Held(held, tuple(row)) for row in wanted[:possible].tolist()]
        left = len(path) if most is None else min(max(most - done, 0), len(path))
        seen = partial(_told, watch, done, total)
        way, why = _states(problem, here, path[:left], seen, first=not legs, halved=halved)
        why = INTERRUPTED if left < len(path) else why
        why = bench.too_long() if len(way) == possible < n and why != INTERRUPTED else why
        legs.append(Leg(held, n, possible, way, why))
        here = way[-1] if len(way) == n else None
        done += n
    return legs


def _told(watch: Watch, done: int, total: int, k: int) -> None:
    watch(done + k, total)


def _states(
    problem: Problem, here: Going, path: Sequence[Held], watch: Any, first: bool, halved: bool
) -> tuple[list[Going | None], str]:
    """The states of a path as far as they were reached, and why it ended."""
    way: list[Going | None] = []
    farthest = 2.0 * LARGEST_TURN if halved else LARGEST_TURN
    try:
        now = _pressurised(problem, here, path[0], farthest) if first and path else here
        if now is None:
            return way, LOST
        begin = Held(path[0].names, tuple(now.present[name] for name in path[0].names)) if path else Held((), ())
        stops = _stops([begin, *path], halved)
        while stops:
            walk = steps_along(problem, now, begin, [held for held, _ in stops], farthest)
            found = walk.states
            if not found:  # the next is too far for one step
                parts = step_to(problem, now, begin, stops[0][0], turn=walk.turn, farthest=farthest)
                if parts is None:
                    return way, LOST
                found = [parts]
            now, begin = found[-1], stops[len(found) - 1][0]
            for one, (_, k) in zip(found, stops, strict=False):
                if k is not None:
                    way += [None] * (k - len(way)) + [one]
                    watch(len(way))
            stops = stops[len(found) :]
    except KeyboardInterrupt:  # the part reached is worth keeping
        return way, INTERRUPTED
    return way, "converged"


def _stops(path: Sequence[Held], halved: bool) -> list[tuple[Held, int | None]]:
    """Where a path stops after its begin: what is held and which state of the path it is, or None for one in between.

    Where a path turns, crossings that stick soon begin to slip, so that the first step is taken in parts; `halved`
    takes it at once, and every second state of each straight part.
    """
    if len(path) < 2:
        return []
    ways = np.diff([held.values for held in path], axis=0)
    largest = np.abs(ways).max(axis=0)
    ways = ways / np.where(largest > 0.0, largest, 1.0)
    lengths = np.linalg.norm(ways, axis=1)
    onward = np.sum(ways[:-1] * ways[1:], axis=1) >= (1.0 - STRAIGHT) * lengths[:-1] * lengths[1:]
    stays = (lengths[1:] == 0.0) | (lengths[:-1] == 0.0)
    corners = [0, *(np.flatnonzero(~onward | stays) + 1).tolist(), len(path) - 1]
    stops: list[tuple[Held, int | None]] = []
    for a, b in pairwise(corners):
        if not halved and lengths[a] > 0.0:
            stops += [(path[a].towards(path[a + 1], share), None) for share in EARLY]
        which = range(b, a, -2) if halved else range(b, a, -1)
        stops += [(path[k], k - 1) for k in reversed(which)]
    return stops


def _pressurised(problem: Problem, here: Going, held: Held, farthest: float) -> Going | None:
    """The muscle at its length as made and the pressure that is held at first, if one is."""
    pressure = held.get("pressure")
    if pressure is None:
        return here
    legs = [Held.of(length=here.present["length"], pressure=value) for value in (0.0, pressure)]
    found = step_to(problem, here, legs[0], legs[1], farthest=farthest)
    if found is None and (there := mounted(problem, here, legs[0])) is not None:
        found = step_to(problem, there, legs[0], legs[1], farthest=farthest)
    if found is None and (there := mounted(problem, here, legs[1], farthest)) is not None:
        return there  # a chamber that slides, which hardly any pressure presses on the mesh yet, may be lost on the way
    return found
