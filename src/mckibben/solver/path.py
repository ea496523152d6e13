"""A path of states: compiled following where it goes well, the robust search and bisection where it does not.

The part that was reached is always kept.
"""

from collections.abc import Callable

import attrs
import numpy as np

from .direct import find
from .equilibrium import Equilibrium, Held
from .follow import follow, padded
from .problem import LENGTH, VOLUME, Problem
from .trust import imbalance

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
    u, loads, iterations = np.full((n, size), np.nan), np.full((n, 4), np.nan), np.zeros(n, int)
    first = find(problem, path[0], start)
    if not first.converged and start is not None:
        first = find(problem, path[0])
    reached, message, here = 0, first.message, first
    while here.converged:
        u[reached], loads[reached], iterations[reached] = here.u, here.loads, here.iterations
        reached += 1
        watch(reached, n)
        if reached == n:
            break
        done = _follow(problem, path[reached - 1 :], here, tolerance)
        for w, count in done:
            u[reached], loads[reached], iterations[reached] = w[:-2], [1.0, w[-2], w[-1], 0.0], count
            reached += 1
        watch(reached, n)
        if reached == n:
            break
        here = _search(problem, path[reached - 1], path[reached], _state(problem, u, loads, reached - 1))
        message = here.message
    return Trace(problem, u, loads, iterations, reached, message if reached < n else "converged")


def _state(problem: Problem, u: np.ndarray, loads: np.ndarray, k: int) -> Equilibrium:
    return settle(problem, u[k], loads[k], 0)


def _follow(problem: Problem, path: list[Held], here: Equilibrium, tolerance: float) -> list[tuple[np.ndarray, int]]:
    """Compiled following from `here` = path[0]; the states after it that are good."""
    if problem.space.basis.closes or len(path) < 2:
        return []
    targets = np.array([held.targets(problem) for held in path])
    w = np.concatenate([here.u, here.loads[[LENGTH, VOLUME]]])
    count, close = np.asarray(len(path)), np.asarray(tolerance)
    track = follow(problem.space, problem.p, problem.b, w, path[0].select(), padded(targets), count, close)
    good = int(track.good)
    return [(np.asarray(track.w[k]), int(track.iterations[k])) for k in range(1, good)]


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
