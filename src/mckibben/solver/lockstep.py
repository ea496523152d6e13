"""The equations of `problem` arranged for speed, to be mapped over muscles that advance in step.

What does not depend on the muscle is a constant matrix, so that over many muscles the work is a few matrix products;
sines and cosines are computed once; one symmetric factorisation gives the Newton step, the tangents for the next guess
and the stability of the state. With A = d theta/du, which is swept over the length from turn = d theta'/dpsi:

    gradient = A^T (w L_theta) + Psi^T (w L_psi) + Psi'^T (w L_kappa),   A = C diag(turn) Psi
"""

from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from ..discretise.line import Line
from ..lazy import Array, jax, jnp
from ..model.angle import Known, slope
from ..model.energy import scales, stored
from ..model.kinematics import angle_rate, height_rate, volume_rate
from ..model.parameters import Law, Number, Parameters

LOADS = 2
"""Unknowns beside the shape's: force and pressure."""
HEAVY = 1e3
"""Stiffness of what holds a value over the sum of all others: enough for any stable state, and costs three digits."""


WORK, MOST, MANY = 200_000, 64, 1024
"""On processors jaxlib hands a batch of factorisations of WORK or more operations to the threads on which the program
itself runs, which then wait for each other: it was seen to stop for ever. Nor do more than MOST muscles fit in the
cache. Other devices take MANY."""


def batch_size(unknowns: int) -> int:
    """How many muscles advance in step: a power of two."""
    if jax.default_backend() != "cpu":
        return MANY
    return int(np.clip(2 ** np.floor(np.log2(0.99 * WORK / (unknowns**3 / 3.0))), 1, MOST))


class Constants(NamedTuple):
    """A line's operators and their products, the same for every muscle."""

    weights: Float[np.ndarray, " q"]
    shape: Float[np.ndarray, "q m"]  #: psi by unknowns
    slope: Float[np.ndarray, "q m"]  #: d psi/dx by unknowns
    lift: Float[np.ndarray, "q m"]  #: theta by the unknown angle of a free end
    cumulate: Float[np.ndarray, "q q"]
    swept: Float[np.ndarray, "q qm"]  #: integral of f shape, by f at the points
    squares: Float[np.ndarray, "3q mm"]  #: shape shape, shape slope (both ways round), slope slope


@lru_cache(maxsize=16)
def constants(line: Line) -> Constants:
    """Operators of a half line."""
    on = line.constants()
    spare = np.zeros((len(on.x), line.unknowns - line.size))
    shape, slope = np.hstack([on.shape, spare]), np.hstack([on.slope, spare])
    lift = np.hstack([np.zeros_like(on.shape), spare + 1.0])
    q, m = shape.shape
    mixed = np.einsum("qa,qb->qab", shape, slope)
    squares = [
        np.einsum("qa,qb->qab", shape, shape),
        mixed + mixed.transpose(0, 2, 1),
        np.einsum("qa,qb->qab", slope, slope),
    ]
    swept = np.einsum("kj,jm->jkm", on.cumulate, shape).reshape(q, q * m)
    return Constants(
        2.0 * on.weights, shape, slope, lift, on.cumulate, swept, np.concatenate(squares).reshape(3 * q, m * m)
    )


class Design(NamedTuple):
    """One muscle's numbers: parameters (the braid angle `Known`), units of the quantities, dv/dx at the points."""

    p: Parameters
    unit: Float[Array, " 4"]
    jacobian: Float[Array, " q"]


def design(line: Line, law: Law, p: Parameters, b: Number) -> Design:
    """Numbers of a muscle on a line with points crowded by b."""
    known: Any = Known.of(p.theta0)
    return Design(p._replace(theta0=known), scales(p, law), jnp.asarray(line.jacobian(p, b)))


class Sample(NamedTuple):
    """A shape at the points."""

    theta: Known
    psi: Known
    kappa: Float[Array, " q"]


def sample(line: Line, d: Design, w: Float[Array, " w"]) -> Sample:
    """The shape of the unknowns w = (u, force, pressure)."""
    on, u = constants(line), w[:-LOADS]
    psi = Known.of(on.shape @ u)
    theta = d.p.theta0.value + on.lift @ u + on.cumulate @ (d.jacobian * angle_rate(psi, d.p))
    kappa = jnp.asarray(on.slope) @ u / d.jacobian
    return Sample(Known.of(theta), psi, kappa)


class System(NamedTuple):
    """Stiffness (m, m), imbalance (m), gradients of length and volume (2, m) and their values (2)."""

    stiffness: Array
    rest: Array
    gradients: Array
    values: Array


def _lagrangian(theta: Known, psi: Known, kappa: Number, F: Number, P: Number, d: Design, law: Law) -> Number:
    energy = stored(theta, psi, kappa, d.p, law) / d.unit[0]
    return energy - F * height_rate(theta, psi, d.p) / d.unit[1] - P * volume_rate(theta, psi, d.p) / d.unit[2]


def _slopes(law: Law, d: Design, F: Number, P: Number, at: Sample) -> tuple[Any, Any]:
    """First and second derivatives of the Lagrangian's density by (theta, psi, kappa) at one point."""

    def density(theta: Number, psi: Number, kappa: Number) -> Number:
        return _lagrangian(at.theta._replace(value=theta), at.psi._replace(value=psi), kappa, F, P, d, law)

    x = (at.theta.value, at.psi.value, at.kappa)
    first, change = jax.linearize(jax.grad(density, (0, 1, 2)), *x)
    second = [change(*(jnp.full_like(x[k], i == k) for k in range(3))) for i in range(3)]
    return list(first), [list(second[i][i:]) for i in range(3)]


def _constrained(d: Design, at: Sample) -> Array:
    """Densities of length and volume and their derivatives by theta and psi at one point: (2, 3)."""

    def row(rate: Any, unit: Number) -> Array:
        def density(theta: Number, psi: Number) -> Number:
            return rate(at.theta._replace(value=theta), at.psi._replace(value=psi), d.p) / unit

        value, slope = jax.value_and_grad(density, (0, 1))(at.theta.value, at.psi.value)
        return jnp.stack([value, *slope])

    return jnp.stack([row(height_rate, d.unit[1]), row(volume_rate, d.unit[2])])


class Local(NamedTuple):
    """Pointwise derivatives times the quadrature weights: they serve every space on the same points."""

    first: Float[Array, "3 q"]  #: of the Lagrangian by theta, psi, kappa
    second: tuple[Array, ...]  #: by theta theta, theta psi, theta kappa, psi psi, psi kappa, kappa kappa: (q) each
    held: Float[Array, "2 3 q"]  #: length and volume: densities, and derivatives by theta and psi
    turn: Float[Array, " q"]  #: derivative of theta' by psi, times dv/dx
    bend: Float[Array, " q"]  #: its second derivative


def localise(line: Line, law: Law, d: Design, loads: Array, at: Sample) -> Local:
    """Derivatives of a shape under loads (force, pressure)."""
    weight = jnp.asarray(constants(line).weights) * d.jacobian

    def rate(psi: Known) -> Number:
        return angle_rate(psi, d.p)

    turn = d.jacobian * jax.vmap(partial(slope, rate))(at.psi)
    bend = d.jacobian * jax.vmap(partial(slope, partial(slope, rate)))(at.psi)
    first, second = jax.vmap(partial(_slopes, law, d, loads[0], loads[1]))(at)
    held = weight * jnp.moveaxis(jax.vmap(partial(_constrained, d))(at), 0, -1)
    return Local(
        jnp.stack([weight * f for f in first]), tuple(weight * f for row in second for f in row), held, turn, bend
    )


def stiffness(on: Constants, d: Design, local: Local) -> Float[Array, "m m"]:
    """Second derivatives of the Lagrangian by the unknowns of a space."""
    (q, m), J = on.shape.shape, d.jacobian
    tt, tp, tk, pp, pk, kk = local.second
    costate = local.first[0] @ on.cumulate
    own = jnp.concatenate([pp + local.bend * costate, pk / J, kk / J**2])
    angle = (local.turn @ on.swept).reshape(q, m) + on.lift
    side = 0.5 * tt[:, None] * angle + tp[:, None] * on.shape + (tk / J)[:, None] * on.slope
    mixed = angle.T @ side
    return (own @ on.squares).reshape(m, m) + mixed + mixed.T


def system(line: Line, law: Law, d: Design, w: Array, at: Sample) -> System:
    """The equations at w, whose shape is `at`."""
    return assemble(constants(line), d, localise(line, law, d, w[-LOADS:], at))


def assemble(on: Constants, d: Design, local: Local) -> System:
    """The equations from their pointwise derivatives."""
    by_theta, by_psi, by_kappa = local.first
    swept = local.turn * (by_theta @ on.cumulate)
    rest = (by_psi + swept) @ on.shape + (by_kappa / d.jacobian) @ on.slope + by_theta @ on.lift
    held = local.held
    gradients = (held[:, 2] + local.turn * (held[:, 1] @ on.cumulate)) @ on.shape + held[:, 1] @ on.lift
    return System(stiffness(on, d, local), rest, gradients, held[:, 0].sum(axis=1))


def residual(s: System, w: Array) -> Array:
    """Imbalance over the size of its terms (as in `trust`); the compiler leaves out the unused stiffness."""
    loads = w[-LOADS:]
    energy = s.rest + loads @ s.gradients
    size = jnp.linalg.norm(energy) + jnp.abs(loads) @ jnp.linalg.norm(s.gradients, axis=1)
    return jnp.linalg.norm(s.rest) / size


class Correction(NamedTuple):
    """A Newton step (w), the change of w by each of the two held values (w, 2), and whether the state is a minimum."""

    step: Array
    tangents: Array
    stable: Array


def correct(s: System, w: Array, select: Array, targets: Array) -> Correction:
    """Solve the bordered system K du - G^T dl = -rest, select (G du, dl) = targets - held, by one Cholesky factor.

    K plus the held gradients' squares, weighted heavily, is positive definite where K is on what the held values leave
    free.
    """
    A, on_loads = select[:, :2] @ s.gradients, select[:, 2:]
    miss = select @ jnp.concatenate([s.values, w[-2:]]) - targets
    size = HEAVY * jnp.trace(jnp.abs(s.stiffness)) / jnp.maximum(jnp.sum(A**2), 1e-30)
    factor = jnp.linalg.cholesky(s.stiffness + size * A.T @ A)
    stable = jnp.isfinite(factor).all()
    sides = jnp.concatenate([s.rest[:, None], s.gradients.T], axis=1)
    solved = jax.scipy.linalg.cho_solve((factor, True), sides)
    y, Y = solved[:, 0], solved[:, 1:]
    # du = Y dl - y - size Y_A c with c = miss, or minus a unit vector for a tangent
    YA = size * Y @ select[:, :2].T
    small = A @ Y + on_loads
    c = jnp.concatenate([miss[:, None], -jnp.eye(2)], axis=1)
    lead = jnp.concatenate([y[:, None], jnp.zeros((len(y), 2))], axis=1)
    (a, b), (e, f) = small
    right = A @ (lead + YA @ c) - c
    det = a * f - b * e
    dl = jnp.stack([f * right[0] - b * right[1], a * right[1] - e * right[0]]) / det
    du = Y @ dl - lead - YA @ c
    both = jnp.concatenate([du, dl])
    return Correction(both[:, 0], both[:, 1:], stable)
