"""A test on a muscle whose crossings rub: state by state, each from what the one before left behind.

The muscle starts as it was made, at its own length and without pressure, its crossings free of moment. Where a test
holds the pressure, that comes first, at the length as made; then the other quantity goes to its first value.
"""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.experiments.going import LARGEST_TURN, Going, along, mounted, step_to
from mckibben.measure.report import Part
from mckibben.measure.survey import ROUNDING, Memories, Survey, error_bound, survey
from mckibben.solver.bench import QUICK, Bench, sizes_for
from mckibben.solver.held import Held
from mckibben.solver.path import INTERRUPTED, Watch
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Along, SpecError, Step

__all__ = ["denser", "rubbed", "walked"]

LARGEST = 48
"""Unknowns up to which a path is walked anew: the error that the kink of the moment leaves falls slowly."""
MOST = 2
"""Walks at most after the first."""
LOOSE = 1e-4
"""Tolerance from which on walks begin on few unknowns."""
SERIES = 0.5
"""Error by how the series end, over that found, up to which it is points that a path lacks, not unknowns."""
NEARBY = 4
"""States before and after one whose differences count as its own: half of them are compared."""
EARLY = (1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0)
"""Parts of the first step after a path turns, where it stops in between."""
STRAIGHT = 1e-6
"""How far the cosine between two ways may be from 1 for a path to go straight on."""
LOST = "no state was found on from the one before: the shape gives way, or there is none"


@attrs.frozen
class _Leg:
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


@one_thread()
def rubbed(
    bench: Bench, steps: tuple[Step, ...], b: float, tolerance: float, watch: Watch = lambda k, n: None
) -> list[Part]:
    """The states of every step, on as many unknowns as the tolerance needs, their points crowded by b.

    Where slipping crossings border on sticking ones their moment has a kink, of which a series knows nothing; and where
    only some slip, forces depend on the steps of the path. So the error is told by how much force and length differ
    from those on half as many points, or half as many unknowns, in steps twice as large.
    """
    for step in steps:
        if step.gas is not None or step.along == Along.BRANCH:
            what = "a sealed gas" if step.gas is not None else 'along="branch"'
            raise SpecError("friction", allowed=f"does not go with {what}", advice="hold values, or leave friction out")
    sizes = [QUICK, *(size for size in sizes_for("spectral", tolerance) if QUICK < size <= LARGEST)]
    smooth = bench.p.friction.chamber is None
    # Few unknowns first: they may do where little is asked. Else it is points that are amiss as a rule, of which they
    # tell nothing.
    few = tolerance >= LOOSE or not smooth
    left = sizes[0 if few else 1 :]
    problem = bench.problem(left.pop(0), b)
    walk = partial(walked, bench, steps=steps, watch=watch)
    rough = walk(problem, halved=True)
    legs: list[_Leg] | None = None
    errors: list[np.ndarray] = []
    for _ in range(MOST):
        if _interrupted(legs or rough) or (errors and all((error <= tolerance).all() for error in errors)):
            break
        points = smooth and (_points_lack(problem, legs or rough, errors) if errors else not few)
        if _dense(problem) if points else not left:
            break
        if legs is not None and not _dense(problem):  # twice the points are as many as twice the unknowns have
            rough = walk(problem, halved=True)
        finer = denser(bench, problem) if points else bench.problem(left.pop(0), b)
        again = walk(finer)
        if _reached(again) < _reached(legs or rough) and not _interrupted(again):
            break  # short waves may lose the way: what was reached is kept
        errors = [_differences(bench, *pair) for pair in zip(again, rough, strict=True)]
        if _dense(finer):  # the same series on more points: the difference knows it not
            errors = [np.maximum(*pair) for pair in zip(errors, map(partial(_by_tail, finer), again), strict=True)]
        problem, legs = finer, again
    if legs is None:  # nothing to compare with on more points, so on fewer unknowns
        legs = walk(problem)
        if not _interrupted(rough) and not few:
            rough = walk(bench.problem(QUICK, b), halved=True)
            errors = [_differences(bench, *pair) for pair in zip(legs, rough, strict=True)]
    errors = errors or [np.full(len(leg.states), np.nan) for leg in legs]
    return [_part(problem, *pair) for pair in zip(legs, errors, strict=True)]


def _points_lack(problem: Problem, legs: list[_Leg], errors: list[np.ndarray]) -> bool:
    """Whether a path lacks points, not unknowns.

    Where slipping crossings border on sticking ones, the sum over the points misses what lies between two of them; by
    more unknowns alone that does not become less. A chamber that slides has a stress that jumps, which takes unknowns.
    """
    return _largest([_by_tail(problem, leg) for leg in legs]) <= SERIES * _largest(errors)


def denser(bench: Bench, problem: Problem) -> Problem:
    """The same series on twice the points."""
    basis = attrs.evolve(problem.basis, dense=True)  # type: ignore[arg-type, unused-ignore]
    return Problem.of(basis, bench.p, problem.b)


def _dense(problem: Problem) -> bool:
    """Whether it has twice the points of other problems."""
    return bool(getattr(problem.basis, "dense", False))


def _by_tail(problem: Problem, leg: _Leg) -> np.ndarray:
    """Relative error of force and length by how the series end (n)."""
    if not leg.states:
        return np.zeros(0)
    tail = problem.basis.tail(np.stack([one.state.u for one in leg.states]))
    return error_bound(np.full(len(tail), np.nan), tail, True)


def _largest(errors: list[np.ndarray]) -> float:
    """The largest number that is one; 0 where there is none."""
    every = np.concatenate(errors)
    return float(np.nanmax(every, initial=0.0)) if np.isfinite(every).any() else 0.0


def _interrupted(legs: list[_Leg]) -> bool:
    return any(leg.why == INTERRUPTED for leg in legs)


def _reached(legs: list[_Leg]) -> int:
    """States of all steps together, as far as they were walked."""
    return sum(len(leg.way) for leg in legs)


def _differences(bench: Bench, leg: _Leg, coarse: _Leg) -> np.ndarray:
    """Of length and force from those of a coarser space, over the length and the axial load of mesh and chamber.

    What a kink between two points leaves vanishes where it happens to lie well, so that the states nearby count too.
    """
    area, found = float(np.pi * bench.p.R0**2), np.full(len(leg.way), np.nan)
    for k, (one, other) in enumerate(zip(leg.way, coarse.way, strict=False)):
        if one is None or other is None:
            continue
        now, then = one.present, other.present
        load = max(abs(now["force"]), abs(area * now["pressure"]), 1e-300)
        by_load = max(abs(now["force"] - then["force"]), area * abs(now["pressure"] - then["pressure"])) / load
        found[k] = max(by_load, abs(now["length"] - then["length"]) / now["length"])
    known = np.flatnonzero(~np.isnan(found))
    near = [found[max(k - NEARBY, 0) : k + NEARBY + 1] for k in range(len(found))]
    last = known[-1] if len(known) else -1
    return np.array([np.nanmax(some) if k <= last else np.nan for k, some in enumerate(near)])


def walked(bench: Bench, problem: Problem, steps: tuple[Step, ...], watch: Watch, halved: bool = False) -> list[_Leg]:
    """Every step in turn; after one that was not finished none is tried. `halved` takes half as many steps."""
    here: Going | None = Going.as_made(problem)
    legs: list[_Leg] = []
    total, done = sum(step.points for step in steps), 0
    for step in steps:
        n, held = step.points, tuple(str(name) for name in step.controls)
        if here is None:
            legs.append(_Leg(held, n, n, [], "the step before was not finished"))
            continue
        wanted = np.stack([getattr(step, name).sample(n, here.present[name]) for name in held], axis=1)
        beyond = np.flatnonzero(wanted[:, 0] >= bench.longest) if held[0] == "length" else np.zeros(0, int)
        possible = int(beyond[0]) if len(beyond) else n
        path = [Held(held, tuple(row)) for row in wanted[:possible].tolist()]
        seen = partial(_told, watch, done, total)
        way, why = _states(problem, here, path, seen, first=not legs, halved=halved)
        why = bench.too_long() if len(way) == possible < n and why != INTERRUPTED else why
        legs.append(_Leg(held, n, possible, way, why))
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
            walk = along(problem, now, begin, [held for held, _ in stops], farthest)
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
    return found


def _part(problem: Problem, leg: _Leg, error: np.ndarray) -> Part:
    """A step of the test with everything read off its states."""
    states = leg.states
    look = _seen(problem, states, leg.held, error) if states else None
    return Part(leg.held, leg.asked, leg.possible, look, np.array([one.iterations for one in states], int), leg.why)


def _seen(problem: Problem, states: list[Going], held: tuple[str, ...], error: np.ndarray) -> Survey:
    """A survey of the states of a path."""
    found = [one.found for one in states if one.found is not None]
    u, loads = (np.stack([getattr(one.state, name) for one in found]) for name in ("u", "loads"))
    memories = [Memories(one.state.memory, one.kept) for one in found]
    kept: Memories = jax.tree.map(lambda *rows: np.stack(rows), *memories)
    look = survey(problem, u, loads, held, kept)
    dissipated = np.array([one.dissipated for one in states])
    error = np.where(np.isnan(error), look.error, np.maximum(error, ROUNDING))
    return attrs.evolve(look, numbers=look.numbers | {"dissipated": dissipated, "error_estimate": error})
