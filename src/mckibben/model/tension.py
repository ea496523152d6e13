"""Fibre tension and the conserved quantity, pointwise (derived on the theory page).

With w_f(theta, theta', psi, kappa) the fibre energy per unit v, in which u1 = sin(theta0) theta' - cos(theta0)
sin(psi)/R0 keeps its two parts apart, w_c(r, s) that of the chamber and p the costate of theta (p' = dL/dtheta):

    q = -(p - dw_f/dtheta') cos(theta0) / (R0 sin(theta))
    N T sin(theta) = (F + pi r^2 P) cos(psi) + q sin(psi) - dw_c/ds
                     - [dw_f/dtheta - (dw_f/dtheta')'] sin(theta0) cos(theta)

Where crossings rub, dw_f/dtheta gains what they resist with.

Fibres that roll have a dw_f/dtheta' that depends on kappa, phi and phi': its derivative needs psi'' and phi'', which
follow from equilibrium, (dL/dkappa)' = dL/dpsi - p d(theta')/dpsi and (dL/dphi')' = dL/dphi.
"""

from functools import reduce
from typing import Any

import jax
import jax.numpy as jnp

from mckibben.model.angle import cos, radians, sin, slope
from mckibben.model.energy import lagrangian
from mckibben.model.fibres import axial_force, fibre_densities
from mckibben.model.friction import pull
from mckibben.model.kinematics import (
    angle_rate,
    fibre_strains,
    meridian_stretch,
    radius,
    stretch_rate,
    volume_rate,
)
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_pull

__all__ = ["conserved", "tension"]


def tension(
    at: Point, costates: tuple[Number, ...], F: Number, P: Number, p: Parameters, memory: Any = None
) -> Number:  # fmt: skip
    """Tension T [N] of one fibre at force F [N] and pressure P [Pa], from the costates of what is integrated.

    Of a fibre that stretches it is what its law gives; else it is the multiplier of inextensibility.
    """
    if at.stretch is not None:
        return axial_force(at, p)
    (costate,), sine, cosine = costates, sin(p.theta0), cos(p.theta0)
    by_rate, by_rate_dv = _by_rate(at, costate, F, P, p)
    by_theta = slope(lambda t: sum(fibre_densities(at._replace(theta=t), p)), at.theta)
    by_theta = by_theta if memory is None else by_theta + pull(at, p, memory)
    q = -(costate - by_rate) * cosine / (p.R0 * sin(at.theta))
    axial = F + jnp.pi * radius(at, p) ** 2 * P
    held = (
        axial * cos(at.psi) if at.blown is None else F * cos(at.psi) + P * volume_rate(at, p) / meridian_stretch(at, p)
    )
    along = held + q * sin(at.psi) - chamber_pull(at, p)
    return (along - (by_theta - by_rate_dv) * sine * cos(at.theta)) / (p.N * sin(at.theta))


def _by_rate(at: Point, costate: Number, F: Number, P: Number, p: Parameters) -> tuple[Number, Number]:
    """dw_f/dtheta' [N m] and its derivative by v [N]."""
    if at.roll is None:
        u1 = fibre_strains(at, p)[0]
        once, twice = p.N * p.B1 * u1, -2.0 * p.N * p.B1 * cos(p.theta0) / p.R0 * cos(at.psi) * at.kappa
        if p.stiffening is None:
            return once, twice
        n, share = p.stiffening.exponent, (u1 / p.stiffening.curvature) ** (p.stiffening.exponent - 2)
        return once * (1.0 + share), twice * (1.0 + (n - 1) * share)
    (theta, psi, phi), rates = _plain(at), (at.kappa, at.roll_rate)

    def moments(theta: Number, psi: Number, kappa: Number, phi: Number, phi_rate: Number) -> tuple[Number, ...]:
        """dw_f/dtheta', and dL/dkappa and dL/dphi', whose derivatives by v are known from equilibrium."""

        def bent(excess: Number) -> Number:
            return sum(fibre_densities(Point(theta, psi, kappa, None, excess, phi, phi_rate), p))

        def loaded(kappa: Number, phi_rate: Number) -> Number:
            return lagrangian(Point(theta, psi, kappa, roll=phi, roll_rate=phi_rate), p, F, P)

        return jax.grad(bent)(0.0 * theta), *jax.grad(loaded, (0, 1))(kappa, phi_rate)

    def potential(psi: Number, phi: Number) -> Number:
        turned = at._replace(theta=theta, psi=psi, roll=phi)
        return lagrangian(turned, p, F, P) - costate * angle_rate(turned, p)

    values, change = jax.linearize(moments, theta, psi, rates[0], phi, rates[1])
    zero, one = jnp.zeros_like(theta), jnp.ones_like(theta)
    known = change(angle_rate(at, p), at.kappa, zero, at.roll_rate, zero)
    by_kappa, by_phi_rate = change(zero, zero, one, zero, zero), change(zero, zero, zero, zero, one)
    turns = jax.grad(potential, (0, 1))(psi, phi)
    (a, b), (c, d) = (by_kappa[1], by_phi_rate[1]), (by_kappa[2], by_phi_rate[2])
    x, y = turns[0] - known[1], turns[1] - known[2]
    bend, twist = (d * x - b * y) / (a * d - b * c), (a * y - c * x) / (a * d - b * c)  # psi'' and phi''
    return values[0], known[0] + by_kappa[0] * bend + by_phi_rate[0] * twist


def _plain(at: Point) -> tuple[Number, Number, Number]:
    return radians(at.theta), radians(at.psi), radians(at.roll)


def conserved(at: Point, costates: tuple[Number, ...], F: Number, P: Number, p: Parameters) -> tuple[Number, Number]:
    """The sum of costates times rates, kappa dL/dkappa and phi' dL/dphi' less L [J/m], the same all along the length,
    and the sum of its terms' magnitudes."""  # fmt: skip

    def of_kappa(kappa: Number) -> Number:
        return lagrangian(at._replace(kappa=kappa), p, F, P)

    value, by_kappa = jax.value_and_grad(of_kappa)(at.kappa)
    parts = [costates[0] * angle_rate(at, p), at.kappa * by_kappa, -value]
    if at.stretch is not None:
        parts.append(costates[1] * stretch_rate(at, p))
    if at.roll is not None:
        by_twist = jax.grad(lambda rate: lagrangian(at._replace(roll_rate=rate), p, F, P))(at.roll_rate)
        parts.append(at.roll_rate * by_twist)
    if at.slide is not None:
        by_slide = jax.grad(lambda rate: lagrangian(at._replace(slide_rate=rate), p, F, P))(at.slide_rate)
        parts.append(at.slide_rate * by_slide)
    return sum(parts), reduce(jnp.add, map(jnp.abs, parts))
