"""Along a branch by its arclength (Keller 1977): past a limit point, where the quantity that was varied turns back.

One quantity is held, another is free to go up or down; the next state is sought at a given distance along the branch.
"""

import numpy as np

from .equilibrium import Equilibrium, Held
from .path import INTERRUPTED, Trace, Watch, settle
from .problem import LENGTH, VOLUME, Problem

SMALLEST = 1e-5
"""Shortest step along the branch before giving up, in the norm of `Problem.metric`."""


def branch(problem: Problem, start: Equilibrium, path: list[Held], watch: Watch = lambda k, n: None) -> Trace:
    """States from `start` (which holds path[0]) along its branch, at most len(path).

    The quantity that differs between path[0] and path[-1] is varied; the walk ends where it reaches its last value, or
    where it has turned and passes its first value again.
    """
    first, last = path[0].targets(problem), path[-1].targets(problem)
    varied = int(np.argmax(np.abs(last - first)))
    select, span = path[0].select(), abs(last[varied] - first[varied])
    fixed, free, value = select[1 - varied], select[varied], first[1 - varied]
    loads_vary = path[0].names[varied] in ("force", "pressure")
    weights = _weights(problem, span if loads_vary else max(1.0, float(np.abs(start.loads[[LENGTH, VOLUME]]).max())))
    n = len(path)
    u, loads, counts = np.full((n, len(start.u)), np.nan), np.full((n, 4), np.nan), np.zeros(n, int)
    w = np.concatenate([start.u, start.loads[[LENGTH, VOLUME]]])
    tangent = _tangent(problem, w, fixed, weights, None)
    tangent *= np.sign(_row(problem, w, free) @ tangent) * np.sign(last[varied] - first[varied])
    step = longest = 1.5 / n
    u[0], loads[0], reached, message = start.u, start.loads, 1, "the branch goes on: give more points"
    try:
        while reached < n:
            found, count = _correct(problem, w + step * tangent, tangent, fixed, value, weights)
            new = None if found is None else _tangent(problem, found, fixed, weights, tangent)
            if found is None or new is None or tangent @ weights @ new < 0.9 or not _inside(problem, found):
                step *= 0.5
                if step < SMALLEST:
                    message = "the branch could not be followed further"
                    break
                continue
            w, tangent, step = found, new, min(1.5 * step, longest)
            u[reached], loads[reached], counts[reached] = w[:-2], [1.0, w[-2], w[-1], 0.0], count
            reached += 1
            watch(reached, n)
            along = (_value(problem, w, free) - first[varied]) * np.sign(last[varied] - first[varied])
            if along >= span or along <= 0.0:
                message = "the branch was followed to its end"
                break
    except KeyboardInterrupt:
        message = INTERRUPTED
    return Trace(problem, u, loads, counts, reached, message)


def _weights(problem: Problem, size: float) -> np.ndarray:
    """Norm on (u, force, pressure): the metric of the shape, and the loads over a size.

    That size is the range to be walked where a load is varied, and that of the loads themselves where a length or a
    volume is: its range says nothing of them.
    """
    m = problem.space.basis.unknowns
    weights = np.zeros((m + 2, m + 2))
    weights[:m, :m] = problem.metric()
    weights[m, m] = weights[m + 1, m + 1] = 1.0 / max(size, 1e-6) ** 2
    return weights


def _system(problem: Problem, w: np.ndarray, fixed: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of equilibrium and of the held quantity, the imbalance, and the totals."""
    a = problem.evaluate(w[:-2])
    signs = np.array([1.0, -w[-2], -w[-1], 0.0])
    K, G = np.einsum("k,kmn->mn", signs, np.asarray(a.tangents)), np.asarray(a.gradients)
    rows = np.concatenate([np.concatenate([K, -G[[LENGTH, VOLUME]].T], axis=1), _row_of(G, fixed)[None]])
    return rows, signs @ G, np.asarray(a.totals)


def _row_of(G: np.ndarray, select: np.ndarray) -> np.ndarray:
    return np.concatenate([select[:2] @ G[[LENGTH, VOLUME]], select[2:]])


def _row(problem: Problem, w: np.ndarray, select: np.ndarray) -> np.ndarray:
    return _row_of(np.asarray(problem.evaluate(w[:-2]).gradients), select)


def _value(problem: Problem, w: np.ndarray, select: np.ndarray) -> float:
    totals = np.asarray(problem.evaluate(w[:-2]).totals)
    return float(select @ np.concatenate([totals[[LENGTH, VOLUME]], w[-2:]]))


def _tangent(
    problem: Problem, w: np.ndarray, fixed: np.ndarray, weights: np.ndarray, last: np.ndarray | None
) -> np.ndarray:
    """Unit direction along the branch, the way it was going."""
    rows = _system(problem, w, fixed)[0]
    null = np.linalg.svd(rows)[2][-1]
    null = null / np.sqrt(null @ weights @ null)
    return null if last is None or last @ weights @ null >= 0.0 else -null


def _correct(
    problem: Problem, guess: np.ndarray, tangent: np.ndarray, fixed: np.ndarray, value: float, weights: np.ndarray
) -> tuple[np.ndarray | None, int]:
    """Newton onto the branch in the plane across the tangent at the guess."""
    w = guess
    for count in range(1, 9):
        rows, rest, totals = _system(problem, w, fixed)
        have = float(fixed @ np.concatenate([totals[[LENGTH, VOLUME]], w[-2:]]))
        system = np.concatenate([rows, (weights @ tangent)[None]])
        miss = np.concatenate([rest, [have - value, tangent @ weights @ (w - guess)]])
        try:
            step = np.linalg.solve(system, -miss)
        except np.linalg.LinAlgError:
            return None, count
        w = w + step
        size = float(np.sqrt(step @ weights @ step))
        if not np.isfinite(size) or size > 1.0:
            return None, count
        if size < 1e-10:
            return w, count
    return None, 8


def _inside(problem: Problem, w: np.ndarray) -> bool:
    state = settle(problem, w[:-2], np.array([1.0, w[-2], w[-1], 0.0]), 0)
    theta = np.asarray(problem.evaluate(w[:-2]).state)[:, 0]
    return state.converged and bool(theta.min() > 0.0 and theta.max() < np.pi / 2)
