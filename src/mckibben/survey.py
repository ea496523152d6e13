"""What solved states are worth: residual, modes, shape, verdict, and an estimate of their numerical error."""

import attrs
import numpy as np

from .judge import Judgement, judge, shape_of
from .recover import Recovered, recover
from .solver.problem import LENGTH, VOLUME, Problem
from .solver.stability import Modes, count_modes, stiffness


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


def survey(problem: Problem, u: np.ndarray, loads: np.ndarray, held: tuple[str, ...]) -> Survey:
    """Look at states u (n, m) under loads (n, 4), found with `held` controlled."""
    n = len(u)
    size = 1 if n == 1 else max(32, 1 << int(n - 1).bit_length())
    filled = [np.concatenate([rows, np.repeat(rows[-1:], size - n, axis=0)]) for rows in (u, loads)]
    K = stiffness(problem.space, problem.p, problem.b, *filled)
    K = type(K)(*(np.asarray(part)[:n] for part in K))
    modes = count_modes(problem.space, K, pressure_held="volume" not in held)
    recovered = recover(problem, u, loads)
    seen = recovered.fields
    verdicts = [
        judge(modes[k], shape_of(seen["psi"][k], seen["r"][k], seen["z"][k]), "length" in held) for k in range(n)
    ]
    return Survey(
        problem, u, loads, np.asarray(K.totals), imbalance(np.asarray(K.gradients), loads), modes, verdicts, recovered,
        error_estimate(recovered),
    )  # fmt: skip


def imbalance(gradients: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Residual of each state over the sum of the magnitudes of its terms."""
    signs = np.concatenate([np.ones((len(loads), 1)), -loads[:, 1:]], axis=1)
    rest = np.linalg.norm(np.einsum("nk,nkm->nm", signs, gradients), axis=1)
    return np.asarray(rest / np.einsum("nk,nk->n", np.abs(signs), np.linalg.norm(gradients, axis=2)))


def error_estimate(recovered: Recovered) -> np.ndarray:
    """Relative error of force and length to expect: the smaller of two bounds that held on every reference state.

    The variation of the conserved quantity was never below the true error. The tail of the coefficients enters the
    energy squared; near an instability the force follows less well, hence the power 1.5.
    """
    return np.minimum(recovered.conserved_variation, recovered.coefficient_tail**1.5)
