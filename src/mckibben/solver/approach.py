"""From rest to the states of a test in compiled code alone, so that it can be traced, batched and compiled as a whole.

It is quick and not as robust as the search of `solver/path.py`: what it does not reach is NaN.
"""

import numpy as np
from jaxtyping import Float

from ..lazy import Array, jnp
from ..model.energy import scales
from ..model.parameters import Number, Parameters
from ..spec import Step
from .equilibrium import NAMES, selection
from .follow import follow
from .problem import Space

LEG = 10
"""States on each straight leg of the way to the first state of a step."""
CLOSE = 1e-6
"""Last Newton step of a state, whose error is then about its square."""


def units(space: Space, p: Parameters) -> Float[Array, "4"]:
    """Units of `NAMES`: length, volume, force, pressure."""
    energy, length, volume, _ = scales(p, space.law)
    return jnp.stack([length, volume, energy / length, energy / volume])


def targets(step: Step, present: Float[Array, "4"], unit: Float[Array, "4"]) -> Float[Array, "n 2"]:
    """Dimensionless values of what a step holds, state by state, from the present values of `NAMES` on."""
    columns = []
    for name in step.controls:
        path, k = getattr(step, name), NAMES.index(name)
        knots = [jnp.asarray(number, float) / unit[k] for number in path.waypoints]
        knots = [present[k], *knots] if path.needs_present else knots
        columns.append(path.weights(step.points) @ jnp.stack(knots))
    return jnp.stack(columns, axis=1)


def approach(space: Space, p: Parameters, b: Number, steps: tuple[Step, ...]) -> tuple[Float[Array, "_ w"], ...]:
    """States w = (u, force, pressure) of each step; from the first that is not reached on NaN."""
    unit = units(space, p)
    w, have = jnp.zeros(space.basis.unknowns + 2), jnp.array([1.0, 1.0, 0.0, 0.0])
    found = []
    for index, step in enumerate(steps):
        wanted = targets(step, have, unit)
        if index == 0:
            w, have = _pressure_first(space, p, b, w, have, step, wanted)
        select = selection(step.controls)
        lead = _straight(jnp.asarray(select) @ have, wanted[0])
        states, last = _walk(space, p, b, w, select, jnp.concatenate([lead, wanted]))
        found.append(states[LEG:])
        w, have = states[-1], last
    return tuple(found)


def _pressure_first(
    space: Space, p: Parameters, b: Number, w: Array, have: Array, step: Step, wanted: Array
) -> tuple[Array, Array]:
    """Pressure before length or force: it stretches the braid, which would fold if it were compressed without."""
    names = step.controls
    axial = "length" if "length" in names else "force"
    top = wanted[:, names.index("pressure")].max() if "pressure" in names else jnp.ones(())
    end = wanted[0, names.index(axial)] if axial in names else have[NAMES.index(axial)]
    select = selection((axial, "pressure"))
    first, above, aside = jnp.asarray(select) @ have, jnp.stack([have[NAMES.index(axial)], top]), jnp.stack([end, top])
    way = jnp.concatenate([_straight(first, above), _straight(above, aside), aside[None]])
    states, last = _walk(space, p, b, w, select, way)
    return states[-1], last


def _straight(start: Array, end: Array) -> Array:
    """`LEG` points from the start on, the end left out."""
    return start + jnp.linspace(0.0, 1.0, LEG, endpoint=False)[:, None] * (end - start)


def _walk(space: Space, p: Parameters, b: Number, w: Array, select: np.ndarray, way: Array) -> tuple[Array, Array]:
    """States along a way that begins where w is; NaN beyond the part reached. Also the last values of `NAMES`."""
    n = way.shape[0]
    track = follow(space, p, b, w, jnp.asarray(select), way, jnp.asarray(n), jnp.asarray(CLOSE))
    states = jnp.where((jnp.arange(n) < track.good)[:, None], track.w, jnp.nan)
    return states, jnp.concatenate([track.values[-1], states[-1, -2:]])
