"""What tests read off states: fields, energies and shapes, by the package's one reading."""

from functools import partial
from typing import Any, NamedTuple

import jax
import numpy as np

from mckibben.discretise.fields import place, points_at
from mckibben.measure.read import ENERGIES
from mckibben.measure.survey import survey
from mckibben.model.angle import radians
from mckibben.model.parameters import Parameters
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.problem import Problem


class Recovered(NamedTuple):
    """One state, each array with a leading dimension of 1."""

    v: np.ndarray
    fields: dict[str, np.ndarray]
    energies: dict[str, np.ndarray]
    conserved_variation: np.ndarray
    error: np.ndarray


def recovered(state: Equilibrium) -> Recovered:
    """Everything of a state."""
    seen = survey(state.problem, state.u[None], state.loads[None], ("length", "pressure"))
    energies = {name: seen.numbers[f"energy_{name}"] for name in ENERGIES}
    return Recovered(seen.v, seen.fields, energies, seen.numbers["conserved_variation"], seen.error)


@partial(jax.jit, static_argnums=(0, 1))
def _along(basis: Any, count: int, p: Parameters, b: float, u: np.ndarray) -> Any:
    point = points_at(basis, place(basis, p, b), u, basis.sampling(count))
    return radians(point.theta), radians(point.psi), point.kappa


def profile(problem: Problem, u: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta, psi and kappa at output points, those of a half line on its half."""
    theta, psi, kappa = (np.asarray(part) for part in _along(problem.basis, count, problem.p, problem.b, u))
    return theta, psi, kappa
