"""How far open the bore of a thick tube is: where rubber fills it, a braid that narrows can be drawn no further."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place, states
from mckibben.model.gap import inflated
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_stretches
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.system import Unknowns

__all__ = ["narrowest_bore"]


@kernel
def narrowest(basis: Basis, p: Parameters, b: Number, state: Unknowns) -> Float[Array, ""]:
    """Least square of the bore's radius over that of the tube's outer face, at the points."""
    on = place(basis, p, b)
    pressure = state.loads[1] * on.unit[0] / on.unit[2]
    assert p.tube is not None
    assert p.tube.across is not None
    solid = 1.0 - p.tube.across

    def open_at(at: Point) -> Number:
        hoop, axial, _ = chamber_stretches(inflated(at, pressure, p), p)
        return 1.0 - solid / (axial * hoop**2)

    return jnp.min(jax.vmap(open_at)(states(basis, on, state.u)))


def narrowest_bore(problem: Problem, u: np.ndarray, loads: np.ndarray) -> float:
    """Radius of the bore over that of the tube's outer face, where that is least in a state; 1 without a thick wall."""
    tube = problem.p.tube
    if tube is None or tube.across is None:
        return 1.0
    square = float(narrowest(problem.basis, problem.p, problem.b, Unknowns(u, loads)))
    return float(np.sqrt(max(square, 0.0)))
