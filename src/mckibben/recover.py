"""From a solution to what a lab wants to know: fibre tension, load sharing, energies, and how far to trust it.

Pointwise formulas are derived on the theory page. With w_f(theta, theta', psi, kappa) the fibre energy per unit v, in
which u1 = sin(theta0) theta' - cos(theta0) sin(psi)/R0 keeps its two parts apart, w_c(r, s) that of the chamber and p
the costate of theta:

    q = -(p - dw_f/dtheta') cos(theta0) / (R0 sin(theta))
    N T sin(theta) = (F + pi r^2 P) cos(psi) + q sin(psi) - dw_c/ds
                     - [dw_f/dtheta - (dw_f/dtheta')'] sin(theta0) cos(theta)
"""

import attrs
import numpy as np
from jaxtyping import Float

from .kernel import kernel
from .lazy import Array, jax, jnp
from .model.angle import cos, sin, slope
from .model.chamber import chamber_density
from .model.energy import stored
from .model.fibres import fibre_densities
from .model.kinematics import (
    angle_rate,
    fibre_strains,
    height_rate,
    radius,
    stretches,
    volume_rate,
)
from .model.parameters import Law, Number, Parameters
from .solver.problem import Problem, Space

ENERGIES = ("bending_1", "bending_2", "twist", "chamber")
"""The parts of the stored energy, in the order in which they are kept."""
NODES = 129
"""Output points along the length, crowded at the fittings like the mesh, where the fields vary most."""


def _lagrangian(theta: Number, psi: Number, kappa: Number, F: Number, P: Number, p: Parameters, law: Law) -> Number:
    return stored(theta, psi, kappa, p, law) - F * height_rate(theta, psi, p) - P * volume_rate(theta, psi, p)


def tension(
    theta: Number, psi: Number, kappa: Number, costate: Number, F: Number, P: Number, p: Parameters, law: Law
) -> Number:
    """Tension T [N] of one fibre, the multiplier of inextensibility."""
    sine, cosine = sin(p.theta0), cos(p.theta0)
    u1 = fibre_strains(theta, psi, kappa, p)[0]
    by_rate, by_rate_dv = p.N * p.B1 * u1, -2.0 * p.N * p.B1 * cosine / p.R0 * cos(psi) * kappa
    by_theta = slope(lambda t: sum(fibre_densities(t, psi, kappa, p)), theta)
    q = -(costate - by_rate) * cosine / (p.R0 * sin(theta))
    axial = F + jnp.pi * radius(theta, p) ** 2 * P
    along = axial * cos(psi) + q * sin(psi) - chamber_pull(theta, p, law)
    return (along - (by_theta - by_rate_dv) * sine * cos(theta)) / (p.N * sin(theta))


def conserved(
    theta: Number, psi: Number, kappa: Number, costate: Number, F: Number, P: Number, p: Parameters, law: Law
) -> tuple[Number, Number]:
    """p theta' + kappa dL/dkappa - L [J/m], the same all along the length, and the sum of its terms' magnitudes."""
    by_kappa = jax.grad(_lagrangian, argnums=2)(theta, psi, kappa, F, P, p, law)
    parts = (costate * angle_rate(psi, p), kappa * by_kappa, -_lagrangian(theta, psi, kappa, F, P, p, law))
    return sum(parts), jnp.abs(parts[0]) + jnp.abs(parts[1]) + jnp.abs(parts[2])


def chamber_pull(theta: Number, p: Parameters, law: Law) -> Number:
    """Meridian force of the chamber [N], A0 d(psi)/d(lambda2) at fixed hoop stretch."""
    hoop, axial, _ = stretches(theta, p)
    return p.A0 * jax.grad(lambda a: law(hoop, a, 1.0 / (hoop * a), p.law))(axial)


def _fields(
    theta: Number, psi: Number, kappa: Number, costate: Number, F: Number, P: Number, p: Parameters, law: Law
) -> dict[str, Number]:
    bending1, bending2, twist = fibre_densities(theta, psi, kappa, p)
    hoop, axial, thickness = stretches(theta, p)
    u1, u2, u3 = fibre_strains(theta, psi, kappa, p)
    kept, size = conserved(theta, psi, kappa, costate, F, P, p, law)
    chamber_axial = chamber_pull(theta, p, law) * jnp.cos(psi)
    total_axial = F + jnp.pi * radius(theta, p) ** 2 * P
    return {
        "theta": theta, "psi": psi, "r": radius(theta, p),
        "stretch_hoop": hoop, "stretch_axial": axial, "stretch_thickness": thickness,
        "u1": u1, "u2": u2, "u3": u3,
        "density_bending_1": bending1, "density_bending_2": bending2, "density_twist": twist,
        "density_fibres": bending1 + bending2 + twist, "density_chamber": chamber_density(theta, p, law),
        "fibre_tension": tension(theta, psi, kappa, costate, F, P, p, law),
        "share_chamber": chamber_axial / total_axial, "share_mesh": 1.0 - chamber_axial / total_axial,
        "conserved": kept, "conserved_size": size,
        "height_rate": height_rate(theta, psi, p),
    }  # fmt: skip


@kernel
def fields(
    law: Law,
    p: Parameters,
    theta: Float[Array, "n q"],
    psi: Float[Array, "n q"],
    kappa: Float[Array, "n q"],
    costate: Float[Array, "n q"],
    F: Float[Array, " n"],
    P: Float[Array, " n"],
) -> dict[str, Float[Array, "n q"]]:
    """Every pointwise field of n states at q points."""
    along = jax.vmap(_fields, (0, 0, 0, 0, None, None, None, None))
    return jax.vmap(along, (0, 0, 0, 0, 0, 0, None, None))(theta, psi, kappa, costate, F, P, p, law)


@kernel
def angle_force(
    law: Law,
    p: Parameters,
    theta: Float[Array, "n q"],
    psi: Float[Array, "n q"],
    kappa: Float[Array, "n q"],
    F: Float[Array, " n"],
    P: Float[Array, " n"],
) -> Float[Array, "n q"]:
    """dL/dtheta at the points, whose integral is the costate: p' = dL/dtheta."""
    along = jax.vmap(jax.grad(_lagrangian), (0, 0, 0, None, None, None, None))
    return jax.vmap(along, (0, 0, 0, 0, 0, None, None))(theta, psi, kappa, F, P, p, law)


@attrs.frozen
class Recovered:
    """What n states on one problem look like: fields (n, nodes), energies [J] (n) and measures of trust (n)."""

    v: np.ndarray
    fields: dict[str, np.ndarray]
    energies: dict[str, np.ndarray]
    conserved_variation: np.ndarray
    coefficient_tail: np.ndarray


def recover(problem: Problem, u: np.ndarray, loads: np.ndarray) -> Recovered:
    """Fields and energies of states u (n, m) under dimensionless loads (n, 4)."""
    n, basis, p, b, law = len(u), problem.space.basis, problem.p, problem.b, problem.space.law
    u, loads = pad(u), pad(loads)
    F, P = loads[:, 1] * problem.load_unit[1], loads[:, 2] * problem.load_unit[2]
    inner, outer = basis.profile(p, b, u), basis.profile(p, b, u, NODES)
    theta, psi, kappa = (np.concatenate(pair, axis=1) for pair in zip(inner, outer, strict=True))
    slope = np.asarray(angle_force(law, p, *inner, F, P))
    integral = np.concatenate([basis.integral(p, b, slope), basis.integral(p, b, slope, NODES)], axis=1)
    # p is zero at mid-length of a symmetric state; where equal radii are a constraint it is its multiplier at v = H0
    if basis.closes:
        costate = integral - integral[:, -1:] + loads[:, 3:4] * problem.unit[0]
    else:
        costate = integral - basis.integral(p, b, slope, 3)[:, 1:2]
    found = {k: np.asarray(f) for k, f in fields(law, p, theta, psi, kappa, costate, F, P).items()}
    q = problem.mesh.v.size
    energies = {name: (found[f"density_{name}"][:, :q] @ problem.mesh.weights)[:n] for name in ENERGIES}
    conserved, size = found.pop("conserved"), found.pop("conserved_size").max(axis=1)
    mean = conserved.mean(axis=1, keepdims=True)
    weight = np.concatenate([problem.mesh.weights / problem.mesh.weights.sum(), np.zeros(NODES)])
    weight[[q, -1]] = 0.5 / q  # the fittings count like a point of the mesh
    variation = np.sqrt((conserved - mean) ** 2 @ weight / weight.sum()) / np.maximum(size, 1e-300)
    z = basis.integral(p, b, found.pop("height_rate")[:, :q], NODES)
    at_nodes = {k: f[:n, q:] for k, f in found.items()} | {"z": z[:n]}
    coefficients = np.abs(u[:n, : basis.size])
    tail = coefficients[:, -2:].max(axis=1) / np.maximum(coefficients.max(axis=1), 1e-12)
    return Recovered(basis.nodes(p, b, NODES), at_nodes, energies, variation[:n], tail)


def prepare(space: Space, p: Parameters, b: float, count: int) -> None:
    """Have what `recover` calls for `count` states compiled in the background (see `kernel`)."""
    n, q = len(pad(np.empty(count))), space.basis.points
    inner, every, load = np.empty((n, q)), np.empty((n, q + NODES)), np.empty(n)
    angle_force.prepare(space.law, p, inner, inner, inner, load, load)
    fields.prepare(space.law, p, every, every, every, every, load, load)


def pad(rows: np.ndarray) -> np.ndarray:
    """Rows repeated up to 1 or a power of two from 32, so that few shapes are compiled."""
    size = 1 if len(rows) == 1 else max(32, 1 << int(len(rows) - 1).bit_length())
    return np.concatenate([rows, np.repeat(rows[-1:], size - len(rows), axis=0)])
