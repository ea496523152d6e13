"""Whether a uniform cylinder under load is expected to wrinkle before it reaches a target (theory page, stability)."""

import jax
import jax.numpy as jnp

from mckibben.compiled.arrays import Array
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.energy import lagrangian
from mckibben.model.parameters import Number, Parameters, static_braid
from mckibben.model.point import Point

__all__ = ["wrinkling"]


def wrinkling(length: Number, pressure: Number, p: Parameters) -> tuple[Number, Number]:
    """Wrinkling index and wavelength [m, along v] of the cylinder of a given length [m] at a gauge pressure [Pa].

    index = (L_psipsi + 2 a L_thetakappa) / (2 a sqrt(L_kappakappa L_thetatheta)) with a = 1/(R0 tan theta0) and L the
    energy per unit v with its loads. Below -1 a wave of length 2 pi (L_kappakappa/(a^2 L_thetatheta))^(1/4) grows
    without bound on an endless tube; clamped ends delay it. NaN where L_thetatheta is not positive.
    """
    theta = cylinder_angle(length, p)
    force = cylinder_force(theta, pressure, p)

    def density(x: Array) -> Number:
        return lagrangian(Point(*x), p, force, pressure)

    H = jax.hessian(density)(jnp.stack([theta, jnp.zeros_like(theta), jnp.zeros_like(theta)]))
    a = static_braid(p)
    index = (H[1, 1] + 2.0 * a * H[0, 2]) / (2.0 * a * jnp.sqrt(H[2, 2] * H[0, 0]))
    return index, 2.0 * jnp.pi * (H[2, 2] / (a**2 * H[0, 0])) ** 0.25
