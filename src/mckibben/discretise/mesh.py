"""What an assembler needs to know of a discretisation, and nothing of its making.

At every quadrature point the state is x = (theta, y): y are fields linear in the unknowns u, theta is linear in u plus
the integral of a pointwise rate of y:

    y = Y u,    theta = lift + Theta u + C rate(y)

The spectral line has y = (psi, psi') and integrates theta' = rate(psi); the B-spline has theta itself linear and no
integral. A further field is one more row of Y; a free end is one more column of Theta.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from jaxtyping import Float

from ..lazy import Array, jax, jnp
from ..model.parameters import Number, Parameters


class Mesh(NamedTuple):
    """Operators of one discretisation at n points with d - 1 fields y and m unknowns u."""

    v: Float[Array, " n"]  #: material coordinate of the points [m]
    weights: Float[Array, " n"]  #: quadrature over the full length [m]
    fields: Float[Array, "n y m"]  #: Y
    angle: Float[Array, "n m"]  #: Theta
    lift: Float[Array, " n"]  #: theta without unknowns [rad]
    cumulate: Float[Array, "n n"]  #: C: integral from v = 0 to each point [m]


class Form(NamedTuple):
    """How the local fields of a discretisation give the state of the energy."""

    state: Callable[[Number, Any, Parameters], tuple[Number, Number, Number]]
    """(theta, y, p) -> (theta, psi, kappa)."""
    rate: Callable[[Any, Parameters], Number]
    """(y, p) -> the part of theta' that is integrated."""


def values(mesh: Mesh, form: Form, u: Float[Array, " m"], p: Parameters) -> Float[Array, "n d"]:
    """x = (theta, y) at the points."""
    y = mesh.fields @ u
    theta = mesh.lift + mesh.angle @ u + mesh.cumulate @ jax.vmap(form.rate, (0, None))(y, p)
    return jnp.concatenate([theta[:, None], y], axis=1)
