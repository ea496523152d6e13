"""Measures of how far a muscle is from what is wanted of it point by point: a curve, a profile. Values only."""

from __future__ import annotations

from typing import ClassVar

from mckibben.spec.asked import (
    check_one_state,
    contraction_field,
    force_field,
    length_field,
    measure,
    place_said,
    pressure_field,
)
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantities, spec
from mckibben.spec.plausible import CONTROLLED
from mckibben.spec.wishes import Measure
from mckibben.units import show

__all__ = ["CurveMiss", "ProfileMiss"]

_RADIUS = (1.0, 1e3)
"""Bare radii [m] that are doubted, as those of a braid."""


@measure
@spec("curve-miss")
class CurveMiss(Measure):
    """Root mean square difference [N] of the force-contraction curve from a wanted one, at one pressure.

    Args:
        pressure: gauge pressure [Pa].
        contractions: where the force is wanted, such as ["0 %", "10 %", "20 %"].
        forces: what is wanted there [N], as many.

    Raises:
        SpecError: for a value out of range, or other numbers of contractions and forces.

    >>> mk.CurveMiss(pressure="4 bar", contractions=["0 %", "10 %"], forces=["400 N", "200 N"]).said
    'rms difference from the wanted curve at 4 bar'
    """

    kind: ClassVar[str] = "curve-miss"
    meaning: ClassVar[str] = "rms difference"
    unit: ClassVar[str] = "N"
    low: ClassVar[float] = 0.0
    contractions: Reads[tuple[float, ...]] = quantities("1", meaning="where the force is wanted", size=(0.0, 10.0))
    forces: Reads[tuple[float, ...]] = quantities("N", meaning="force that is wanted there", size=(0.0, 1e9))
    pressure: Reads[float] = pressure_field()

    def __attrs_post_init__(self) -> None:
        if len(self.contractions) != len(self.forces):
            said = f"must be {len(self.contractions)}, as many as contractions"
            raise SpecError("curve-miss.forces", f"{len(self.forces)} of them", said)
        if not max(self.contractions) < 1.0:
            raise SpecError("curve-miss.contractions", max(self.contractions), "must be below 1 (100 %)")

    @property
    def where(self) -> str:
        return f"from the wanted curve at {show(self.pressure, 'Pa', 4)}"


@measure
@spec("profile-miss")
class ProfileMiss(Measure):
    """Root mean square difference [m] of the radius along the muscle from a wanted profile r(z), in one state.

    The radius is that of the centre lines of the fibres, as `r` of a result and `Braid.radius`. Without a contraction,
    a length or a force the muscle is free. Where a place lies beyond the end of a muscle, its value is not known.

    Args:
        pressure: gauge pressure [Pa].
        r: what radius is wanted at each place [m].
        at: the places, as shares of the distance between the ends of the braid, from the first one, rising.
        z: in their stead, the places as distances from the first end along the axis [m], rising.
        contraction: 1 - h/H0, such as "10 %".
        length: distance between the fittings [m], in place of the contraction.
        force: what the muscle pulls [N], in place of both.

    Raises:
        SpecError: for a value out of range, places that do not rise or lie outside the muscle, other numbers of places
            and radii, or more than one of contraction, length and force.

    >>> mk.Minimise(mk.ProfileMiss(pressure="1 bar", at=["25 %", "50 %"], r=["16 mm", "15 mm"])).said
    'minimise rms difference from the wanted profile at the free contraction and 1 bar'
    """

    kind: ClassVar[str] = "profile-miss"
    meaning: ClassVar[str] = "rms difference"
    unit: ClassVar[str] = "m"
    low: ClassVar[float] = 0.0
    r: Reads[tuple[float, ...]] = quantities(
        "m", meaning="radius that is wanted at each place, of the centre lines of the fibres", low=0.0, low_open=True,
        size=(1e-6, 1e3), doubt=_RADIUS,
    )  # fmt: skip
    pressure: Reads[float] = pressure_field()
    at: Reads[tuple[float, ...] | None] = quantities(
        "1", meaning="the places, as shares of the distance between the ends of the braid", low=0.0, high=1.0,
        default=None,
    )  # fmt: skip
    z: Reads[tuple[float, ...] | None] = quantities(
        "m", meaning="the places, as distances from the first end of the braid", low=0.0, size=(1e-9, 1e3),
        default=None, doubt=CONTROLLED["m"],
    )  # fmt: skip
    contraction: Reads[float | None] = contraction_field()
    length: Reads[float | None] = length_field()
    force: Reads[float | None] = force_field("what the muscle pulls, in place of a contraction", default=None)

    def __attrs_post_init__(self) -> None:
        check_one_state(self)
        if self.force is not None and (self.contraction is not None or self.length is not None):
            other = "contraction" if self.contraction is not None else "length"
            said = f"is given beside a {other}"
            raise SpecError("profile-miss.force", show(self.force, "N"), said, "give one of them")
        if (self.at is None) == (self.z is None):
            said = "says no places" if self.at is None else "is given beside z"
            raise SpecError("profile-miss.at", allowed=said, advice='give one of them, such as at=["25 %", "50 %"]')
        name = "z" if self.at is None else "at"
        places = self.places
        if len(places) != len(self.r):
            said = f"must be {len(places)}, as many as {name}"
            raise SpecError("profile-miss.r", f"{len(self.r)} of them", said)
        for k in range(1, len(places)):
            if not places[k] > places[k - 1]:
                said = f"must be above the one before it, {places[k - 1]:g}"
                raise SpecError(f"profile-miss.{name}[{k}]", places[k], said, "sort the places")
        if self.z is not None and self.length is not None and self.z[-1] > self.length:
            said = f"lies outside the muscle: must be at most its length, {show(self.length, 'm', 4)}"
            raise SpecError(f"profile-miss.z[{len(places) - 1}]", show(self.z[-1], "m", 4), said)

    @property
    def places(self) -> tuple[float, ...]:
        """Where radii are wanted: shares of the height, or distances [m]."""
        found = self.z if self.at is None else self.at
        assert found is not None
        return found

    @property
    def where(self) -> str:
        where, pressure = place_said(self, "the free contraction"), show(self.pressure, "Pa", 4)
        state = f"against {show(self.force, 'N', 4)} at {pressure}" if self.force else f"at {where} and {pressure}"
        return f"from the wanted profile {state}"
