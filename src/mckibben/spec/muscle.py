"""The muscle as its maker describes it: `Braid` and `Muscle`. Immutable, compared by value."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import Any

import attrs

from mckibben.spec.angle import AngleFrom, between, both_ways, from_parallels, tendency
from mckibben.spec.angle_profile import AngleProfile, check_angles, check_profile
from mckibben.spec.chamber import Chamber
from mckibben.spec.change import changed_muscle
from mckibben.spec.declared import Declared, Reads, walk
from mckibben.spec.end_radii import check_end_radii, read_radii
from mckibben.spec.ends import Ends
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.fibre import Fibre
from mckibben.spec.fields import choice, count, part, quantities, quantity, read_count, spec, words
from mckibben.spec.fittings import Fittings
from mckibben.spec.friction import Friction, check_friction
from mckibben.spec.limits import check_angle, check_muscle
from mckibben.spec.winding import extremes
from mckibben.units import Number, is_traced, show

__all__ = ["Braid", "Joint", "Muscle"]


class Joint(StrEnum):
    """What holds two fibres together where they cross.

    HINGE: they share the normal of the surface and turn about it alone, as a scissors joint does: the paper's.
    PIN: they share the position alone, as a ball joint does: a fibre may also roll about its own axis.

    >>> muscle = mk.presets.paper().replace("braid.joint", "pin")
    >>> muscle.braid.joint == mk.Joint.PIN == "pin"
    True
    """

    HINGE = "hinge"
    PIN = "pin"


def _read_fibres(value: Any, field: str, declared: Declared) -> Number:
    """One number all along: a braid of continuous fibres keeps theirs (theory page, a programmed braid)."""
    if callable(value) or isinstance(value, (dict, list, tuple)) or getattr(value, "ndim", 0) > 0:
        said = "must be one whole number all along the braid: one that ended within it would hold nothing"
        advice = "vary the angle instead, by braid.angle_profile: where it is steeper there are fewer crossings"
        raise SpecError(field, value, said, advice)
    return read_count(value, field, declared)


@spec("braid")
class Braid:
    """The tube of helical fibres, half of each hand, as made: every length and angle is that of the reference state.

    Fibres are evenly spaced helices that do not slide where they cross (the paper's section II; radius and angle: Eq.
    11).

    Args:
        radius: radius R0 of the fibres' centre lines [m].
        length: length H0 between the fittings [m]; what lies dead under them is not part of it (`Fittings`).
        angle: braid angle theta0 [rad], above 0 and below 90 deg, between a fibre and the parallels (the circles around
            the tube). Above 35.26 deg a long muscle contracts under pressure, below it extends (Eq. 31). With an
            `angle_profile` it is that at the first end.
        fibres: number N of fibres, both hands together: even.
        fibre: what one fibre is, a `Fibre`.
        joint: what holds fibres together where they cross, a `Joint`: "hinge" (the paper's) or "pin".
        angle_from: "axis" if the angle given is measured from the tube's axis, as in many other papers. It is
            converted: the `angle` of the braid is always from the parallels. What it was given from is remembered
            (`measured_from`): an angle given anew, by `Muscle.replace` or a sweep, means the same.
        angle_profile: `AngleProfile` of a braid whose angle varies along its length, or None for one angle.

    Raises:
        SpecError: for a value out of range, an odd number of fibres, or fibres so thick that they do not fit side by
            side, N/2 d > 2 pi R0 sin(theta0), or a profile beside an angle from the axis.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
    >>> braid = mk.Braid(radius="12.5 mm", length="85 mm", angle="53 deg", angle_from="axis", fibres=56, fibre=fibre)
    >>> round(braid.angle, 4)  # rad: 37 deg from the parallels
    0.6458
    """

    radius: Reads[float] = quantity(
        "m", meaning="radius R0 of the fibres' centre lines", low=0.0, low_open=True, size=(1e-6, 100.0),
        source="Eq. (11)", doubt=(1.0, 1e3),
    )  # fmt: skip
    length: Reads[float] = quantity(
        "m", meaning="length H0 of the braid between the fittings", low=0.0, low_open=True, size=(1e-6, 1e3),
        doubt=(10.0, 1e4),
    )  # fmt: skip
    angle: Reads[float] = quantity(
        "rad", meaning="braid angle theta0 between fibres and parallels", low=0.0, low_open=True, high=math.pi / 2.0,
        high_open=True, source="Eq. (11)",
        advice='give the angle from the parallels, or set angle_from = "axis"', explain=both_ways,
        doubt=(math.pi / 2.0, 90.0),
    )  # fmt: skip
    fibres: Reads[int] = count(
        meaning="number N of fibres, both hands together; even", low=2, high=100_000, advice="count both hands",
        read=_read_fibres,
    )  # fmt: skip
    fibre: Fibre = part(Fibre, meaning="what one fibre is")
    joint: Reads[Joint] = choice(
        Joint, meaning="what holds fibres together where they cross", default=Joint.HINGE, quiet=True,
        source="theory page, roll of the fibres",
    )  # fmt: skip
    angle_from: Reads[AngleFrom] = choice(
        AngleFrom, meaning="what the given angle is measured from", default=AngleFrom.PARALLELS, stored=False
    )
    angle_profile: AngleProfile | None = part(
        AngleProfile, meaning="how the braid angle goes on from the first end, none for one angle", default=None,
        quiet=True,
    )  # fmt: skip
    measured_from: Any = attrs.field(default=None, eq=False)
    """What the angle was given from, an `AngleFrom`: the words of whoever made the braid, beside its numbers."""

    def __attrs_post_init__(self) -> None:
        if self.measured_from is None:
            object.__setattr__(self, "measured_from", self.angle_from)
        object.__setattr__(self, "angle", from_parallels(self.angle, self.angle_from))
        object.__setattr__(self, "angle_from", AngleFrom.PARALLELS)
        check_angle(self.angle)
        if self.angle_profile is not None and self.measured_from == AngleFrom.AXIS:
            said = "is from the parallels, and does not go with an angle that is given from the axis"
            raise SpecError("braid.angle_profile", allowed=said, advice="give all angles from the parallels")
        if not is_traced(self.fibres) and self.fibres % 2:
            raise SpecError("braid.fibres", self.fibres, "must be even", "half of the fibres wind each way")
        check_angles(self)
        self._check_room()

    def __remark__(self) -> str:
        """What the angle means, both ways, for those who measure it the other way."""
        if not all(isinstance(angle, float) and 0.0 < angle < math.pi / 2.0 for angle in self.angles):
            return ""
        if self.angle_profile is not None:
            return between(*extremes(self))
        return f"{both_ways(self.angle)}: {tendency(self.angle)}"

    @property
    def angles(self) -> tuple[Number, ...]:
        """The braid angles that are given [rad]: at the first end, and those of a profile."""
        return (self.angle,) if self.angle_profile is None else (self.angle, *self.angle_profile.angle)

    def _check_room(self) -> None:
        """Raise unless neighbours of one hand, 2 pi R0 sin(theta0)/(N/2) apart, are at least a diameter apart."""
        diameter = self.fibre.diameter
        if diameter is None or any(is_traced(x) for x in (diameter, self.radius, self.fibres, *self.angles)):
            return
        least = self.angle if self.angle_profile is None else extremes(self)[0]
        room = 2.0 * math.pi * self.radius * math.sin(least)
        if self.fibres // 2 * diameter <= room:
            return
        pairs = math.floor(room / diameter)
        said = f"the fibres overlap: {self.fibres} of {show(diameter, 'm')} do not fit side by side"
        thinner = f"a diameter of at most {show(_rounded_down(2.0 * room / self.fibres), 'm')}"
        advice = f"use at most {2 * pairs} fibres or {thinner}" if pairs else f"use {thinner}"
        raise SpecError("braid.fibres", self.fibres, said, advice)


def _rounded_down(value: float) -> float:
    """`value` to six digits, rounded down, so that advice of "at most" this value can be followed."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return math.floor(value / step * (1.0 - 1e-12)) * step


@spec("muscle")
class Muscle:
    """A McKibben muscle: braid, chamber (None for a bare braid) and what the fittings hold.

    A muscle never changes, and two with the same numbers are equal. Numbers are stored in SI units; text with a unit
    ("12.5 mm") and pint quantities are read wherever a number is asked for. A muscle is a JAX pytree whose leaves are
    its numbers.

    Args:
        braid: the tube of fibres, a `Braid`.
        chamber: the elastomer tube, a `Chamber`, or None for a bare braid.
        ends: what the fittings hold, one of `Ends`: "clamped" (default), "pinned" or "free".
        fittings: `Fittings` that give way or hide a dead length, or None for neither.
        friction: `Friction` where fibres cross and of the chamber along the mesh, or None for the paper's, in which
            crossings turn freely and the chamber goes with the mesh.
        end_radii: radius of the fibres' centre lines on the fittings [m], where it is not that of the braid: one for
            both ends, or a list of that at the first end (v = 0) and that at the last. The braid is made as a cylinder
            and pushed over the fittings, so that it is strained there without any load; its own length stays that of
            the cylinder. Two radii, also two alike, are solved on the full length.
        name: a name for people, shown in tables and files.
        assumed: names of the fields ("braid.fibres") whose values are assumptions; tables, pictures and files mark
            them. A hardness (`Rubber`) always is among them: the stiffness is estimated from it.

    Raises:
        SpecError: for a part of the wrong kind, a name in `assumed` that is no field of this muscle, or a fitting that
            its braid cannot take.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
    >>> braid = mk.Braid(radius="12.5 mm", length="85 mm", angle="37 deg", fibres=56, fibre=fibre)
    >>> chamber = mk.Chamber(thickness="1 mm", law=mk.MooneyRivlin(c1="8.5 kPa"))
    >>> muscle = mk.Muscle(braid=braid, chamber=chamber, ends="clamped")
    >>> muscle.replace("braid.angle", "36 deg").braid.fibres
    56
    >>> muscle.replace("end_radii", ["12.5 mm", "9 mm"]).end_radii  # m
    (0.0125, 0.009)
    """

    braid: Braid = part(Braid, meaning="the tube of fibres")
    chamber: Chamber | None = part(Chamber, meaning="the elastomer tube, none for a bare braid", default=None)
    ends: Reads[Ends] = choice(Ends, meaning="what the fittings hold", default=Ends.CLAMPED)
    fittings: Fittings | None = part(
        Fittings, meaning="what the fittings add in series, none for nothing", default=None, quiet=True
    )
    friction: Friction | None = part(Friction, meaning="friction where fibres cross", default=None, quiet=True)
    end_radii: Reads[tuple[float, ...] | None] = quantities(
        "m", meaning="radii that the fittings hold, none for that of the braid", low=0.0, low_open=True,
        size=(1e-6, 100.0), source="theory page, fittings of another radius", default=None, doubt=(1.0, 1e3),
        read=read_radii,
    )  # fmt: skip
    name: str | None = words(meaning="a name for people", default=None)
    assumed: tuple[str, ...] = words(meaning="names of fields whose values are assumptions", many=True, default=())

    def __attrs_post_init__(self) -> None:
        law = None if self.chamber is None else self.chamber.law
        estimated = [f"chamber.law.{name}" for name in getattr(law, "estimated", ())]
        missing = tuple(field for field in estimated if field not in self.assumed)
        object.__setattr__(self, "assumed", (*self.assumed, *missing))
        known = [field for field, _, _ in walk(self) if field not in ("name", "assumed")]
        for field in self.assumed:
            if field not in known:
                raise SpecError("muscle.assumed", field, "is no field of this muscle", nearest(field, known))
        check_friction(self.friction, self.braid.fibre.diameter, self.chamber)
        check_muscle(self)
        check_end_radii(self)
        check_profile(self)

    def __remark__(self) -> str:
        """What the braid angle means."""
        return self.braid.__remark__()

    @property
    def rest_length(self) -> Number:
        """Length between the fittings as made [m]: H0 of the braid, and the dead length of the fittings."""
        dead = None if self.fittings is None else self.fittings.dead_length
        return self.braid.length if dead is None else self.braid.length + dead

    @property
    def gives_way(self) -> bool:
        """Whether the fittings give way."""
        return self.fittings is not None and self.fittings.compliance is not None

    def replace(self, field: str, value: Any) -> Muscle:
        """A new muscle with one field changed: muscle.replace("braid.angle", "36 deg").

        Args:
            field: dotted name of the field, or of a whole part ("chamber.law").
            value: the new value, as the field itself takes it. An angle is measured from what this muscle's own was
                given from; with "braid.angle_from" the number stays, and is measured from there.

        Returns:
            A new muscle. The field and all within it are no longer `assumed`, and " (changed)" is added to the name.

        Raises:
            SpecError: for an unknown name or a value out of range.
        """
        muscle: Muscle = changed_muscle(self, {field: value})
        return muscle
