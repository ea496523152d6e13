"""THE equation: stored energy and load terms per unit v (Eqs. 20-28).

    Pi = integral w dv - F (h - H0) - P (V - V0),   w = w_fibres + w_chamber

Everything else (forces, tangents, stability, sensitivities) is derived from this by differentiation.
"""

from typing import Any

import jax
import jax.numpy as jnp

from mckibben.compiled.arrays import Array
from mckibben.model.fibres import axial_density, fibre_densities
from mckibben.model.friction import after_step, incremental_density
from mckibben.model.gap import leaves, relaxed_density
from mckibben.model.kinematics import closure_rate, height_rate, volume_rate
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.slide import after_slide, slide_energy
from mckibben.model.wall import chamber_density

__all__ = ["LOADS", "QUANTITIES", "fittings_density", "lagrangian", "remember", "scales", "stored", "works"]

QUANTITIES = ("energy", "length", "volume", "closure")
"""What densities along the length integrate to: stored energy, length h, volume V, and what equal end radii null."""

LOADS = ("force", "pressure", "moment")
"""What does work on the change of length, volume and closure: axial force F, gauge pressure P, closing moment M."""


def stored(at: Point, p: Parameters, memory: Any = None, P: Any = None, found: Any = None) -> Number:
    """Stored energy per unit v [J/m]: fibres (Eq. 20) and chamber (Eq. 26).

    `memory` is what a material point keeps of the state before: with friction, a `Remembered`. Without one crossings
    turn freely and a chamber slides freely, if it may. Given a pressure P [Pa], a chamber with a gap counts with the
    work that is not done on the gap, so that less P times the volume of the mesh it is what a state makes stationary;
    `found` is its hoop stretch, if known.
    """
    gap = P is not None and leaves(p)
    energy = sum(fibre_densities(at, p)) + (relaxed_density(at, P, p, found) if gap else chamber_density(at, p))
    energy = energy if at.stretch is None else energy + axial_density(at, p)
    energy = energy if at.give is None else energy + fittings_density(at, p)
    if p.friction is None or memory is None:
        return energy
    energy = energy + incremental_density(at, p, memory)
    return energy if memory.slid is None else energy + slide_energy(at, p, memory)


def fittings_density(at: Point, p: Parameters) -> Number:
    """Energy of fittings that give way like a spring, (H0 give)^2/(2 C) in all, spread over the length [J/m]."""
    return at.give**2 * p.H0 / (2.0 * p.compliance)


def remember(at: Point, p: Parameters, memory: Any) -> Any:
    """What a material point keeps once it has been in a state, from what it kept before."""
    if p.friction is None:
        return memory
    memory = after_step(at, p, memory)
    return memory if memory.slid is None else after_slide(at, p, memory)


def works(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Densities per unit v of length, volume and closure, on whose change the `LOADS` do work."""
    height = height_rate(at, p) if at.give is None else height_rate(at, p) + at.give
    height = height if p.dead is None else height + p.dead / p.H0
    return height, volume_rate(at, p), closure_rate(at, p)


def lagrangian(at: Point, p: Parameters, F: Number, P: Number, M: Number = 0.0, memory: Any = None) -> Number:
    """L = w - F z' - P pi r^2 z' - M closure [J/m]: what a state makes stationary, to be differentiated where it is."""
    found = None if at.blown is None else jax.lax.stop_gradient(at.blown)
    at = at if at.blown is None else at._replace(blown=None)
    height, volume, closure = works(at, p)
    return stored(at, p, memory, P, found) - F * height - P * volume - M * closure


def scales(p: Parameters) -> Array:
    """Units that make the quantities of order one: a characteristic energy [J], rest length [m], V0 [m^3] and 1 rad."""
    modulus = jax.grad(jax.grad(lambda t: chamber_density(Point.cylinder(p.theta0 + t), p)))(0.0)
    energy = p.H0 * (p.N * (p.B1 + p.B2 + p.B3) / p.R0**2 + jnp.abs(modulus))
    return jax.lax.stop_gradient(jnp.stack([energy, p.rest, jnp.pi * p.R0**2 * p.H0, jnp.ones_like(p.H0)]))
