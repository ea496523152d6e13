"""Rows of results filled in a loop, whose body is traced once."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

from mckibben.compiled.arrays import Array

__all__ = ["filled"]


def filled(at: Callable[[Array], Any], count: Array, room: int) -> Any:
    """What `at` gives for 0 .. count - 1, one after another along the leading dimension; zeros beyond, up to `room`."""
    # Inlined, so the same program: but JAX knows it when the loop asks for what telling its shapes has traced already.
    once = jax.jit(at, inline=True)
    blank = jax.tree.map(lambda s: jnp.zeros((room, *s.shape[1:]), s.dtype), jax.eval_shape(once, 0))

    def put(k: Array, rows: Any) -> Any:
        return jax.tree.map(
            lambda row, new: jax.lax.dynamic_update_slice_in_dim(row, new, k * len(new), 0), rows, once(k)
        )

    return jax.lax.fori_loop(0, count, put, blank)
