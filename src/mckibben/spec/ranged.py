"""Measures that a design may ask for: of a muscle over a range of contractions at one pressure. Values only."""

from __future__ import annotations

from enum import StrEnum
from typing import ClassVar

from mckibben.spec.asked import Ranged, density_field, measure
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, spec

__all__ = [
    "Diameter",
    "FibreSafety",
    "FibreTension",
    "ForceVariation",
    "JammingMargin",
    "Per",
    "StabilityMargin",
    "Work",
]


class Per(StrEnum):
    """What work is divided by."""

    NOTHING = "nothing"
    VOLUME = "volume"
    MASS = "mass"


@measure
@spec("work")
class Work(Ranged):
    """Work that the muscle does at one pressure while it contracts, the integral of force over length.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.
        per: "nothing" (J), "volume" (J/m^3, of the cylinder as made on the radius of the fibres) or "mass" (J/kg, of
            braid and chamber without fittings).
        fibre_density: density of the fibres [kg/m^3], for a work per mass.
        chamber_density: density of the chamber [kg/m^3], for a work per mass.

    Raises:
        SpecError: for a value out of range, or a work per mass without densities.

    >>> mk.Work(pressure="4 bar", between="0 to 15 %").said
    'work from 0 % to 15 % contraction at 4 bar'
    """

    kind: ClassVar[str] = "work"
    per: Reads[Per] = choice(Per, meaning="what the work is divided by", default=Per.NOTHING)
    fibre_density: Reads[float | None] = density_field("fibres")
    chamber_density: Reads[float | None] = density_field("chamber")

    def __attrs_post_init__(self) -> None:
        if self.per == Per.MASS and self.fibre_density is None:
            raise SpecError(
                "work.fibre_density", allowed="is missing for a work per mass", advice='"1380 kg/m^3" is PET'
            )

    @property
    def meaning(self) -> str:  # type: ignore[override]
        """What it is, in words."""
        return "work" if self.per == Per.NOTHING else f"work per {self.per}"

    @property
    def unit(self) -> str:  # type: ignore[override]
        """SI unit of its value."""
        return {Per.NOTHING: "J", Per.VOLUME: "J/m^3", Per.MASS: "J/kg"}[self.per]

    @property
    def display(self) -> str:  # type: ignore[override]
        """Unit that people see."""
        return {Per.NOTHING: "J", Per.VOLUME: "kJ/m^3", Per.MASS: "J/kg"}[self.per]


@measure
@spec("force-variation")
class ForceVariation(Ranged):
    """How far the force is from constant: largest less smallest force over their mean, at one pressure.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "5 to 15 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> mk.Minimise(mk.ForceVariation(pressure="4 bar", between="5 to 15 %")).said
    'minimise variation of the force from 5 % to 15 % contraction at 4 bar'
    """

    kind: ClassVar[str] = "force-variation"
    meaning: ClassVar[str] = "variation of the force"
    unit: ClassVar[str] = "1"
    display: ClassVar[str] = "%"
    low: ClassVar[float] = 0.0


@measure
@spec("diameter")
class Diameter(Ranged):
    """Largest diameter over the braid at one pressure.

    Two fibres cross where it is widest: twice the largest radius of their centre lines, and two fibre diameters where
    the diameter of a fibre is known. A wall that lies outside the braid, as the paper's, is not counted.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.Diameter(pressure="4 bar", between="0 to 20 %") <= "30 mm").said
    'largest diameter from 0 % to 20 % contraction at 4 bar at most 30 mm'
    """

    kind: ClassVar[str] = "diameter"
    meaning: ClassVar[str] = "largest diameter"
    unit: ClassVar[str] = "m"
    low: ClassVar[float] = 0.0


@measure
@spec("fibre-tension")
class FibreTension(Ranged):
    """Largest tension of one fibre [N] at one pressure.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.FibreTension(pressure="4 bar") <= "10 N").said
    'largest fibre tension from the length as made to the free contraction at 4 bar at most 10 N'
    """

    kind: ClassVar[str] = "fibre-tension"
    meaning: ClassVar[str] = "largest fibre tension"
    unit: ClassVar[str] = "N"


@measure
@spec("fibre-safety")
class FibreSafety(Ranged):
    """Safety factor of the fibres: their breaking force over the largest tension, at one pressure.

    The breaking force is that of the muscle's fibres (`Fibre(breaking_force="30 N")`).

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.FibreSafety(pressure="4 bar") >= 3).said
    'safety factor of the fibres from the length as made to the free contraction at 4 bar at least 3'
    """

    kind: ClassVar[str] = "fibre-safety"
    meaning: ClassVar[str] = "safety factor of the fibres"
    unit: ClassVar[str] = "1"
    low: ClassVar[float] = 0.0


@measure
@spec("jamming-margin")
class JammingMargin(Ranged):
    """Room between neighbouring fibres over their diameter, where the muscle is widest or as made; 0 where they touch.

    The lesser of both: a flat braid jams where it is widest, a steep one as made. Of inextensible fibres; of those that
    stretch, as if they did not. Only for fibres of a known diameter.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.JammingMargin(pressure="4 bar") >= 0.2).said
    'room between fibres from the length as made to the free contraction at 4 bar at least 0.2'
    """

    kind: ClassVar[str] = "jamming-margin"
    meaning: ClassVar[str] = "room between fibres"
    unit: ClassVar[str] = "1"
    low: ClassVar[float] = -1.0


@measure
@spec("stability-margin")
class StabilityMargin(Ranged):
    """How far a muscle is from bowing sideways at one pressure: 1 + F/F_col, at its least over the range.

    F_col is the push from which the muscle bows like a column whose ends neither turn nor move aside, by its own
    bending stiffness (Euler; theory page, the muscle as a column). 1 is a muscle that neither pulls nor pushes, 0 one
    that bows; 0.5 pushes with half of what it bears, which is a safety factor of 2; one that pulls has more than 1. A
    muscle whose fittings can swivel bears a quarter: ask for 0.75 and more then. It is an upper estimate, and means
    little for muscles shorter than five diameters. The axisymmetric shape needs no margin of its own: a design with a
    state that is not stable does not fulfil what is asked.

    Args:
        pressure: gauge pressure [Pa].
        between: the contractions, such as "0 to 20 %"; from as made to the free contraction where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.StabilityMargin(pressure="4 bar", between="-10 to 0 %") >= 0.5).said
    'share of the bowing push left from -10 % to 0 % contraction at 4 bar at least 0.5'
    """

    kind: ClassVar[str] = "stability-margin"
    meaning: ClassVar[str] = "share of the bowing push left"
    unit: ClassVar[str] = "1"
