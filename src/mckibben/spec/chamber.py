"""The chamber as its maker describes it: a wall on the braid's own radius, or a tube as sold."""

from __future__ import annotations

import math
from enum import StrEnum

from mckibben.spec.bellows import Bellows
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, part, quantity, spec, switch
from mckibben.spec.laws import LAWS, Law
from mckibben.units import Number, is_traced, show

__all__ = ["Chamber", "Side", "Wall"]


class Side(StrEnum):
    """On which side of the fibres' radius the wall lies: outside as in the paper, or inside as in real muscles."""

    OUTSIDE = "outside"
    INSIDE = "inside"


class Wall(StrEnum):
    """How the wall is taken: all of it at the stretches where it rides on the braid, or integrated through."""

    THIN = "thin"
    THICK = "thick"


_DIAMETERS = ("outer_diameter", "inner_diameter")


@spec("chamber")
class Chamber:
    """The incompressible elastomer tube of the braid, which goes with the braid everywhere, or may leave it.

    Either a `thickness`: the wall is made on the radius R0 of the braid, outside of it with a cross-section of
    A0 = pi t0 (t0 + 2 R0) (Eq. 26), or inside of it with A0 = pi t0 (2 R0 - t0). Or the two diameters of a tube as
    sold, which is smaller than the braid. Until it has been blown up to the braid a real tube does not touch it. The
    model holds the two together, so that the tube is stretched from the start, by R0 over its outer radius, and
    `contact_pressure` in a result tells where a real one would not touch; or, with `gap`, lets it have a radius of its
    own until it touches: `contact` in a result is the share of the length where it does.

    Args:
        thickness: wall thickness t0 as made [m], above 0.
        law: hyperelastic law of the elastomer: `MooneyRivlin`, `NeoHookean`, `Yeoh`, `Ogden`, `Gent`, `ArrudaBoyce`,
            `CustomLaw`, or `Rubber` where nothing was tested; or `Bellows`, which store energy by their length alone
            and need neither thickness nor diameters.
        lies: side of the fibres' radius R0 on which the wall lies: "outside", the paper's, or "inside". Where it is
            left out: outside with a thickness, inside with diameters (which know no outside).
        outer_diameter: diameter over the unstretched tube [m], at most 2 R0; instead of a thickness.
        inner_diameter: diameter of its bore [m], below the outer one.
        length: length of the unstretched tube that is mounted between the fittings [m]; that of the braid, H0, where
            it is left out. A shorter one is stretched from the start, by H0 over it.
        wall: "thin" (the paper's, and where it is left out): the whole wall has the stretches of where it rides on the
            braid. "thick": its stretches are those of an incompressible tube, integrated through the wall.
        gap: whether a chamber inside may leave the braid: then it is a tube blown up alone until it touches, and what
            it has of the braid is the axial stretch beside it. Volumes are then those inside its outer face.

    Raises:
        SpecError: for a value out of range, a law that is none of these, a thickness beside diameters, or half of
            these; for a gap of a chamber that lies outside; for bellows with a gap or a thick wall.

    >>> chamber = mk.Chamber(thickness="1 mm", law=mk.MooneyRivlin(c1="8.5 kPa"))
    >>> chamber.thickness  # m
    0.001
    >>> tube = mk.Chamber(outer_diameter="8 mm", inner_diameter="6 mm", wall="thick", law=mk.NeoHookean(c1="0.1 MPa"))
    >>> tube.inside
    True
    """

    thickness: Reads[float | None] = quantity(
        "m",
        meaning="wall thickness t0 as made",
        low=0.0,
        low_open=True,
        size=(1e-8, 10.0),
        source="Eq. (26)",
        doubt=(0.1, 100.0),
        default=None,
    )
    law: Law = part(*LAWS.values(), meaning="hyperelastic law of the elastomer", kw_only=True)
    lies: Reads[Side | None] = choice(
        Side, meaning="side of the fibres' radius on which the wall lies; outside, with diameters inside", default=None
    )
    outer_diameter: Reads[float | None] = quantity(
        "m", meaning="diameter over the unstretched tube", low=0.0, low_open=True, size=(1e-7, 100.0), default=None,
        doubt=(1.0, 1e3),
    )  # fmt: skip
    inner_diameter: Reads[float | None] = quantity(
        "m", meaning="diameter of the unstretched tube's bore", low=0.0, low_open=True, size=(1e-8, 100.0),
        default=None, doubt=(0.5, 1e3),
    )  # fmt: skip
    length: Reads[float | None] = quantity(
        "m", meaning="length of the unstretched tube between the fittings; that of the braid", low=0.0, low_open=True,
        size=(1e-6, 1e3), default=None, doubt=(10.0, 1e4),
    )  # fmt: skip
    wall: Reads[Wall | None] = choice(Wall, meaning="how the wall is taken; thin", default=None)
    gap: Reads[bool] = switch(
        meaning="whether a chamber inside may leave the braid until it is blown up to it", default=False
    )

    def __attrs_post_init__(self) -> None:
        given = [name for name in _DIAMETERS if getattr(self, name) is not None]
        both = "give either thickness, or outer_diameter and inner_diameter"
        if self.thickness is not None and given:
            raise SpecError("chamber", allowed=f"both thickness and {' and '.join(given)} are given", advice=both)
        if isinstance(self.law, Bellows):
            self._check_bellows()
        elif self.thickness is None and not given:
            raise SpecError("chamber.thickness", allowed="is missing: wall thickness t0 as made", advice=both)
        if len(given) == 1:
            missing = next(name for name in _DIAMETERS if name not in given)
            raise SpecError(f"chamber.{missing}", allowed=f"is missing beside {given[0]}", advice=both)
        if self.gap and not self.inside:
            said = "needs a chamber inside the braid: the wall of this one lies around the fibres and goes with them"
            advice = 'give the diameters of a tube, or lies = "inside", or leave gap out'
            raise SpecError("chamber.gap", "true", said, advice)
        if self.outer_diameter is None or self.inner_diameter is None:
            return
        if self.lies == Side.OUTSIDE:
            said = "a tube with diameters of its own lies inside the braid"
            raise SpecError(
                "chamber.lies", "outside", said, "leave lies out, or give a thickness in place of diameters"
            )
        known = not is_traced(self.outer_diameter) and not is_traced(self.inner_diameter)
        if known and not self.inner_diameter < self.outer_diameter:
            said = f"must be below the outer diameter, {show(self.outer_diameter, 'm')}"
            raise SpecError("chamber.inner_diameter", show(self.inner_diameter, "m"), said, "leave some wall")

    def _check_bellows(self) -> None:
        """SpecError for what bellows cannot have."""
        advice = "leave it out, or take the law of a rubber"
        if self.thick:
            said = "does not go with bellows: what their folds store is not told by the stretches through a wall"
            raise SpecError("chamber.wall", "thick", said, advice)
        if self.gap:
            said = "does not go with bellows: they grow wider at no pressure at all, so that nothing leaves a gap"
            raise SpecError("chamber.gap", "true", said, advice)

    @property
    def own(self) -> bool:
        """Whether it is another chamber than the paper's: inside, thick, or stretched as mounted."""
        return self.inside or self.thick or self.length is not None

    @property
    def inside(self) -> bool:
        """Whether the wall lies inside the radius of the fibres."""
        return self.lies == Side.INSIDE or self.outer_diameter is not None

    @property
    def thick(self) -> bool:
        """Whether the wall is integrated through its thickness."""
        return self.wall == Wall.THICK

    def riding_radius(self, R0: Number) -> Number:
        """Radius as made [m] of the face that rides on the braid of radius R0 [m]."""
        return R0 if self.outer_diameter is None else self.outer_diameter / 2.0

    @property
    def wall_thickness(self) -> Number:
        """Thickness of the wall as made [m]; None of bellows whose wall is not told."""
        if self.outer_diameter is None or self.inner_diameter is None:
            return self.thickness
        return (self.outer_diameter - self.inner_diameter) / 2.0

    def area(self, R0: Number) -> Number:
        """Cross-section of the wall as made [m^2], in a braid of radius R0 [m]."""
        t, R = self.wall_thickness, self.riding_radius(R0)
        if t is None:
            return 0.0 * R0
        return math.pi * t * (2.0 * R - t if self.inside else t + 2.0 * R)

    def other_face(self, R0: Number) -> Number:
        """(Radius of the face that does not ride on the braid over that of the one that does)^2, as made."""
        share = self.wall_thickness / self.riding_radius(R0)
        return (1.0 - share) ** 2 if self.inside else (1.0 + share) ** 2

    def stretches(self, R0: Number, H0: Number) -> tuple[Number, Number]:
        """Hoop and axial stretch at which the face that rides on the braid is mounted, in a braid of R0 and H0 [m]."""
        hoop = 1.0 if self.outer_diameter is None else R0 / self.riding_radius(R0)
        return hoop, 1.0 if self.length is None else H0 / self.length
