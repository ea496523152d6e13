"""From what the user says to the numbers the energy needs.

Numbers are leaves of JAX pytrees (they can be traced, differentiated and batched), choices are static.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from mckibben.model import pytrees
from mckibben.spec.chamber import Chamber
from mckibben.spec.laws import NeoHookean, Rubber
from mckibben.spec.muscle import Braid, Muscle
from mckibben.units import is_traced

jax.config.update("jax_enable_x64", True)  # before anything is computed: every module of mechanics imports this one
pytrees.register()

__all__ = ["Number", "Parameters", "Rubbing", "Tube", "functions", "numbers", "parameters", "static_braid"]

Number = Any
"""A float, a NumPy or JAX scalar, or a tracer."""


def functions(*values: Number) -> Any:
    """NumPy for plain numbers and arrays, where nothing is to be compiled; `jax.numpy` where JAX is in a value."""
    return jnp if any(is_traced(value) for value in values) else np


class Tube(NamedTuple):
    """How the chamber differs from the paper's: where it lies, what it is mounted at, how its wall is taken."""

    hoop: Number  #: hoop stretch of the face that rides on the braid, as mounted: R0 over its radius as made
    axial: Number  #: axial stretch as mounted: H0 over the length as made
    rubber: Number  #: volume of rubber inside the braid [m^3]
    across: Number | None  #: (radius of the other face over that of the one that rides)^2 as made; None: a thin wall
    gap: Any = None  #: () where the chamber may leave the braid; None where the two are held together


class Rubbing(NamedTuple):
    """Numbers of the friction at the crossings and between chamber and mesh, in SI units."""

    arm: Number  #: friction coefficient times its arm, mu a [m]
    moment: Number  #: part of the moment that does not depend on tension, m0 [N m]
    stiffness: Number  #: k of a crossing that sticks [N m/rad]
    diameter: Number  #: d of a fibre [m]; 0 where mu a is 0 and it does not matter
    chamber: Any = None  #: friction coefficient between chamber and mesh; None where they are held together
    grip: Any = None  #: shear stress per slide of a chamber that sticks [Pa/m]; None where it is held


class Parameters(NamedTuple):
    """Numbers of one muscle in SI units."""

    R0: Number  #: initial radius [m]
    H0: Number  #: initial length [m]
    theta0: Number  #: initial braid angle from the parallels [rad]
    N: Number  #: number of fibres, both hands together
    B1: Number  #: bending stiffness in the tangent plane [N m^2]
    B2: Number  #: bending stiffness normal to the surface [N m^2]
    B3: Number  #: torsional stiffness [N m^2]
    helical: Number  #: 1 if the initial helix is stress-free, 0 if the straight fibre is
    A0: Number  #: volume of the chamber's wall per unit v [m^2]: the area of its cross-section as made (Eq. 26)
    law: Any  #: law of the chamber: its kind is static, its constants are leaves; None for the bare braid
    tube: Tube | None = None  #: a chamber that is not the paper's; None takes the way of the paper, to the last bit
    EA: Any = None  #: axial stiffness of a fibre [N]; None where the fibres do not stretch, or by a law of their own
    slack: Any = None  #: 1 if a fibre that stretches carries no compression, None if it does
    compliance: Any = None  #: of both fittings together [m/N]; None where they are rigid
    stiffening: Any = None  #: `spec.Stiffening` of the fibres, None for the paper's quadratic energy
    friction: Any = None  #: `Rubbing` where crossings rub, None where they turn freely
    dead: Any = None  #: length under both fittings that neither shortens nor lengthens [m]; None where there is none

    end_radii: Any = None  #: radii that the fittings hold [m], one for both or two; None where it is that of the braid
    axial: Any = None  #: `spec.AxialLaw` of fibres that stretch, None where T = EA (lambda - 1)
    profile: Any = None  #: `spec.AngleProfile` of the braid, which begins at theta0; None where it has one angle

    @property
    def endless(self) -> bool:
        """Whether no length is too long: the fibres stretch, or the fittings give way."""
        return any(part is not None for part in (self.EA, self.axial, self.compliance))

    @property
    def rest(self) -> Number:
        """Length between the fittings as made [m]: of the braid, and what lies dead under them."""
        return self.H0 if self.dead is None else self.H0 + self.dead

    def active(self, length: Number) -> Number:
        """What the braid takes [m] of a length between the fittings."""
        return length if self.dead is None else length - self.dead


def parameters(muscle: Muscle) -> Parameters:
    """Numbers of a muscle; differentiable with respect to every number of its specification."""
    made: Parameters = jax.tree.map(_array, numbers(muscle))
    return made


def _array(value: Number) -> Number:
    return functions(value).asarray(value, float)


def numbers(muscle: Muscle) -> Parameters:
    """Numbers of a muscle as they are in its specification, floats or traced."""
    braid, fibre, chamber, fittings = muscle.braid, muscle.braid.fibre, muscle.chamber, muscle.fittings
    B1, B2, B3 = fibre.stiffnesses
    tube = None if chamber is None else _tube(chamber, braid)
    area = 0.0 * braid.radius if chamber is None else chamber.area(braid.radius)
    return Parameters(
        braid.radius, braid.length, braid.angle, braid.fibres, B1, B2, B3,
        1.0 if fibre.natural == "helical" else 0.0,
        area if tube is None else area / tube.axial,
        None if chamber is None else _law(chamber.law),
        tube,
        fibre.EA if fibre.axial_law is None else None,
        1.0 if fibre.stretch and fibre.slack else None,
        None if fittings is None else fittings.compliance,
        fibre.stiffening,
        _rubbing(muscle),
        None if fittings is None else fittings.dead_length,
        muscle.end_radii,
        fibre.axial_law,
        braid.angle_profile,
    )  # fmt: skip


def _rubbing(muscle: Muscle) -> Rubbing | None:
    friction, diameter = muscle.friction, muscle.braid.fibre.diameter
    if friction is None:
        return None
    arm = 0.0 if friction.arm is None else friction.arm
    return Rubbing(
        friction.coefficient * arm, friction.constant, friction.stiffness, 0.0 if diameter is None else diameter,
        friction.chamber_coefficient, friction.grip,
    )  # fmt: skip


def _law(law: Any) -> Any:
    """The law as the energy knows it: rubber is neo-Hookean, wherever its one constant comes from."""
    return pytrees.made(NeoHookean, {"c1": law.c1}) if isinstance(law, Rubber) else law


def _tube(chamber: Chamber, braid: Braid) -> Tube | None:
    """What makes the chamber another than the paper's; None where nothing does."""
    if not chamber.own:
        return None
    hoop, axial = chamber.stretches(braid.radius, braid.length)
    area = chamber.area(braid.radius)
    rubber = area * braid.length / axial if chamber.inside else 0.0 * area
    across = chamber.other_face(braid.radius) if chamber.thick else None
    return Tube(hoop, axial, rubber, across, () if chamber.gap else None)


def static_braid(p: Parameters) -> Number:
    """a = 1/(R0 tan(theta0)) [1/m], the factor between sin(psi) and theta' (theory page)."""
    return 1.0 / (p.R0 * jnp.tan(p.theta0))
