"""How far muscles are from bowing sideways, as columns of their own bending stiffness (theory page, column)."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.model.column import bending_stiffness, column_load
from mckibben.model.parameters import Parameters
from mckibben.model.profile import evened

__all__ = ["left_to_bow"]


@partial(kernel, static_argnums=())
def _loads(
    p: Parameters, length: Float[Array, " n"], force: Float[Array, " n"], pressure: Float[Array, " n"]
) -> Float[Array, " n"]:
    """Push [N] from which each of n cylinders of a length of braid [m] bows; all numbers of p are arrays (n).

    A programmed braid is taken as that of one angle whose fibres are as long.
    """

    def one(p: Parameters, length: Array, force: Array, pressure: Array) -> Array:
        p = evened(p)
        theta = jnp.arcsin(jnp.clip(length * jnp.sin(p.theta0) / p.H0, 0.0, 1.0))
        return column_load(length, bending_stiffness(theta, force, pressure, p))

    return jax.vmap(one)(p, length, force, pressure)


def left_to_bow(p: Parameters, length: np.ndarray, force: np.ndarray, pressure: float) -> np.ndarray:
    """1 + F/F_col of n muscles: 1 without a force, 0 where a push bows them, above 1 where they pull.

    `length` is between the fittings [m]. NaN where a muscle bows without a push, and where there is no state.
    """
    dead = 0.0 if p.dead is None else p.dead
    load = np.asarray(_loads(p, np.asarray(length - dead), force, np.full(len(force), float(pressure))))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(load > 0.0, 1.0 + force / load, np.nan)
