"""The largest value of a smooth field along the length, and its exact derivatives.

At the largest point given alone the derivative would be wrong by as much as the maximum lies beside it.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats

__all__ = ["peak"]

STEPS = 5
"""Newton steps before the one that carries the derivative; next to a fitting the first ones are short."""


def peak(field: Float[Array, " q"], harmonics: Floats) -> Float[Array, ""]:
    """Largest value of the field f(t) = sum_k c_k cos(k t), c = harmonics @ field, t from pi at one end to 0.

    f is level at both ends in t, so that a maximum at a fitting is found like one between the points.
    """
    c, k = jnp.asarray(harmonics) @ field, np.arange(float(len(harmonics)))
    grid = np.pi * np.linspace(0.0, 1.0, len(harmonics) + 1)
    values = jnp.asarray(np.cos(np.outer(grid, np.arange(len(harmonics))))) @ c
    start = jnp.asarray(grid)[jnp.argmax(values)]
    room = grid[1]
    level = 1e-9 * jnp.abs(values).max()

    def newton(t: Array, c: Array) -> Array:
        """One step, held between the neighbours; none where the field is level or has no maximum."""
        bend = -(k**2 * jnp.cos(k * t)) @ c
        curved = bend < -level
        step = jnp.where(curved, -(k * jnp.sin(k * t)) @ c / jnp.where(curved, bend, 1.0), 0.0)
        return jnp.clip(t - step, start - room, start + room)

    still = jax.lax.stop_gradient(c)
    t = jax.lax.fori_loop(0, STEPS, lambda _, t: newton(t, still), start)  # a loop compiles sooner than its steps
    return jnp.cos(k * newton(t, c)) @ c  # the last step carries the derivative of the place
