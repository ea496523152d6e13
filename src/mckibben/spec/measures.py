"""Measures that a design may ask for: of a muscle at single states, and of the muscle itself. Values only."""

from __future__ import annotations

from typing import ClassVar

from mckibben.spec.asked import (
    AtOneState,
    check_one_state,
    contraction_field,
    density_field,
    force_field,
    length_field,
    measure,
    place_said,
    pressure_field,
)
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import spec
from mckibben.spec.wishes import Measure
from mckibben.units import show

__all__ = ["AirVolume", "ForceAt", "Mass", "PressureFor", "Stroke"]


@measure
@spec("force")
class ForceAt(AtOneState):
    """Force at one pressure and contraction (or length); as made, the blocked force, where neither is given.

    Args:
        pressure: gauge pressure [Pa].
        contraction: 1 - h/H0, such as "10 %".
        length: distance between the fittings [m], in place of the contraction.

    Raises:
        SpecError: for a value out of range, or both a contraction and a length.

    >>> (mk.ForceAt(pressure="4 bar") >= "300 N").said
    'force at the length as made and 4 bar at least 300 N'
    """

    kind: ClassVar[str] = "force"
    meaning: ClassVar[str] = "force"
    unit: ClassVar[str] = "N"


@measure
@spec("stroke")
class Stroke(Measure):
    """Contraction 1 - h/H0 at one pressure, free or against a force.

    Args:
        pressure: gauge pressure [Pa].
        force: what the muscle pulls [N]; 0, the free contraction, where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> (mk.Stroke(pressure="4 bar", force="50 N") >= "12 %").said
    'contraction against 50 N at 4 bar at least 12 %'
    """

    kind: ClassVar[str] = "stroke"
    meaning: ClassVar[str] = "contraction"
    unit: ClassVar[str] = "1"
    display: ClassVar[str] = "%"
    high: ClassVar[float] = 1.0
    pressure: Reads[float] = pressure_field()
    force: Reads[float] = force_field("what the muscle pulls", default=0.0)

    @property
    def said(self) -> str:
        what = f"contraction against {show(self.force, 'N', 4)}" if self.force else "free contraction"
        return f"{what} at {show(self.pressure, 'Pa', 4)}"


@measure
@spec("pressure-for")
class PressureFor(Measure):
    """Least pressure at which the muscle pulls so much at a contraction (or length).

    Args:
        force: what it pulls [N].
        contraction: 1 - h/H0, such as "10 %".
        length: distance between the fittings [m], in place of the contraction.
        up_to: pressure up to which is looked [Pa]; more counts as beyond reach.

    Raises:
        SpecError: for a value out of range, or both a contraction and a length.

    >>> (mk.PressureFor(force="100 N", contraction="10 %") <= "3 bar").said
    'pressure for 100 N at 10 % contraction at most 3 bar'
    """

    kind: ClassVar[str] = "pressure-for"
    meaning: ClassVar[str] = "pressure"
    unit: ClassVar[str] = "Pa"
    low: ClassVar[float] = 0.0
    force: Reads[float] = force_field("what the muscle pulls", low=0.0, low_open=True)
    contraction: Reads[float | None] = contraction_field()
    length: Reads[float | None] = length_field()
    up_to: Reads[float] = pressure_field("pressure up to which is looked", default=1e6, low=0.0, low_open=True)

    def __attrs_post_init__(self) -> None:
        check_one_state(self)

    @property
    def where(self) -> str:
        return f"for {show(self.force, 'N', 4)} at {place_said(self, 'the length as made')}"


@measure
@spec("air-volume")
class AirVolume(AtOneState):
    """Volume of the air inside at one pressure; at the free contraction, where it is largest, if nothing else is said.

    Args:
        pressure: gauge pressure [Pa].
        contraction: 1 - h/H0, such as "10 %".
        length: distance between the fittings [m], in place of the contraction.

    Raises:
        SpecError: for a value out of range, or both a contraction and a length.

    >>> (mk.AirVolume(pressure="4 bar") <= "60 mL").said
    'volume of air at the free contraction and 4 bar at most 60 mL'
    """

    kind: ClassVar[str] = "air-volume"
    meaning: ClassVar[str] = "volume of air"
    unit: ClassVar[str] = "m^3"
    low: ClassVar[float] = 0.0
    usual: ClassVar[str] = "the free contraction"


@measure
@spec("mass")
class Mass(Measure):
    """Mass of braid and chamber between the fittings, which are not counted.

    Args:
        fibre_density: density of the fibres [kg/m^3]; their diameter must be known.
        chamber_density: density of the chamber [kg/m^3], needed where there is one.

    Raises:
        SpecError: for a value out of range, or no density of the fibres.

    >>> (mk.Mass(fibre_density="1380 kg/m^3", chamber_density="1100 kg/m^3") <= "50 g").said
    'mass at most 50 g'
    """

    kind: ClassVar[str] = "mass"
    meaning: ClassVar[str] = "mass"
    unit: ClassVar[str] = "kg"
    display: ClassVar[str] = "g"
    low: ClassVar[float] = 0.0
    fibre_density: Reads[float | None] = density_field("fibres")
    chamber_density: Reads[float | None] = density_field("chamber")

    def __attrs_post_init__(self) -> None:
        if self.fibre_density is None:
            raise SpecError("mass.fibre_density", allowed="is missing", advice='such as "1380 kg/m^3" of PET')
