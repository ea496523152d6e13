"""Other starts for a target that was not reached from the cylinder: other orders of loading, and wavy shapes."""

from collections.abc import Iterator

import attrs
import numpy as np

from mckibben.search.walk import BranchEnd
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import embedded, equilibrium, find
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem

WAVES = 9
"""Waves along the length of the shapes to start from, 1 to this many: a compressed braid folds in waves, and from
random shapes fewer of the folded states in validation/ were found."""
SLOPE = 0.6
"""Their steepest slope [rad]."""


def starts(problem: Problem, held: Held, end: BranchEnd | None) -> Iterator[Equilibrium]:
    """Starts in turn: the last good state on the way, the state loaded before it is pressurised, waves of the wall."""
    if end is not None and end.last is not None:
        yield embedded(end.last.state, problem)
    if held.get("pressure", 0.0):
        first, second = (0.0 if name == "pressure" else held.get(name) for name in held.names)
        slack = find(problem, Held(held.names, (first, second)))
        if slack.converged:
            yield slack
    along = 2.0 * np.pi * problem.setting.v / float(problem.p.H0)
    for waves in range(1, WAVES + 1):
        for slope in (SLOPE, -SLOPE):  # bulging, or waisted, next to the fittings
            wave = slope * np.sin(waves * along)
            u = np.linalg.lstsq(problem.setting.slopes, wave, rcond=None)[0]
            yield attrs.evolve(equilibrium(problem, u, np.zeros(problem.loads)), converged=True)
