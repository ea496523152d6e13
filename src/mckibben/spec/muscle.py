"""The muscle as its maker describes it: `Fibre`, `Braid`, `Chamber`, `Ends`, `Muscle`. Immutable, compared by value."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import Any

import attrs

from mckibben.spec.angle import AngleFrom, both_ways, from_parallels, tendency
from mckibben.spec.change import changed_muscle
from mckibben.spec.declared import Reads, walk
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.fields import choice, count, part, quantity, spec, switch, words
from mckibben.spec.fittings import Fittings
from mckibben.spec.friction import Friction, check_friction
from mckibben.spec.laws import LAWS, Law
from mckibben.spec.limits import BENDING, check_angle, check_muscle
from mckibben.units import Number, is_traced, show

__all__ = ["Braid", "Chamber", "Ends", "Fibre", "Joint", "Muscle", "Natural"]


class Ends(StrEnum):
    """What the fittings hold: radius and slope (clamped), the radius only (pinned), nothing (free).

    With the braid angle theta and the slope angle psi of the wall, at both ends:

    CLAMPED: theta = theta0 and psi = 0; the fibres are built into the fitting. The default.
    PINNED: theta = theta0; the radius is held, the fibres swing freely.
    FREE: the radius is free. Away from the ends the muscle is the uniform cylinder of the textbooks.

    The words do as well: `ends="pinned"` is read as Ends.PINNED and compares equal to it. Another word is a SpecError.

    >>> muscle = mk.presets.paper().replace("ends", "pinned")
    >>> muscle.ends == mk.Ends.PINNED == "pinned"
    True
    """

    CLAMPED = "clamped"
    PINNED = "pinned"
    FREE = "free"


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


class Natural(StrEnum):
    """The shape of a fibre without stress: the helix of the braid as made, or a straight rod."""

    HELICAL = "helical"
    STRAIGHT = "straight"


_ROUND = ("diameter", "E", "nu")
"""What a round solid fibre is given by."""
_GIVEN = ("B1", "B2", "B3")
"""What a fibre of any section is given by."""
_STRETCH = "theory page, stretch of the fibres"
_ENERGY = "Eqs. (20-28)"
"""Source of the stiffnesses: the energy of the paper."""


@spec("braid.fibre")
class Fibre:
    """One fibre: round and solid (diameter, E, nu), or any section by its stiffnesses (B1, B2, B3).

    A round solid fibre has B1 = B2 = E pi d^4/64 and B3 = G pi d^4/32 with G = E/(2 (1 + nu)). The energy that B1, B2,
    B3 multiply is Eq. (20) of the paper. Give all of one way and nothing of the other. The paper's fibres do not
    stretch; with `stretch` they do, by T = EA (lambda - 1) at stretch lambda (theory page).

    Args:
        diameter: diameter d of the fibre [m]. Beside B1, B2, B3 it may be given too; it then serves only to check that
            the fibres fit side by side and when they touch.
        E: Young's modulus [Pa].
        nu: Poisson's ratio, above -1 and at most 0.5.
        B1: bending stiffness in the tangent plane of the tube [N m^2].
        B2: bending stiffness normal to the tube [N m^2].
        B3: torsional stiffness [N m^2].
        breaking_force: tension that breaks one fibre [N]. Only compared with the tension found: see `cautions`.
        natural: shape of the fibre without stress, "helical" (as braided, the paper's) or "straight".
        stretch: True if the fibres stretch; False is the paper's.
        axial_stiffness: EA [N], tension over strain; of a round solid fibre it is E pi d^2/4 where it is not given.
        slack: True if a fibre that stretches carries no compression, as yarns do.

    Raises:
        SpecError: for a value out of range, both ways at once, or half of one; for a stretching fibre whose EA is
            unknown, or an axial stiffness of one that does not stretch.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
    >>> [round(1e6 * B, 3) for B in fibre.stiffnesses]  # in N mm^2
    [0.575, 0.575, 0.411]
    """

    diameter: Reads[float | None] = quantity(
        "m",
        meaning="diameter of the round solid fibre",
        low=0.0,
        low_open=True,
        size=(1e-7, 0.1),
        default=None,
        doubt=(0.05, 50.0),
    )
    E: Reads[float | None] = quantity(
        "Pa", meaning="Young's modulus", low=0.0, low_open=True, size=(1e3, 1e13), display="GPa", default=None
    )
    nu: Reads[float | None] = quantity("1", meaning="Poisson's ratio", low=-1.0, low_open=True, high=0.5, default=None)
    B1: Reads[float | None] = quantity(
        "N m^2",
        meaning="bending stiffness in the tangent plane of the tube",
        low=0.0,
        size=BENDING,
        source=_ENERGY,
        default=None,
    )
    B2: Reads[float | None] = quantity(
        "N m^2", meaning="bending stiffness normal to the tube", low=0.0, size=BENDING, source=_ENERGY, default=None
    )
    B3: Reads[float | None] = quantity(
        "N m^2", meaning="torsional stiffness", low=0.0, size=BENDING, source=_ENERGY, default=None
    )
    breaking_force: Reads[float | None] = quantity(
        "N", meaning="tension that breaks one fibre", low=0.0, low_open=True, size=(1e-9, 1e9), default=None
    )
    natural: Reads[Natural] = choice(Natural, meaning="shape of the fibre without stress", default=Natural.HELICAL)
    stretch: Reads[bool] = switch(meaning="whether the fibres stretch", source=_STRETCH, default=False)
    axial_stiffness: Reads[float | None] = quantity(
        "N", meaning="axial stiffness EA of one fibre", low=0.0, low_open=True, size=(1e-6, 1e12), source=_STRETCH,
        default=None,
    )  # fmt: skip
    slack: Reads[bool] = switch(
        meaning="whether a fibre that stretches carries no compression", source=_STRETCH, default=False
    )

    def __attrs_post_init__(self) -> None:
        given = [name for name in _GIVEN if getattr(self, name) is not None]
        material = [name for name in ("E", "nu") if getattr(self, name) is not None]
        if given and material:
            said = f"both {' and '.join(given)} and {' and '.join(material)} are given"
            raise SpecError("braid.fibre", allowed=said, advice="give either diameter, E, nu or B1, B2, B3")
        way = _GIVEN if given else _ROUND
        missing = [name for name in way if getattr(self, name) is None]
        if missing:
            other = "diameter, E, nu" if given else "B1, B2, B3"
            said = f"{' and '.join(missing)} missing"
            raise SpecError("braid.fibre", allowed=said, advice=f"give all of {', '.join(way)} (or instead {other})")
        self._check_stretch()

    def _check_stretch(self) -> None:
        """Raise for an axial stiffness or slack without stretch, or stretch without stiffness."""
        if self.stretch and self.B1 is not None and self.axial_stiffness is None:
            said = "is missing: B1, B2, B3 do not tell how stiff a fibre is along its length"
            raise SpecError("braid.fibre.axial_stiffness", allowed=said, advice="give EA, such as 147 N")
        idle = [name for name in ("axial_stiffness", "slack") if getattr(self, name)] if not self.stretch else []
        if idle:
            said = "means something only for fibres that stretch"
            advice = "set stretch to true, or leave it out"
            raise SpecError(f"braid.fibre.{idle[0]}", getattr(self, idle[0]), said, advice)

    @property
    def is_round(self) -> bool:
        """Whether the stiffnesses follow from diameter, E and nu."""
        return self.B1 is None

    @property
    def stiffnesses(self) -> tuple[Number, Number, Number]:
        """B1, B2, B3 [N m^2]; round: B1 = B2 = E pi d^4/64, B3 = G pi d^4/32, G = E/(2 (1 + nu))."""
        if self.B1 is not None and self.B2 is not None and self.B3 is not None:
            return self.B1, self.B2, self.B3
        assert self.diameter is not None
        assert self.E is not None
        assert self.nu is not None
        bending = self.E * math.pi * self.diameter**4 / 64.0
        return bending, bending, bending / (1.0 + self.nu)

    @property
    def EA(self) -> Number | None:  # noqa: N802
        """Axial stiffness [N], as given or E pi d^2/4; None for a fibre that does not stretch."""
        if not self.stretch or self.axial_stiffness is not None:
            return self.axial_stiffness
        assert self.diameter is not None
        assert self.E is not None
        return self.E * math.pi * self.diameter**2 / 4.0


@spec("braid")
class Braid:
    """The tube of helical fibres, half of each hand, as made: every length and angle is that of the reference state.

    Fibres are evenly spaced helices that do not slide where they cross (the paper's section II; radius and angle: Eq.
    11).

    Args:
        radius: radius R0 of the fibres' centre lines [m].
        length: length H0 between the fittings [m].
        angle: braid angle theta0 [rad], above 0 and below 90 deg, between a fibre and the parallels (the circles around
            the tube). Above 35.26 deg a long muscle contracts under pressure, below it extends (Eq. 31).
        fibres: number N of fibres, both hands together: even.
        fibre: what one fibre is, a `Fibre`.
        joint: what holds fibres together where they cross, a `Joint`: "hinge" (the paper's) or "pin".
        angle_from: "axis" if the angle given is measured from the tube's axis, as in many other papers. It is
            converted: the `angle` of the braid is always from the parallels. What it was given from is remembered
            (`measured_from`): an angle given anew, by `Muscle.replace` or a sweep, means the same.

    Raises:
        SpecError: for a value out of range, an odd number of fibres, or fibres so thick that they do not fit side by
            side, N/2 d > 2 pi R0 sin(theta0).

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
        "m", meaning="length H0 between the fittings", low=0.0, low_open=True, size=(1e-6, 1e3), doubt=(10.0, 1e4)
    )
    angle: Reads[float] = quantity(
        "rad", meaning="braid angle theta0 between fibres and parallels", low=0.0, low_open=True, high=math.pi / 2.0,
        high_open=True, source="Eq. (11)",
        advice='give the angle from the parallels, or set angle_from = "axis"', explain=both_ways,
        doubt=(math.pi / 2.0, 90.0),
    )  # fmt: skip
    fibres: Reads[int] = count(
        meaning="number N of fibres, both hands together; even", low=2, high=100_000, advice="count both hands"
    )
    fibre: Fibre = part(Fibre, meaning="what one fibre is")
    joint: Reads[Joint] = choice(
        Joint, meaning="what holds fibres together where they cross", default=Joint.HINGE, quiet=True,
        source="theory page, roll of the fibres",
    )  # fmt: skip
    angle_from: Reads[AngleFrom] = choice(
        AngleFrom, meaning="what the given angle is measured from", default=AngleFrom.PARALLELS, stored=False
    )
    measured_from: Any = attrs.field(default=None, eq=False)
    """What the angle was given from, an `AngleFrom`: the words of whoever made the braid, beside its numbers."""

    def __attrs_post_init__(self) -> None:
        if self.measured_from is None:
            object.__setattr__(self, "measured_from", self.angle_from)
        object.__setattr__(self, "angle", from_parallels(self.angle, self.angle_from))
        object.__setattr__(self, "angle_from", AngleFrom.PARALLELS)
        check_angle(self.angle)
        if not is_traced(self.fibres) and self.fibres % 2:
            raise SpecError("braid.fibres", self.fibres, "must be even", "half of the fibres wind each way")
        self._check_room()

    def __remark__(self) -> str:
        """What the angle means, both ways, for those who measure it the other way."""
        known = isinstance(self.angle, float) and 0.0 < self.angle < math.pi / 2.0
        return f"{both_ways(self.angle)}: {tendency(self.angle)}" if known else ""

    def _check_room(self) -> None:
        """Raise unless neighbours of one hand, 2 pi R0 sin(theta0)/(N/2) apart, are at least a diameter apart."""
        diameter = self.fibre.diameter
        if diameter is None or any(is_traced(x) for x in (diameter, self.radius, self.angle, self.fibres)):
            return
        room = 2.0 * math.pi * self.radius * math.sin(self.angle)
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


@spec("chamber")
class Chamber:
    """The incompressible elastomer tube inside the braid.

    A thin wall that touches the braid everywhere and deforms with it. Its cross-section as made is
    A0 = pi t0 (t0 + 2 R0), where R0 is the radius of the braid (Eq. 26).

    Args:
        thickness: wall thickness t0 as made [m], above 0.
        law: hyperelastic law of the elastomer: `MooneyRivlin`, `NeoHookean`, `Yeoh`, `Ogden`, `Gent`, `ArrudaBoyce`,
            `CustomLaw`, or `Rubber` where nothing was tested.

    Raises:
        SpecError: for a thickness out of range, or a law that is none of these.

    >>> chamber = mk.Chamber(thickness="1 mm", law=mk.MooneyRivlin(c1="8.5 kPa"))
    >>> chamber.thickness  # m
    0.001
    """

    thickness: Reads[float] = quantity(
        "m",
        meaning="wall thickness t0 as made",
        low=0.0,
        low_open=True,
        size=(1e-8, 10.0),
        source="Eq. (26)",
        doubt=(0.1, 100.0),
    )
    law: Law = part(*LAWS.values(), meaning="hyperelastic law of the elastomer")


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
        fittings: `Fittings` that give way, or None for rigid ones.
        friction: `Friction` where fibres cross, or None for the paper's, which turn freely.
        name: a name for people, shown in tables and files.
        assumed: names of the fields ("braid.fibres") whose values are assumptions; tables, pictures and files mark
            them. A hardness (`Rubber`) always is among them: the stiffness is estimated from it.

    Raises:
        SpecError: for a part of the wrong kind, or a name in `assumed` that is no field of this muscle.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4)
    >>> braid = mk.Braid(radius="12.5 mm", length="85 mm", angle="37 deg", fibres=56, fibre=fibre)
    >>> chamber = mk.Chamber(thickness="1 mm", law=mk.MooneyRivlin(c1="8.5 kPa"))
    >>> muscle = mk.Muscle(braid=braid, chamber=chamber, ends="clamped")
    >>> muscle.replace("braid.angle", "36 deg").braid.fibres
    56
    """

    braid: Braid = part(Braid, meaning="the tube of fibres")
    chamber: Chamber | None = part(Chamber, meaning="the elastomer tube, none for a bare braid", default=None)
    ends: Reads[Ends] = choice(Ends, meaning="what the fittings hold", default=Ends.CLAMPED)
    fittings: Fittings | None = part(
        Fittings, meaning="fittings that give way, none for rigid ones", default=None, quiet=True
    )
    friction: Friction | None = part(Friction, meaning="friction where fibres cross", default=None, quiet=True)
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
        check_friction(self.friction, self.braid.fibre.diameter)
        check_muscle(self)

    def __remark__(self) -> str:
        """What the braid angle means."""
        return self.braid.__remark__()

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
