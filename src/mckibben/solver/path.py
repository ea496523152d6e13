"""A path of states: compiled following where it goes well, the robust search and bisection where it does not.

The part that was reached is always kept.
"""

from collections.abc import Callable, Sequence

import attrs
import numpy as np

from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import along, equilibrium, find
from mckibben.solver.follow import follow_to
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem

__all__ = ["INTERRUPTED", "LOOSE", "Arriving", "Trace", "Watch", "trace"]

INTERRUPTED = "interrupted"
"""Message of a path that was ended by Ctrl-C."""

JUMP = 0.6
"""Largest change of psi [rad] from state to state that is trusted to stay on the branch."""

LOOSE = 1e-4
"""Last Newton step, at most, of a state on a path; the error that is left is about its square."""
FEW_LEGS = 4
"""States on the quick way from rest to the first one."""
NEAR = 1e-5
"""Last Newton step there, at most."""

Watch = Callable[[int, int], None]
"""Told (states done, states in all) as a path advances."""


@attrs.frozen
class Trace:
    """States along a path; rows from `reached` on hold NaN."""

    problem: Problem
    u: np.ndarray  #: (n, m)
    loads: np.ndarray  #: (n, l) dimensionless
    iterations: np.ndarray  #: (n)
    reached: int
    message: str = "converged"

    def state(self, k: int) -> Equilibrium:
        """One state with its totals and residual."""
        return equilibrium(self.problem, self.u[k], self.loads[k], int(self.iterations[k]))


@attrs.define
class Arriving:
    """States as they come in; an unexpected end loses none of them."""

    problem: Problem
    u: np.ndarray
    loads: np.ndarray
    iterations: np.ndarray
    reached: int = 0

    @classmethod
    def of(cls, problem: Problem, n: int) -> "Arriving":
        """Room for n states."""
        room = np.full((n, problem.basis.unknowns), np.nan), np.full((n, problem.loads), np.nan)
        return cls(problem, *room, np.zeros(n, int))

    def add(self, u: np.ndarray, loads: np.ndarray, iterations: int) -> None:
        """Keep one more state; it counts only once all of it is there."""
        k = self.reached
        self.u[k], self.loads[k], self.iterations[k] = u, loads, iterations
        self.reached = k + 1

    def traced(self, advance: Callable[["Arriving"], str]) -> Trace:
        """What `advance` fills in, as far as it goes; it says why it ended. Ctrl-C ends it too."""
        try:
            message = advance(self)
        except KeyboardInterrupt:  # the part reached is worth keeping
            message = INTERRUPTED
        return Trace(self.problem, self.u, self.loads, self.iterations, self.reached, message)


def trace(
    problem: Problem,
    path: Sequence[Held],
    start: Equilibrium | None = None,
    tolerance: float = 1e-6,
    watch: Watch = lambda k, n: None,
) -> Trace:
    """States for every entry of `path` (all holding the same two things), from `start` or sought directly."""
    n = len(path)

    def advance(rows: Arriving) -> str:
        here = _first(problem, path[0], start)
        while here.converged:
            rows.add(here.u, here.loads, here.iterations)
            watch(rows.reached, n)
            if n > rows.reached:
                for one in follow_to(problem, path[rows.reached - 1 :], here, tolerance)[1:]:
                    rows.add(*one)
            watch(rows.reached, n)
            if rows.reached == n:
                return "converged"
            k = rows.reached
            last = equilibrium(problem, rows.u[k - 1], rows.loads[k - 1])
            here = _search(problem, path[k - 1], path[k], last)
        return here.message

    return Arriving.of(problem, n).traced(advance)


def _first(problem: Problem, held: Held, start: Equilibrium | None) -> Equilibrium:
    """The first state: on the quick way where nothing is in it, else by the robust search."""
    near = along(problem, held, legs=FEW_LEGS, tolerance=NEAR) if start is None else find(problem, held, start)
    return near if near.converged else find(problem, held)


def _search(problem: Problem, here: Held, there: Held, state: Equilibrium, depth: int = 6) -> Equilibrium:
    """The robust search for one step, halved up to `depth` times where it fails or jumps."""
    found = find(problem, there, state, radius=0.3)
    jump = problem.moved(found.u - state.u) if found.converged else np.inf
    if depth == 0 or (found.converged and jump < JUMP):
        return found
    between = here.towards(there, 0.5)
    middle = _search(problem, here, between, state, depth - 1)
    if not middle.converged:
        return found
    return _search(problem, between, there, middle, depth - 1)
