"""The answer of a solver: one state with what is held, in SI units."""

from typing import Any

import attrs
import numpy as np

from .problem import CLOSURE, LENGTH, VOLUME, Problem

NAMES = ("length", "volume", "force", "pressure")
"""What a lab can hold: two of these at a time."""


def selection(names: tuple[str, ...]) -> np.ndarray:
    """(2, 4): which of `NAMES` each of the two conditions holds."""
    return np.array([[float(name == held) for name in NAMES] for held in names])


@attrs.frozen
class Held:
    """Two of length [m], volume [m^3], force [N], pressure [Pa], held at values."""

    names: tuple[str, str]
    values: tuple[float, float]

    @classmethod
    def of(cls, **values: float | None) -> "Held":
        """`Held.of(length=0.1, pressure=1e5)`; exactly two are not None."""
        given = [(name, float(values[name])) for name in NAMES if values.get(name) is not None]  # type: ignore[arg-type]
        (first, a), (second, b) = given
        return cls((first, second), (a, b))

    def get(self, name: str, default: Any = None) -> Any:
        """Value of a held quantity."""
        return dict(zip(self.names, self.values, strict=True)).get(name, default)

    def select(self) -> np.ndarray:
        """As `selection`."""
        return selection(self.names)

    def targets(self, problem: Problem) -> np.ndarray:
        """The two values, dimensionless."""
        unit, load = problem.unit, problem.load_unit
        by_name = dict(zip(NAMES, (unit[LENGTH], unit[VOLUME], load[LENGTH], load[VOLUME]), strict=True))
        return np.array([value / by_name[name] for name, value in zip(self.names, self.values, strict=True)])


@attrs.frozen
class Equilibrium:
    """A state on a problem's discretisation, converged or the best that was found."""

    problem: Problem
    u: np.ndarray
    loads: np.ndarray  #: dimensionless multipliers (1, force, pressure, closure)
    totals: np.ndarray  #: dimensionless (energy, length, volume, closure)
    converged: bool
    residual: float  #: imbalance over the sum of the magnitudes of its terms
    iterations: int  #: Newton systems solved
    message: str = "converged"

    @property
    def force(self) -> float:
        """Axial force [N], positive in tension."""
        return float(self.loads[LENGTH] * self.problem.load_unit[LENGTH])

    @property
    def pressure(self) -> float:
        """Gauge pressure [Pa]."""
        return float(self.loads[VOLUME] * self.problem.load_unit[VOLUME])

    @property
    def length(self) -> float:
        """Distance between the ends [m]."""
        return float(self.totals[LENGTH] * self.problem.unit[LENGTH])

    @property
    def volume(self) -> float:
        """Enclosed volume [m^3]."""
        return float(self.totals[VOLUME] * self.problem.unit[VOLUME])

    @property
    def closure(self) -> float:
        """Dimensionless multiplier of equal end radii (zero where symmetry gives them)."""
        return float(self.loads[CLOSURE])

    @property
    def tail(self) -> float:
        """Largest of the last two coefficients over the largest: how well the series has converged."""
        size = np.abs(self.u[: self.problem.space.basis.size])
        return float(size[-2:].max() / max(size.max(), 1e-12))
