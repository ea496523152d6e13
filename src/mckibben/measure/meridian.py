"""The meridian of states at many points along the length, for the judgement of their shapes."""

import jax.numpy as jnp
import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import place, points_at, states
from mckibben.model.angle import radians
from mckibben.model.kinematics import height_rate, radius
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.problem import Basis, Problem

__all__ = ["meridian"]

POINTS = 1001
"""Points over the full length, dense at the fittings: a wall that touches itself shows between them."""


def meridian(problem: Problem, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slope [rad], radius and height [m] of states u (n, m), arrays (n, POINTS)."""
    if not len(u):
        return (np.zeros((0, POINTS)),) * 3
    lines = [meridians(problem.basis, problem.p, problem.b, one) for one in u]
    psi, r, z = (np.stack([np.asarray(line[k]) for line in lines]) for k in range(3))
    if not problem.basis.half:
        return psi, r, z
    back = slice(-2, None, -1)
    return (
        np.concatenate([psi, -psi[:, back]], axis=1),
        np.concatenate([r, r[:, back]], axis=1),
        np.concatenate([z, 2.0 * z[:, -1:] - z[:, back]], axis=1),
    )


@kernel
def meridians(basis: Basis, p: Parameters, b: Number, u: Array) -> tuple[Number, Number, Number]:
    """Of one state, on the first half of a symmetric one."""
    on = place(basis, p, b)
    sampling = basis.sampling(POINTS // 2 + 1 if basis.half else POINTS)
    at = points_at(basis, on, u, sampling)
    rate = height_rate(states(basis, on, u), on.p)
    return radians(at.psi), radius(at, on.p), jnp.asarray(sampling.integral) @ (on.jacobian * rate)
