"""Derivatives of a state that is known, by the implicit function theorem.

The state w satisfies R(w; p, targets) = 0: equilibrium and the rows that hold. So

    dw = -(dR/dw)^-1 (dR/dp dp + dR/dtargets dtargets)

however w was found. The placement of points and the units of the quantities are held fixed: the state depends on them
only by its discretisation error.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import place
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.held import conditions
from mckibben.solver.newton import bordered
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns, system

__all__ = ["misses", "settle"]


def misses(
    static: tuple[Basis, Any], p: Parameters, b: Number, state: Unknowns, which: Any, targets: Array
) -> Float[Array, " w"]:
    """R: the gradient of the Lagrangian by the shape, and the misses of the rows; dimensionless."""
    basis, own = static
    on = place(basis, p, b)
    s = system(basis, on, state)
    return jnp.concatenate([s.rest, conditions(own, which, targets, on, s, state.loads).miss])


@partial(jax.custom_jvp, nondiff_argnums=(0,))
def settle(
    static: tuple[Basis, Any], state: Unknowns, p: Parameters, b: Number, which: Any, targets: Float[Array, " l"]
) -> Unknowns:
    """A state, which must be one, as a function of p and targets, differentiable to any order; NaN stays NaN."""
    return state


@settle.defjvp
def _settle_jvp(static: tuple[Basis, Any], primals: Any, tangents: Any) -> tuple[Any, Any]:
    given, p, b, which, targets = primals
    _, dp, _, _, dtargets = tangents
    # Not the given state, which is constant, but the one that depends on p in turn: that gives the higher derivatives.
    state = settle(static, given, p, b, which, targets)
    good = jnp.isfinite(state.u).all() & jnp.isfinite(state.loads).all()
    safe = jax.tree.map(lambda part: jnp.where(good, part, 0.0), state)
    basis, own = static
    on = place(basis, p, b)
    s = system(basis, on, safe)
    matrix = bordered(s, conditions(own, which, targets, on, s, safe.loads))
    matrix = jnp.where(good, matrix, jnp.eye(len(matrix)))
    change = jax.jvp(lambda p, targets: misses(static, p, b, safe, which, targets), (p, targets), (dp, dtargets))[1]
    step = -jnp.linalg.solve(matrix, change)
    m = len(state.u)
    return state, Unknowns(step[:m], step[m:])
