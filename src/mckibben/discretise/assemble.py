"""Any pointwise function on any mesh -> totals, gradients and tangents; no physics here.

Derivatives are taken at the points (3 x 3 numbers each) and carried to the unknowns by the chain rule; the solution as
a whole is never differentiated. For x = (theta, y), theta = lift + Theta u + C rate(y):

    dx/du = B,   gradient = sum_q w_q dL/dx B,
    tangent = sum_q w_q B^T d2L/dx2 B + Y^T costate d2(rate)/dy2 Y,   costate = C^T (w dL/dtheta)
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from ..lazy import Array, jax, jnp
from ..model.parameters import Parameters
from .mesh import Form, Mesh, values

Pointwise = Callable[[Float[Array, " d"]], Float[Array, " k"]]


class Assembly(NamedTuple):
    """Integrals over the length of k pointwise densities, and their derivatives by the m unknowns."""

    state: Float[Array, "n d"]  #: x = (theta, y) at the points
    totals: Float[Array, " k"]
    gradients: Float[Array, "k m"]
    tangents: Float[Array, "c m m"]  #: one for each row of coefficients


def totals(mesh: Mesh, form: Form, density: Pointwise, u: Float[Array, " m"], p: Parameters) -> Float[Array, " k"]:
    """Integrals alone."""
    return mesh.weights @ jax.vmap(density)(values(mesh, form, u, p))


def derivatives(density: Pointwise, x: Float[Array, " d"]) -> tuple[Array, Array, Array]:
    """Value (k), Jacobian (k, d) and Hessians (k, d, d) of a pointwise density in one nested forward pass."""
    d = x.shape[0]
    unit, (rows, columns) = np.eye(d), np.triu_indices(d)
    pair = np.zeros((d, d), int)  # all of this is constant, so nothing of it is compiled
    pair[rows, columns] = pair[columns, rows] = np.arange(len(rows))

    def along(first: Array, second: Array) -> tuple[Array, Array, Array]:
        (value, slope), (_, bend) = jax.jvp(lambda y: jax.jvp(density, (y,), (first,)), (x,), (second,))
        return value, slope, bend

    value, slope, bend = jax.vmap(along, out_axes=(None, 0, 0))(jnp.asarray(unit[rows]), jnp.asarray(unit[columns]))
    return value, slope[pair.diagonal()].T, jnp.moveaxis(bend[pair], -1, 0)


class Local(NamedTuple):
    """Pointwise derivatives at a state; they know nothing of the unknowns, so several spaces can share them."""

    x: Float[Array, "n d"]
    value: Float[Array, "n k"]
    first: Float[Array, "n k d"]
    second: Float[Array, "n k d d"]
    rate_first: Float[Array, "n y"]
    rate_second: Float[Array, "n y y"]


def localise(form: Form, density: Pointwise, x: Float[Array, "n d"], p: Parameters) -> Local:
    """Derivatives of the densities and of the integrated rate at the points."""
    derived = jax.vmap(lambda at: derivatives(density, at))(x)
    rate = jax.vmap(lambda y: derivatives(lambda z: form.rate(z, p)[None], y))(x[:, 1:])
    return Local(x, *derived, rate[1][:, 0], rate[2][:, 0])


def carry(mesh: Mesh, local: Local, coefficients: Float[Array, "c k"]) -> Assembly:
    """Totals and gradients of all densities, tangents of their combinations by `coefficients`.

    The state need not lie in the mesh's own space: so the tangent of antisymmetric disturbances about a symmetric
    state comes from the same points.
    """
    w, first = mesh.weights, local.first
    angle = mesh.angle + mesh.cumulate @ jnp.einsum("ny,nym->nm", local.rate_first, mesh.fields)
    B = jnp.concatenate([angle[:, None, :], mesh.fields], axis=1)
    gradients = jnp.einsum("n,nkd,ndm->km", w, first, B)
    costate = jnp.einsum("ck,nk,n->cn", coefficients, first[:, :, 0], w) @ mesh.cumulate
    combined = w[:, None, None] * jnp.einsum("ck,nkde->cnde", coefficients, local.second)
    combined = combined.at[:, :, 1:, 1:].add(costate[:, :, None, None] * local.rate_second)
    tangents = jnp.einsum("ndm,cndp->cmp", B, combined @ B)
    return Assembly(local.x, w @ local.value, gradients, tangents)


def assemble(
    mesh: Mesh, form: Form, density: Pointwise, u: Float[Array, " m"], p: Parameters, coefficients: Float[Array, "c k"]
) -> Assembly:
    """Totals, gradients and combined tangents at the unknowns u."""
    return carry(mesh, localise(form, density, values(mesh, form, u, p), p), coefficients)
