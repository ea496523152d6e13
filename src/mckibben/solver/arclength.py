"""Along a branch by its arclength (Keller 1977): past a limit point, where the quantity that was varied turns back.

One quantity is held, another is free to go up or down; the next state is sought at a given distance along the branch.
The row of what is varied gives way to the distance: everything else is the system that all others solve.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import inside, looked_at
from mckibben.solver.held import Held, conditions, rows_of, targets_of
from mckibben.solver.newton import bordered
from mckibben.solver.path import Arriving, Trace, Watch
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.system import Unknowns, system

__all__ = ["branch"]

SMALLEST = 1e-5
"""Shortest step along the branch before giving up, in the norm of `Problem.setting`."""
BEND = 0.9
"""Cosine between directions from state to state below which a step was too long."""


class Linear(NamedTuple):
    """The system at a state: matrix by (shape, loads), imbalance, and misses of the rows."""

    matrix: Float[Array, "w w"]
    rest: Float[Array, " m"]
    miss: Float[Array, " l"]


@kernel
def linearised(
    static: tuple[Basis, Any], p: Parameters, b: Number, state: Unknowns, which: Int[Array, " l"], targets: Array
) -> Linear:
    """The bordered system of `newton.bordered`."""
    basis, own = static
    on = place(basis, p, b)
    s = system(basis, on, state)
    c = conditions(own, which, targets, on, s, state.loads)
    return Linear(bordered(s, c), s.rest, c.miss)


class _Branch:
    """A branch: the row that stays held, and the row that is given up for the distance."""

    def __init__(self, problem: Problem, start: Equilibrium, path: Sequence[Held]) -> None:
        first, last = targets_of((path[0], path[-1]), problem.unit, problem.loads)
        varied = int(np.argmax(np.abs(last - first)))
        self.problem, self.size, self.row = problem, problem.basis.unknowns, problem.basis.unknowns + varied
        self.targets, self.span = first, abs(last[varied] - first[varied])
        self.way, self.varied = np.sign(last[varied] - first[varied]), varied
        own, self.which = rows_of(path[0].names, problem.loads)
        self.static = (problem.basis, own)
        loads_vary = path[0].names[varied] in ("force", "pressure")
        self.weights = _weights(problem, self.span if loads_vary else max(1.0, float(np.abs(start.loads).max())))

    def at(self, w: np.ndarray) -> Linear:
        state = Unknowns(w[: self.size], w[self.size :])
        found = linearised(self.static, self.problem.p, self.problem.b, state, self.which, self.targets)
        return Linear(*map(np.array, found))

    def tangent(self, w: np.ndarray, last: np.ndarray | None) -> np.ndarray:
        """Unit direction along the branch, as before; at first, that in which the varied quantity is to go."""
        matrix = self.at(w).matrix
        null = np.linalg.svd(np.delete(matrix, self.row, axis=0))[2][-1]
        null = null / np.sqrt(null @ self.weights @ null)
        ahead = self.way * (matrix[self.row] @ null) if last is None else last @ self.weights @ null
        return null if ahead >= 0.0 else -null

    def correct(self, guess: np.ndarray, tangent: np.ndarray) -> tuple[np.ndarray | None, int]:
        """Newton onto the branch in the plane across the tangent at the guess."""
        w = guess
        for count in range(1, 9):
            at = self.at(w)
            at.matrix[self.row] = self.weights @ tangent
            miss = np.concatenate([at.rest, at.miss])
            miss[self.row] = tangent @ self.weights @ (w - guess)
            try:
                step = np.linalg.solve(at.matrix, -miss)
            except np.linalg.LinAlgError:
                return None, count
            w = w + step
            size = float(np.sqrt(step @ self.weights @ step))
            if not np.isfinite(size) or size > 1.0:
                return None, count
            if size < 1e-10:
                return w, count
        return None, 8

    def along(self, w: np.ndarray) -> float:
        """How far what is varied has gone from its first value."""
        return float(self.at(w).miss[self.varied] * self.way)

    def inside(self, w: np.ndarray) -> bool:
        """Whether a state is one: converged, with a braid angle between 0 and 90 deg."""
        state, theta = looked_at(self.problem, w[: self.size], w[self.size :])
        return state.converged and inside(theta)


def branch(problem: Problem, start: Equilibrium, path: Sequence[Held], watch: Watch = lambda k, n: None) -> Trace:
    """States from `start` (which holds path[0]) along its branch, at most len(path).

    The quantity that differs between path[0] and path[-1] is varied; the walk ends where it reaches its last value, or
    where it has turned and passes its first value again.
    """
    n, on = len(path), _Branch(problem, start, path)

    def advance(rows: Arriving) -> str:
        rows.add(start.u, start.loads, 0)
        w = np.concatenate([start.u, start.loads])
        tangent = on.tangent(w, None)
        step = longest = 1.5 / n
        while rows.reached < n:
            found, count = on.correct(w + step * tangent, tangent)
            new = None if found is None else on.tangent(found, tangent)
            if found is None or new is None or tangent @ on.weights @ new < BEND or not on.inside(found):
                step *= 0.5
                if step < SMALLEST:
                    return "the branch could not be followed further"
                continue
            w, tangent, step = found, new, min(1.5 * step, longest)
            rows.add(w[: on.size], w[on.size :], count)
            watch(rows.reached, n)
            along = on.along(w)
            if along >= on.span or along <= 0.0:
                return "the branch was followed to its end"
        return "the branch goes on: give more points"

    return Arriving.of(problem, n).traced(advance)


def _weights(problem: Problem, size: float) -> np.ndarray:
    """Norm on (shape, loads): the metric of the shape, and the loads over a size.

    That size is the range to be walked where a load is varied, and that of the loads themselves where a length or a
    volume is: its range says nothing of them.
    """
    m = problem.basis.unknowns
    weights = np.zeros((m + problem.loads, m + problem.loads))
    weights[:m, :m] = problem.setting.metric
    weights[m:, m:] = np.eye(problem.loads) / max(size, 1e-6) ** 2
    return weights
