"""A path of states: compiled following where it goes well, the robust search and bisection where it does not.

The part that was reached is always kept.
"""

from collections.abc import Callable

import attrs
import numpy as np

from ..model.parameters import Parameters
from .direct import find
from .equilibrium import Equilibrium, Held
from .follow import follow, padded
from .problem import LENGTH, VOLUME, Problem, Space, evaluate
from .trust import imbalance

INTERRUPTED = "interrupted"
"""Message of a path that was ended by Ctrl-C."""

Watch = Callable[[int, int], None]
"""Told (states done, states in all) as a path advances."""


@attrs.frozen
class Trace:
    """States along a path; rows from `reached` on hold NaN."""

    problem: Problem
    u: np.ndarray  #: (n, m)
    loads: np.ndarray  #: (n, 4) dimensionless
    iterations: np.ndarray  #: (n)
    reached: int
    message: str = "converged"

    def state(self, k: int) -> Equilibrium:
        """One state with its totals and residual."""
        return settle(self.problem, self.u[k], self.loads[k], int(self.iterations[k]))


def prepare(space: Space, p: Parameters, b: float, count: int) -> None:
    """Have what follows a path of `count` states compiled in the background (see `kernel`)."""
    u = np.empty(space.basis.unknowns)
    evaluate.prepare(space, p, b, u)
    if count > 1 and not space.basis.closes:
        w, targets = np.empty(len(u) + 2), padded(np.empty((count, 2)))
        follow.prepare(space, p, b, w, np.empty((2, 4)), targets, np.asarray(count), np.asarray(0.0))


def settle(problem: Problem, u: np.ndarray, loads: np.ndarray, iterations: int) -> Equilibrium:
    """A state from its unknowns and loads, with the residual that it really has."""
    a = problem.evaluate(u)
    signs = np.concatenate([[1.0], -loads[1:]])
    residual = imbalance(signs, np.asarray(a.gradients))
    return Equilibrium(problem, u, loads, np.asarray(a.totals), residual < 1e-8, residual, iterations)


def trace(
    problem: Problem,
    path: list[Held],
    start: Equilibrium | None = None,
    tolerance: float = 1e-6,
    watch: Watch = lambda k, n: None,
) -> Trace:
    """States for every entry of `path` (all holding the same two names), from `start` or sought directly."""
    n, size = len(path), problem.space.basis.unknowns
    rows = _Rows(np.full((n, size), np.nan), np.full((n, 4), np.nan), np.zeros(n, int))
    try:
        message = _advance(problem, path, start, tolerance, watch, rows)
    except KeyboardInterrupt:  # the part reached is worth keeping
        message = INTERRUPTED
    return Trace(problem, rows.u, rows.loads, rows.iterations, rows.reached, message)


@attrs.define
class _Rows:
    """States as they come in."""

    u: np.ndarray
    loads: np.ndarray
    iterations: np.ndarray
    reached: int = 0

    def add(self, u: np.ndarray, loads: np.ndarray, iterations: int) -> None:
        """Keep one more state; it counts only once all of it is there."""
        k = self.reached
        self.u[k], self.loads[k], self.iterations[k] = u, loads, iterations
        self.reached = k + 1


def _advance(
    problem: Problem, path: list[Held], start: Equilibrium | None, tolerance: float, watch: Watch, rows: _Rows
) -> str:
    """Fill in rows as far as it goes; the message says why it ended."""
    n = len(path)
    here = find(problem, path[0], start)
    if not here.converged and start is not None:
        here = find(problem, path[0])
    while here.converged:
        rows.add(here.u, here.loads, here.iterations)
        watch(rows.reached, n)
        for w, count in _follow(problem, path[rows.reached - 1 :], here, tolerance):
            rows.add(w[:-2], np.array([1.0, w[-2], w[-1], 0.0]), count)
        watch(rows.reached, n)
        if rows.reached == n:
            return "converged"
        k = rows.reached
        here = _search(problem, path[k - 1], path[k], settle(problem, rows.u[k - 1], rows.loads[k - 1], 0))
    return here.message


def _follow(problem: Problem, path: list[Held], here: Equilibrium, tolerance: float) -> list[tuple[np.ndarray, int]]:
    """Compiled following from `here` = path[0]; the states after it that are good."""
    if problem.space.basis.closes or len(path) < 2:
        return []
    targets = np.array([held.targets(problem) for held in path])
    w = np.concatenate([here.u, here.loads[[LENGTH, VOLUME]]])
    count, close = np.asarray(len(path)), np.asarray(tolerance)
    track = follow(problem.space, problem.p, problem.b, w, path[0].select(), padded(targets), count, close)
    w, iterations = np.asarray(track.w), np.asarray(track.iterations)
    return [(w[k], int(iterations[k])) for k in range(1, int(track.good))]


def _search(problem: Problem, here: Held, there: Held, state: Equilibrium, depth: int = 6) -> Equilibrium:
    """The robust search for one step, halved up to `depth` times where it fails or jumps."""
    found = find(problem, there, state, radius=0.3)
    jump = float(np.abs(problem.slopes[0] @ (found.u - state.u)).max()) if found.converged else np.inf
    if found.converged and (jump < 0.6 or depth == 0):
        return found
    if depth == 0:
        return found
    values = tuple(0.5 * (a + b) for a, b in zip(here.values, there.values, strict=True))
    middle = _search(problem, here, Held(here.names, (values[0], values[1])), state, depth - 1)
    if not middle.converged:
        return attrs.evolve(found, converged=False) if not found.converged else found
    return _search(problem, Held(here.names, (values[0], values[1])), there, middle, depth - 1)
