"""The answer of a solver: one state, in SI units."""

import attrs
import numpy as np

from mckibben.solver.held import Now, read_rows
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns

__all__ = ["Equilibrium"]


@attrs.frozen
class Equilibrium:
    """A state on a problem's discretisation, converged or the best that was found."""

    problem: Problem
    u: np.ndarray
    loads: np.ndarray  #: dimensionless force, pressure (and closing moment)
    totals: np.ndarray  #: dimensionless energy, length, volume, closure
    converged: bool
    residual: float  #: imbalance over the sum of the magnitudes of its terms
    iterations: int  #: Newton systems solved
    message: str = "converged"

    @property
    def state(self) -> Unknowns:
        """The unknowns."""
        return Unknowns(self.u, self.loads)

    @property
    def now(self) -> Now:
        """What the state reads, in SI units."""
        loads = self.problem.loads
        found = read_rows(self.problem.unit, self.totals[1 : 1 + loads], self.loads, self.problem.p)
        return Now(*map(float, found))

    @property
    def force(self) -> float:
        """Axial force [N], positive in tension."""
        return self.now.force

    @property
    def pressure(self) -> float:
        """Gauge pressure [Pa]."""
        return self.now.pressure

    @property
    def length(self) -> float:
        """Distance between the ends [m]."""
        return self.now.length

    @property
    def volume(self) -> float:
        """Enclosed volume [m^3]."""
        return self.now.volume

    @property
    def tail(self) -> float:
        """Largest of the last two coefficients over the largest: how well the series has converged."""
        return float(self.problem.basis.tail(self.u))
