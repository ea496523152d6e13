"""Friction where fibres cross: rate-independent, elastic up to the moment at which a crossing slips (theory page).

Per unit v there are n_c crossings, each of which has turned by beta = 2 (theta - theta0). One resists with the moment

    tau = clip(k (beta - alpha), -M, M),   M = m0 + mu a g max(T, 0),   g = l max(kappa_n, 0) + 2 d/l

in which alpha, the turn at which it would be free of moment, is what it remembers. With alpha and M those of the state
before, a step minimises an energy that has tau for its derivative.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp

from mckibben.model.angle import cos, radians, sin
from mckibben.model.kinematics import fibre_strains
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point, made_angle

__all__ = [
    "Remembered",
    "after_step",
    "as_made",
    "crossing_density",
    "crossing_moment",
    "crossings",
    "incremental_density",
    "pull",
    "slip_moment",
    "step_energy",
    "turn",
]


class Remembered(NamedTuple):
    """What crossings and chamber at a material point remember as a step begins."""

    alpha: Number  #: turn at which a crossing is free of moment [rad]
    moment: Number  #: M at which it slips in this step [N m]
    slid: Any = None  #: slide at which the chamber is free of shear [m]; None where it is held to the mesh
    limit: Any = None  #: force per unit v at which it slides in this step [N/m]


def as_made(p: Parameters) -> Remembered:
    """Crossings that have not turned yet and carry no moment, beside a chamber that lies as it was mounted."""
    none, chamber = 0.0 * p.friction.moment, (None, None)
    if p.friction.chamber is not None:
        chamber = none, none
    return Remembered(none, p.friction.moment, *chamber)


def spacing(at: Point, p: Parameters) -> Number:
    """Distance l between crossings along a fibre [m]."""
    return 2.0 * jnp.pi * p.R0 / (p.N * cos(made_angle(at, p)))


def crossings(at: Point, p: Parameters) -> Number:
    """Crossings per unit v, n_c [1/m]."""
    made = made_angle(at, p)
    return p.N**2 * cos(made) / (4.0 * jnp.pi * p.R0 * sin(made))


def turn(at: Point, p: Parameters) -> Number:
    """Angle by which a crossing has turned since it was made, beta [rad]."""
    return 2.0 * (radians(at.theta) - radians(made_angle(at, p)))


def slip_moment(at: Point, tension: Number, p: Parameters) -> Number:
    """Moment M at which a crossing slips [N m], at a tension T of the fibres [N]."""
    curvature = -fibre_strains(at._replace(roll=None, roll_rate=None), p)[1]  # of the surface, whatever the roll
    pressed = spacing(at, p) * jnp.maximum(curvature, 0.0) + 2.0 * p.friction.diameter / spacing(at, p)
    return p.friction.moment + p.friction.arm * pressed * jnp.maximum(tension, 0.0)


def incremental_density(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Energy per unit v [J/m] that a step from `memory` stores and dissipates: quadratic, beyond M linear."""
    return crossings(at, p) * step_energy(turn(at, p) - memory.alpha, p.friction.stiffness, memory.moment)


def step_energy(x: Number, k: Number, most: Number) -> Number:
    """What has clip(k x, -most, most) for its derivative by x: quadratic, beyond `most` linear."""
    size = jnp.abs(x)
    return jnp.where(k * size < most, 0.5 * k * x * x, most * size - 0.5 * most * most / k)


def crossing_moment(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Moment tau of a crossing [N m], positive where the braid was last lengthened."""
    return jnp.clip(p.friction.stiffness * (turn(at, p) - memory.alpha), -memory.moment, memory.moment)


def crossing_density(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Energy that the crossings store per unit v [J/m]: it comes back when they are let go."""
    return 0.5 * crossings(at, p) * crossing_moment(at, p, memory) ** 2 / p.friction.stiffness


def pull(at: Point, p: Parameters, memory: Remembered) -> Number:
    """Derivative of the incremental energy by theta [J/m]."""
    return 2.0 * crossings(at, p) * crossing_moment(at, p, memory)


def after_step(at: Point, p: Parameters, memory: Remembered) -> Remembered:
    """What the crossings remember once they have been in a state."""
    return memory._replace(alpha=turn(at, p) - crossing_moment(at, p, memory) / p.friction.stiffness)
