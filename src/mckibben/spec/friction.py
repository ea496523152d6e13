"""Friction where fibres cross, and of the chamber along the mesh, as measured or assumed: `Friction`."""

from __future__ import annotations

from typing import Any

from mckibben.spec.bellows import Bellows
from mckibben.spec.chamber import Chamber
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, spec
from mckibben.units import Number, is_traced

__all__ = ["Friction", "check_friction", "held_to_mesh"]

_SOURCE = "theory page, friction at the crossings"
_SLIDES = "theory page, friction between chamber and mesh"

GRIP = 1e8
"""Shear stress per slide [Pa/m] of a chamber that sticks, where none is given."""


@spec("friction")
class Friction:
    """What resists the turning of two fibres against each other where they cross, whatever the speed.

    A crossing that turns resists with the moment M = constant + coefficient arm T g, where T is the tension of a fibre
    and T g presses the fibres together: g is the load that a fibre carries to the net between two crossings, over T,
    and the kink of a plain weave. A crossing that does not turn resists like a spring, up to M. The state of such a
    muscle depends on its path: see `run` (theory page, friction at the crossings).

    Args:
        coefficient: friction coefficient mu between two fibres.
        arm: effective arm a of the friction about the crossing [m]; a fraction of the width over which fibres touch.
        constant: the part m0 of the moment that does not depend on tension [N m].
        stiffness: moment per angle k of a crossing that sticks [N m, per rad]. With the default, 10 N mm, a crossing
            turns by 0.1 deg before it slips at 0.02 N mm: little beside the tens of degrees of a stroke, on which
            forces hardly depend, and soft enough to be solved in few steps.
        chamber_coefficient: friction coefficient between the mesh and a chamber inside it, a tube with a gap or
            bellows, which may then slide along the mesh; 0 slides freely. Left out, the chamber has the axial stretch
            of the mesh everywhere and slides nowhere.
        chamber_stiffness: shear stress per slide of a chamber that sticks [Pa/m]; 0.1 MPa/mm where it is left out: it
            moves by 0.3 mm before it slides at 30 kPa (0.3 of 1 bar). A wall of shear modulus G and thickness t itself
            gives way with 3 G/t.

    Raises:
        SpecError: for a value out of range, or a coefficient without its arm. A muscle with a coefficient also needs
            the diameter of its fibres, one with a `chamber_coefficient` a chamber that may slide.

    >>> friction = mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm")
    >>> muscle = mk.presets.paper().replace("friction", friction)
    >>> test = mk.Isobaric(pressure="1 bar", length=["100 mm", "103 mm", "100 mm"])
    >>> mk.run(muscle, test).force.round(1)  # N: more is needed to lengthen it than it pulls as it shortens
    array([47.3, 56.8, 44.3])
    """

    coefficient: Reads[float] = quantity(
        "1", meaning="friction coefficient between two fibres", low=0.0, high=10.0, source=_SOURCE, default=0.0
    )
    arm: Reads[float | None] = quantity(
        "m", meaning="effective arm of the friction about a crossing", low=0.0, size=(1e-9, 1.0), source=_SOURCE,
        default=None, doubt=(5e-3, 50.0),
    )  # fmt: skip
    constant: Reads[float] = quantity(
        "N m", meaning="part of the friction moment that does not depend on tension", low=0.0, size=(1e-15, 1e3),
        source=_SOURCE, default=0.0,
    )  # fmt: skip
    stiffness: Reads[float] = quantity(
        "N m", meaning="moment per rad of a crossing that sticks", low=0.0, low_open=True, size=(1e-9, 1e6),
        source=_SOURCE, default=0.01,
    )  # fmt: skip

    chamber_coefficient: Reads[float | None] = quantity(
        "1", meaning="friction coefficient between chamber and mesh, none where they do not slide", low=0.0, high=10.0,
        source=_SLIDES, default=None,
    )  # fmt: skip
    chamber_stiffness: Reads[float | None] = quantity(
        "Pa/m", meaning="shear stress per slide of a chamber that sticks; 0.1 MPa/mm", low=0.0, low_open=True,
        size=(1e3, 1e15), source=_SLIDES, default=None,
    )  # fmt: skip

    def __attrs_post_init__(self) -> None:
        if self.arm is None and _some(self.coefficient):
            said = "is missing: a coefficient alone makes no moment"
            raise SpecError("friction.arm", allowed=said, advice="give the arm, such as 0.05 mm")
        if self.chamber_stiffness is not None and self.chamber_coefficient is None:
            said = "is missing beside chamber_stiffness: without it the chamber does not slide"
            raise SpecError("friction.chamber_coefficient", allowed=said, advice="give it, such as 0.3")

    @property
    def grip(self) -> Number | None:
        """Shear stress per slide of a chamber that sticks [Pa/m]; None where it is held to the mesh."""
        if self.chamber_coefficient is None:
            return None
        return GRIP if self.chamber_stiffness is None else self.chamber_stiffness


def check_friction(friction: Friction | None, diameter: Any, chamber: Chamber | None) -> None:
    """Raise where the fibres' diameter is needed, for the kink of the weave, and unknown; where the chamber should
    slide, and cannot."""
    if friction is not None and diameter is None and _some(friction.coefficient):
        said = "needs the diameter of the fibres, which tells how they press on each other"
        raise SpecError("friction.coefficient", friction.coefficient, said, "give braid.fibre.diameter")
    if friction is not None and friction.chamber_coefficient is not None and (why := held_to_mesh(chamber)):
        advice = "leave it out, or give a chamber that lies inside: a tube with chamber.gap = true, or bellows"
        raise SpecError("friction.chamber_coefficient", friction.chamber_coefficient, why, advice)


def held_to_mesh(chamber: Chamber | None) -> str:
    """Why a chamber cannot slide along the mesh; nothing where it may."""
    if chamber is None:
        return "needs a chamber: a bare braid has none that could slide"
    if not chamber.inside:
        return "needs a chamber inside the braid: the wall of this one lies around the fibres and goes with them"
    if not chamber.gap and not isinstance(chamber.law, Bellows):
        return (
            "needs chamber.gap = true: a tube that is held to the mesh pulls at it where a real one would leave it, "
            "and nothing says how it would slide there"
        )
    return ""


def _some(value: Any) -> bool:
    return is_traced(value) or value > 0.0
