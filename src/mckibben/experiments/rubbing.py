"""A test on a muscle whose crossings rub: walked twice or more, until what the walks differ by is small enough."""

from functools import partial

import attrs
import jax
import numpy as np

from mckibben.experiments.going import Going
from mckibben.experiments.walked import Leg, walked
from mckibben.measure.report import Part
from mckibben.measure.survey import ROUNDING, Memories, Survey, error_bound, survey
from mckibben.solver.bench import QUICK, Bench, sizes_for
from mckibben.solver.path import INTERRUPTED, Watch
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Along, SpecError, Step

__all__ = ["denser", "rubbed"]

LARGEST = 48
"""Unknowns up to which a path is walked anew: the error that the kink of the moment leaves falls slowly."""
MOST = 2
"""Walks at most after the first."""
LOOSE = 1e-4
"""Tolerance from which on walks begin on few unknowns."""
SAFETY = 3.0
"""Times the difference of two walks is what is told of the finer one, as in the grid convergence index where two grids
are compared (Roache 1994, J. Fluids Eng. 116, 405), of order 1: half as many steps and points err twice as much.
"""
SERIES = 0.5
"""Error by how the series end, over that found, up to which it is points that a path lacks, not unknowns."""
NEARBY = 4
"""States before and after one whose differences count as its own: half of them are compared."""


@one_thread()
def rubbed(
    bench: Bench, steps: tuple[Step, ...], b: float, tolerance: float, watch: Watch = lambda k, n: None
) -> list[Part]:
    """The states of every step, on as many unknowns as the tolerance needs, their points crowded by b.

    Where slipping crossings border on sticking ones their moment has a kink, of which a series knows nothing; and where
    only some slip, forces depend on the steps of the path. So the error is told by three times what force and length
    differ by from those on half as many points, or half as many unknowns, in steps twice as large.
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
    legs: list[Leg] | None = None
    errors: list[np.ndarray] = []
    for _ in range(MOST):
        if _interrupted(legs or rough) or (errors and all((error <= tolerance).all() for error in errors)):
            break
        points = smooth and (_points_lack(problem, legs or rough, errors, tolerance) if errors else not few)
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
        legs = walk(problem, most=_reached(rough) if _interrupted(rough) else None)
        if not _interrupted(rough) and not few:
            rough = walk(bench.problem(QUICK, b), halved=True)
            errors = [_differences(bench, *pair) for pair in zip(legs, rough, strict=True)]
    errors = errors or [np.full(len(leg.states), np.nan) for leg in legs]
    return [_part(problem, *pair) for pair in zip(legs, errors, strict=True)]


def _points_lack(problem: Problem, legs: list[Leg], errors: list[np.ndarray], tolerance: float) -> bool:
    """Whether a path lacks points, not unknowns: the series end within the tolerance, or err less than all else.

    Where slipping crossings border on sticking ones, the sum over the points misses what lies between two of them; by
    more unknowns alone that does not become less. A chamber that slides has a stress that jumps, which takes unknowns.
    """
    return _largest([_by_tail(problem, leg) for leg in legs]) <= max(tolerance, SERIES / SAFETY * _largest(errors))


def denser(bench: Bench, problem: Problem) -> Problem:
    """The same series on twice the points."""
    basis = attrs.evolve(problem.basis, dense=True)  # type: ignore[arg-type, unused-ignore]
    return Problem.of(basis, bench.p, problem.b)


def _dense(problem: Problem) -> bool:
    """Whether it has twice the points of other problems."""
    return bool(getattr(problem.basis, "dense", False))


def _by_tail(problem: Problem, leg: Leg) -> np.ndarray:
    """Relative error of force and length by how the series end (n)."""
    if not leg.states:
        return np.zeros(0)
    tail = problem.basis.tail(np.stack([one.state.u for one in leg.states]))
    return error_bound(np.full(len(tail), np.nan), tail, True)


def _largest(errors: list[np.ndarray]) -> float:
    """The largest number that is one; 0 where there is none."""
    every = np.concatenate(errors)
    return float(np.nanmax(every, initial=0.0)) if np.isfinite(every).any() else 0.0


def _interrupted(legs: list[Leg]) -> bool:
    return any(leg.why == INTERRUPTED for leg in legs)


def _reached(legs: list[Leg]) -> int:
    """States of all steps together, as far as they were walked."""
    return sum(len(leg.way) for leg in legs)


def _differences(bench: Bench, leg: Leg, coarse: Leg) -> np.ndarray:
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
    return np.array([SAFETY * np.nanmax(some) if k <= last else np.nan for k, some in enumerate(near)])


def _part(problem: Problem, leg: Leg, error: np.ndarray) -> Part:
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
