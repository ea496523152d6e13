"""States of one muscle at measured lengths and pressures, sought robustly."""

import numpy as np

from mckibben.discretise.placement import crowding
from mckibben.solver import find
from mckibben.solver.bench import NEARLY, Bench
from mckibben.solver.follow import follow_to
from mckibben.solver.held import Held
from mckibben.solver.path import FEW_LEGS, LOOSE, NEAR, trace
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle

__all__ = ["fitting_problem", "ordered", "seek"]

GAPS = 3
"""How many points of one test may be beyond reach before the rest of it is given up."""


def ordered(points: np.ndarray, tests: np.ndarray, rest: float) -> tuple[np.ndarray, ...]:
    """Rows of `points` (n, 2: length, pressure) test by test, each along what varies more.

    The first is that end which is nearer to the length `rest`, or to no pressure.
    """
    found = []
    for test in dict.fromkeys(tests.tolist()):
        rows = np.flatnonzero(tests == test)
        some = points[rows]
        spread = np.ptp(some, axis=0) / np.maximum(np.abs(some).max(axis=0), 1e-12)
        along = int(np.argmax(spread))
        order = np.argsort(some[:, along], kind="stable")
        first, last = np.abs(some[order[[0, -1]], along] - (rest, 0.0)[along])
        found.append(rows[order if first <= last else order[::-1]])
    return tuple(found)


@one_thread()
def seek(
    problem: Problem, longest: float, points: np.ndarray, orders: tuple[np.ndarray, ...], thorough: bool = False
) -> Unknowns:
    """A state for every point (n, 2: length [m], pressure [Pa]); NaN where there is none or none was found.

    The quick way follows each test from its first point; the thorough one seeks what that does not reach, and may take
    seconds for a point that has no state.
    """
    u = np.full((len(points), problem.basis.unknowns), np.nan)
    loads = np.full((len(points), problem.loads), np.nan)
    for rows in orders:
        left, gaps = rows[points[rows, 0] < longest], 0
        while len(left) and gaps <= GAPS:
            path = [Held(("length", "pressure"), (h, P)) for h, P in points[left].tolist()]
            found = _sought(problem, path) if thorough else _followed(problem, path)
            k = len(found)
            if k:
                u[left[:k]], loads[left[:k]] = (np.stack(part) for part in zip(*found, strict=True))
            left, gaps = left[k + 1 :], gaps + 1 if thorough else GAPS + 1
    return Unknowns(u, loads)


def _followed(problem: Problem, path: list[Held]) -> list[tuple[np.ndarray, np.ndarray]]:
    first = find.along(problem, path[0], legs=FEW_LEGS, tolerance=NEAR)
    if not first.converged:
        return []
    return [(one.u, one.loads) for one in follow_to(problem, path, first, LOOSE)]


def _sought(problem: Problem, path: list[Held]) -> list[tuple[np.ndarray, np.ndarray]]:
    walked = trace(problem, path, tolerance=LOOSE)
    return [(walked.u[k], walked.loads[k]) for k in range(walked.reached)]


def fitting_problem(muscle: Muscle, points: np.ndarray, size: int) -> tuple[Problem, float]:
    """The muscle on so many unknowns, placed for these points, and the longest length it can have [m]."""
    bench = Bench.of(muscle)
    nothing = np.full(len(points), np.nan)
    b = crowding(bench.p, np.minimum(points[:, 0], NEARLY * bench.longest), nothing, points[:, 1])
    return bench.problem(size, b), bench.longest
