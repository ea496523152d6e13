"""Fibre tension and the conserved quantity, pointwise (derived on the theory page).

With w_f(theta, theta', psi, kappa) the fibre energy per unit v, in which u1 = sin(theta0) theta' - cos(theta0)
sin(psi)/R0 keeps its two parts apart, w_c(r, s) that of the chamber and p the costate of theta (p' = dL/dtheta):

    q = -(p - dw_f/dtheta') cos(theta0) / (R0 sin(theta))
    N T sin(theta) = (F + pi r^2 P) cos(psi) + q sin(psi) - dw_c/ds
                     - [dw_f/dtheta - (dw_f/dtheta')'] sin(theta0) cos(theta)
"""

import jax
import jax.numpy as jnp

from mckibben.model.angle import cos, sin, slope
from mckibben.model.energy import lagrangian
from mckibben.model.fibres import fibre_densities
from mckibben.model.kinematics import angle_rate, fibre_strains, radius
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_pull

__all__ = ["conserved", "tension"]


def tension(at: Point, costate: Number, F: Number, P: Number, p: Parameters) -> Number:
    """Tension T [N] of one fibre, the multiplier of inextensibility, at force F [N] and pressure P [Pa]."""
    sine, cosine = sin(p.theta0), cos(p.theta0)
    u1 = fibre_strains(at, p)[0]
    by_rate, by_rate_dv = p.N * p.B1 * u1, -2.0 * p.N * p.B1 * cosine / p.R0 * cos(at.psi) * at.kappa
    by_theta = slope(lambda t: sum(fibre_densities(at._replace(theta=t), p)), at.theta)
    q = -(costate - by_rate) * cosine / (p.R0 * sin(at.theta))
    axial = F + jnp.pi * radius(at, p) ** 2 * P
    along = axial * cos(at.psi) + q * sin(at.psi) - chamber_pull(at, p)
    return (along - (by_theta - by_rate_dv) * sine * cos(at.theta)) / (p.N * sin(at.theta))


def conserved(at: Point, costate: Number, F: Number, P: Number, p: Parameters) -> tuple[Number, Number]:
    """p theta' + kappa dL/dkappa - L [J/m], the same all along the length, and the sum of its terms' magnitudes."""

    def of_kappa(kappa: Number) -> Number:
        return lagrangian(at._replace(kappa=kappa), p, F, P)

    value, by_kappa = jax.value_and_grad(of_kappa)(at.kappa)
    parts = (costate * angle_rate(at, p), at.kappa * by_kappa, -value)
    return sum(parts), jnp.abs(parts[0]) + jnp.abs(parts[1]) + jnp.abs(parts[2])
