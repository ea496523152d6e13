"""The meridian of states at many points along the length: for the judgement of their shapes, and for r(z)."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place, points_at, states
from mckibben.measure.read import nodes
from mckibben.model.angle import radians
from mckibben.model.kinematics import height_rate, radius
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.problem import Basis, Problem

__all__ = ["LINE", "meridian", "meridians_of", "mirrored", "radii_at"]

POINTS = 1001
"""Points over the full length, dense at the fittings: a wall that touches itself shows between them."""
LINE = ("psi", "r", "z")
"""What a meridian is: slope [rad], radius and height [m]."""
BEYOND = 1e-6
"""Share of the height by which a place may lie beyond an end, as rounding has it."""


def meridian(problem: Problem, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slope [rad], radius and height [m] of states u (n, m), arrays (n, POINTS)."""
    if not len(u):
        return (np.zeros((0, POINTS)),) * 3
    lines = [meridians(problem.basis, problem.p, problem.b, one) for one in u]
    psi, r, z = (np.stack([np.asarray(line[k]) for line in lines]) for k in range(3))
    return mirrored(psi, r, z) if problem.basis.half else (psi, r, z)


def mirrored(psi: np.ndarray, r: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Over the full length, from the first halves (..., points) of symmetric states."""
    back = slice(-2, None, -1)
    return (
        np.concatenate([psi, -psi[..., back]], axis=-1),
        np.concatenate([r, r[..., back]], axis=-1),
        np.concatenate([z, 2.0 * z[..., -1:] - z[..., back]], axis=-1),
    )


@kernel
def meridians(basis: Basis, p: Parameters, b: Number, u: Array) -> tuple[Number, Number, Number]:
    """Of one state, on the first half of a symmetric one."""
    return _line(basis, POINTS // 2 + 1 if basis.half else POINTS, place(basis, p, b), u)


@kernel
def meridians_of(basis: Basis, on: Placed, u: Float[Array, "batch m"]) -> tuple[Number, Number, Number]:
    """Of one state of each muscle, at the output points of a result, on the first half of symmetric ones."""
    return jax.vmap(partial(_line, basis, nodes(basis)))(on, u)


def _line(basis: Basis, count: int, on: Placed, u: Array) -> tuple[Number, Number, Number]:
    sampling = basis.sampling(count)
    at = points_at(basis, on, u, sampling)
    rate = height_rate(states(basis, on, u), on.p)
    return radians(at.psi), radius(at, on.p), jnp.asarray(sampling.integral) @ (on.jacobian * rate)


def radii_at(psi: np.ndarray, r: np.ndarray, z: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Radius [m] at heights `places` [m] of one meridian over the full length: its cubic Hermite interpolant.

    NaN where there is no such height, and all along where the wall turns back, so that r is no function of z.
    """
    from scipy.interpolate import CubicHermiteSpline

    if not (np.abs(psi) < 0.5 * np.pi).all() or not (np.diff(z) > 0.0).all():
        return np.full(len(places), np.nan)
    ends = np.clip(places, z[0], z[-1])
    known = np.abs(places - ends) <= BEYOND * (z[-1] - z[0])
    return np.where(known, CubicHermiteSpline(z, r, np.tan(psi))(ends), np.nan)
