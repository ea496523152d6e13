"""Textbook force formulas: a cylinder of inextensible fibres that stores no energy.

They are one formula in three sets of variables: all equal `cylinder_force` with B = 0 and no chamber. SI throughout.
F > 0: the muscle pulls its ends together. Arguments broadcast.
"""

import jax.numpy as jnp

from mckibben.model.parameters import Number, Parameters


def virtual_work_force(theta: Number, pressure: Number, p: Parameters) -> Number:
    """Force [N] by the paper's principle of virtual work, Eq. (31): F = pi R0^2/cos^2(theta0) (3 sin^2(theta) - 1) P.

    theta [rad] is the current braid angle from the parallels, pressure [Pa] is gauge; zero at the magic angle.
    """
    return jnp.pi * (p.R0 / jnp.cos(p.theta0)) ** 2 * (3.0 * jnp.sin(theta) ** 2 - 1.0) * pressure


def thread(p: Parameters) -> tuple[Number, Number]:
    """Length b [m] of one fibre of a muscle, and the turns n it makes around the axis."""
    return p.H0 / jnp.sin(p.theta0), p.H0 / (2.0 * jnp.pi * p.R0 * jnp.tan(p.theta0))


def chou_hannaford_force(length: Number, pressure: Number, thread_length: Number, turns: Number) -> Number:
    """Force [N] by Chou and Hannaford (IEEE Trans. Robot. Autom. 12, 1996): F = P b^2 (3 cos^2(alpha) - 1)/(4 pi n^2).

    alpha is the current angle from the AXIS, cos(alpha) = length/b; length [m] is the current one, pressure [Pa] is
    gauge. `thread` gives thread_length b [m] and turns n of a muscle.
    """
    cosine = length / thread_length
    return pressure * thread_length**2 * (3.0 * cosine**2 - 1.0) / (4.0 * jnp.pi * turns**2)


def tondu_lopez_force(contraction: Number, pressure: Number, radius: Number, angle_from_axis: Number) -> Number:
    """Force [N] by Tondu and Lopez (IEEE Control Syst. 20, 2000): F = pi r0^2 P [a (1 - eps)^2 - b].

    a = 3/tan^2(alpha0), b = 1/sin^2(alpha0), with alpha0 = angle_from_axis [rad] the initial angle from the AXIS;
    contraction eps = 1 - h/H0 > 0 when shorter, radius [m] the initial r0, pressure [Pa] is gauge.
    """
    a, b = 3.0 / jnp.tan(angle_from_axis) ** 2, 1.0 / jnp.sin(angle_from_axis) ** 2
    return jnp.pi * radius**2 * pressure * (a * (1.0 - contraction) ** 2 - b)
