"""The muscle as its maker describes it: `Fibre`, `Braid`, `Chamber`, `Ends`, `Muscle`. Immutable, compared by value."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import Any

from mckibben.spec.declared import Reads, describe, evolved, walk
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.fields import choice, count, part, quantity, spec, words
from mckibben.spec.laws import CustomLaw, Gent, Law, MooneyRivlin, NeoHookean, Ogden, Yeoh
from mckibben.units import Number, is_traced, show

__all__ = ["AngleFrom", "Braid", "Chamber", "Ends", "Fibre", "Muscle", "Natural"]


class Ends(StrEnum):
    """What the fittings hold: radius and slope (clamped), the radius only (pinned), nothing (free)."""

    CLAMPED = "clamped"
    PINNED = "pinned"
    FREE = "free"


class Natural(StrEnum):
    """The shape of a fibre without stress: the helix of the braid as made, or a straight rod."""

    HELICAL = "helical"
    STRAIGHT = "straight"


class AngleFrom(StrEnum):
    """What the braid angle is measured from: the parallels (circles around the tube) or the tube's axis."""

    PARALLELS = "parallels"
    AXIS = "axis"


CHANGED = " (changed)"
"""Added to the name of a muscle that is no longer what its name says."""

_ROUND = ("diameter", "E", "nu")
_GIVEN = ("B1", "B2", "B3")
_ENERGY = "Eqs. (20-28)"


@spec("braid.fibre")
class Fibre:
    """One fibre: round and solid (diameter, E, nu), or any section by its stiffnesses (B1, B2, B3).

    With B1, B2, B3 a diameter may be added; it then serves only to check that the fibres fit side by side.
    """

    diameter: Reads[float | None] = quantity(
        "m", meaning="diameter of the round solid fibre", low=0.0, low_open=True, default=None
    )
    E: Reads[float | None] = quantity(
        "Pa", meaning="Young's modulus", low=0.0, low_open=True, display="GPa", default=None
    )
    nu: Reads[float | None] = quantity("1", meaning="Poisson's ratio", low=-1.0, low_open=True, high=0.5, default=None)
    B1: Reads[float | None] = quantity(
        "N m^2", meaning="bending stiffness in the tangent plane of the tube", low=0.0, source=_ENERGY, default=None
    )
    B2: Reads[float | None] = quantity(
        "N m^2", meaning="bending stiffness normal to the tube", low=0.0, source=_ENERGY, default=None
    )
    B3: Reads[float | None] = quantity("N m^2", meaning="torsional stiffness", low=0.0, source=_ENERGY, default=None)
    breaking_force: Reads[float | None] = quantity(
        "N", meaning="tension that breaks one fibre", low=0.0, low_open=True, default=None
    )
    natural: Reads[Natural] = choice(Natural, meaning="shape of the fibre without stress", default=Natural.HELICAL)

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


@spec("braid")
class Braid:
    """The tube of helical fibres, half of each hand, as made: every length and angle is that of the reference state.

    The angle is stored from the parallels; angle_from="axis" is converted here and nowhere else.
    """

    radius: Reads[float] = quantity(
        "m", meaning="radius R0 of the fibres' centre lines", low=0.0, low_open=True, source="Eq. (11)"
    )
    length: Reads[float] = quantity("m", meaning="length H0 between the fittings", low=0.0, low_open=True)
    angle: Reads[float] = quantity(
        "rad", meaning="braid angle theta0 between fibres and parallels", low=0.0, low_open=True, high=math.pi / 2.0,
        high_open=True, source="Eq. (11)",
        advice='give the angle from the parallels, or set angle_from = "axis"',
    )  # fmt: skip
    fibres: Reads[int] = count(
        meaning="number N of fibres, both hands together; even", low=2, high=100_000, advice="count both hands"
    )
    fibre: Fibre = part(Fibre, meaning="what one fibre is")
    angle_from: Reads[AngleFrom] = choice(
        AngleFrom, meaning="what the given angle is measured from", default=AngleFrom.PARALLELS, stored=False
    )

    def __attrs_post_init__(self) -> None:
        if self.angle_from == AngleFrom.AXIS:
            object.__setattr__(self, "angle", math.pi / 2.0 - self.angle)
            object.__setattr__(self, "angle_from", AngleFrom.PARALLELS)
        if not is_traced(self.fibres) and self.fibres % 2:
            raise SpecError("braid.fibres", self.fibres, "must be even", "half of the fibres wind each way")
        self._check_room()

    def _check_room(self) -> None:
        """Same-hand neighbours lie 2 pi R0 sin(theta0)/(N/2) apart across the fibre; less than a diameter cannot be."""
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
    """Six digits, never above `value`, so that the advice given can be followed."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return math.floor(value / step * (1.0 - 1e-12)) * step


@spec("chamber")
class Chamber:
    """The incompressible elastomer tube inside the braid."""

    thickness: Reads[float] = quantity(
        "m", meaning="wall thickness t0 as made", low=0.0, low_open=True, source="Eq. (26)"
    )
    law: Law = part(MooneyRivlin, NeoHookean, Yeoh, Ogden, Gent, CustomLaw, meaning="hyperelastic law of the elastomer")


@spec("muscle")
class Muscle:
    """A McKibben muscle: braid, chamber (None for a bare braid) and what the fittings hold.

    `assumed` names the fields ("braid.fibres") whose values are assumptions; they are marked wherever they show.
    """

    braid: Braid = part(Braid, meaning="the tube of fibres")
    chamber: Chamber | None = part(Chamber, meaning="the elastomer tube, none for a bare braid", default=None)
    ends: Reads[Ends] = choice(Ends, meaning="what the fittings hold", default=Ends.CLAMPED)
    name: str | None = words(meaning="a name for people", default=None)
    assumed: tuple[str, ...] = words(meaning="names of fields whose values are assumptions", many=True, default=())

    def __attrs_post_init__(self) -> None:
        known = [field for field, _, _ in walk(self) if field not in ("name", "assumed")]
        for field in self.assumed:
            if field not in known:
                raise SpecError("muscle.assumed", field, "is no field of this muscle", nearest(field, known))

    def replace(self, field: str, value: Any) -> Muscle:
        """A new muscle with one field changed: muscle.replace("braid.angle", "36 deg").

        The field, and all within it, leaves `assumed`; the name says that the muscle was changed. Raises SpecError for
        an unknown name or a value out of range.
        """
        kept = tuple(name for name in self.assumed if name != field and not name.startswith(field + "."))
        # Names that would no longer exist must be gone before the new muscle is checked.
        changed = _replaced(evolved(self, assumed=()), field.split("."), value, "")
        if field == "assumed":
            return changed
        left = {name for name, _, _ in walk(changed)}
        if changed.name and field != "name" and not changed.name.endswith(CHANGED):
            changed = evolved(changed, name=changed.name + CHANGED)
        return evolved(changed, assumed=tuple(name for name in kept if name in left))


def _replaced(owner: Any, names: list[str], value: Any, prefix: str) -> Any:
    head, rest = names[0], names[1:]
    fields = {field.name: field for field in describe(type(owner)) if field.stored}
    if head not in fields or (rest and fields[head].kind != "part"):
        options = [prefix + name for name in fields] + [f"{prefix}{name}" for name, _, _ in walk(owner)]
        full = prefix + ".".join(names)
        raise SpecError(full, allowed="is no field of this muscle", advice=nearest(full, dict.fromkeys(options)))
    if rest:
        inner = getattr(owner, head)
        if inner is None:
            said = f"this muscle has no {head}"
            raise SpecError(prefix + ".".join(names), value, said, f"give the whole {head} first")
        value = _replaced(inner, rest, value, f"{prefix}{head}.")
    return evolved(owner, **{head: value})
