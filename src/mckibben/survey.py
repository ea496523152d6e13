"""What solved states are worth: residual, modes, shape, verdict, and an estimate of their numerical error."""

import attrs
import numpy as np

from . import recover as recovering
from .judge import Judgement, judge, shape_of
from .model.kinematics import height_rate, radius
from .model.parameters import Parameters
from .recover import Recovered, pad, recover
from .solver.problem import LENGTH, VOLUME, Problem, Space
from .solver.stability import count_modes, stiffness
from .solver.trust import imbalance
from .verdict import Modes

ROUNDING = 1e-11
"""Relative error that rounding leaves in a force or length at best."""


@attrs.frozen
class Survey:
    """n states on one problem."""

    problem: Problem
    u: np.ndarray  #: (n, m)
    loads: np.ndarray  #: (n, 4) dimensionless
    totals: np.ndarray  #: (n, 4) dimensionless
    residual: np.ndarray  #: (n) imbalance over the size of its terms
    modes: list[Modes]
    verdicts: list[Judgement]
    recovered: Recovered
    error: np.ndarray  #: (n) estimated relative error of force and length

    @property
    def length(self) -> np.ndarray:
        """Distance between the fittings [m]."""
        return np.asarray(self.totals[:, LENGTH] * self.problem.unit[LENGTH])

    @property
    def volume(self) -> np.ndarray:
        """Enclosed volume [m^3]."""
        return np.asarray(self.totals[:, VOLUME] * self.problem.unit[VOLUME])

    @property
    def force(self) -> np.ndarray:
        """Axial force [N]."""
        return np.asarray(self.loads[:, LENGTH] * self.problem.load_unit[LENGTH])

    @property
    def pressure(self) -> np.ndarray:
        """Gauge pressure [Pa]."""
        return np.asarray(self.loads[:, VOLUME] * self.problem.load_unit[VOLUME])


def prepare(space: Space, p: Parameters, b: float, count: int) -> None:
    """Have what a survey of `count` states calls compiled in the background (see `kernel`)."""
    u, loads = pad(np.empty((count, space.basis.unknowns))), pad(np.empty((count, 4)))
    stiffness.prepare(space, p, b, u, loads)
    recovering.prepare(space, p, b, count)


def survey(problem: Problem, u: np.ndarray, loads: np.ndarray, held: tuple[str, ...]) -> Survey:
    """Look at states u (n, m) under loads (n, 4), found with `held` controlled."""
    n = len(u)
    K = stiffness(problem.space, problem.p, problem.b, pad(u), pad(loads))
    K = type(K)(*(np.asarray(part)[:n] for part in K))
    modes = count_modes(problem.space, K, pressure_held="volume" not in held)
    recovered = recover(problem, u, loads)
    meridians = zip(*meridian(problem, u), strict=True)
    verdicts = [judge(mode, shape_of(*line), "length" in held) for mode, line in zip(modes, meridians, strict=True)]
    signs = np.concatenate([np.ones((n, 1)), -loads[:, 1:]], axis=1)
    residual = np.array([imbalance(*pair) for pair in zip(signs, np.asarray(K.gradients), strict=True)])
    return Survey(
        problem, u, loads, np.asarray(K.totals), residual, modes, verdicts, recovered,
        error_estimate(recovered),
    )  # fmt: skip


def meridian(problem: Problem, u: np.ndarray, count: int = 1001) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slope [rad], radius and height [m] of states u (n, m) at many points along the length, dense at the fittings."""
    p, b, basis = problem.p, problem.b, problem.space.basis
    theta, psi, _ = basis.profile(p, b, u, count)
    inner, slope, _ = basis.profile(p, b, u)
    z = basis.integral(p, b, np.asarray(height_rate(inner, slope, p)), count)
    return psi, np.asarray(radius(theta, p)), z


def error_estimate(recovered: Recovered) -> np.ndarray:
    """Relative error of force and length to expect of each state."""
    return error_of(recovered.conserved_variation, recovered.coefficient_tail)


def error_of(conserved_variation: np.ndarray, coefficient_tail: np.ndarray) -> np.ndarray:
    """The smaller of two bounds that hold on random muscles.

    In validation/ the variation of the conserved quantity fell short of the true error by 2.5 at most. The tail of the
    coefficients enters the energy squared; near an instability the force follows less well, hence the power 1.5.
    """
    return np.maximum(np.minimum(3.0 * conserved_variation, coefficient_tail**1.5), ROUNDING)
