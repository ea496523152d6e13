"""`AngleProfile`: a braid angle that varies along the length as made, as a programmed braider makes it."""

from __future__ import annotations

import itertools
import math
from enum import StrEnum
from typing import Any

from mckibben.spec.declared import Declared, Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, quantities, read_quantity, spec, switch
from mckibben.spec.limits import FLATTEST, check_angle
from mckibben.spec.winding import extremes
from mckibben.units import Number, is_traced, show

__all__ = ["AngleProfile", "Between", "certainly_rises", "check_angles", "check_profile"]

_SOURCE = "theory page, a programmed braid"
_MOST = 100


def _read_angles(value: Any, field: str, declared: Declared) -> tuple[Number, ...]:
    """One angle or several, as SI floats."""
    if isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) == 1:
        return tuple(read_quantity(item, f"{field}[{k}]", declared) for k, item in enumerate(value))
    return (read_quantity(value, field, declared),)


class Between(StrEnum):
    """How the angle goes on between the places of an `AngleProfile`.

    SPLINE: the cubic spline through the angles (as SciPy's `CubicSpline`): smooth, but it may swing beyond them.
    MONOTONE: the monotone cubic of Fritsch and Carlson (as SciPy's PCHIP): nowhere beyond the angles on either side,
    but its curvature jumps at the places, so that states take more unknowns or are good to fewer digits.
    """

    SPLINE = "spline"
    MONOTONE = "monotone"


@spec("braid.angle_profile")
class AngleProfile:
    """Braid angles at places along the braid as made; at its first end it has the `angle` of the `Braid`.

    Between the places the angle goes on smoothly, as `between` says. Asks for fibres that stretch.

    Args:
        angle: braid angle [rad] at each of the places, above 0 and below 90 deg, from the parallels.
        at: where they are, as shares of the length of the braid from its first end (v/H0), rising. The last one is 1,
            the other end, or 0.5, mid-length, where the profile is mirrored. Left out: evenly spaced.
        mirrored: True if the second half of the braid is the mirror image of the first, which is then solved on half
            the length.
        between: "spline" or "monotone": how the angle goes on between the places.

    Raises:
        SpecError: for an angle or a place out of range, places that do not rise or do not end where they should, or
            not as many places as angles.

    >>> profile = mk.AngleProfile(at=[0.2, 0.5], angle=["37 deg", "48 deg"], mirrored=True)
    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stretch=True)
    >>> braid = mk.Braid(
    ...     radius="12.5 mm", length="85 mm", angle="37 deg", angle_profile=profile, fibres=56, fibre=fibre
    ... )
    >>> braid.angle_profile.places
    (0.2, 0.5)
    """

    angle: Reads[tuple[float, ...]] = quantities(
        "rad", meaning="braid angle at each place, from the parallels", low=0.0, low_open=True, high=math.pi / 2.0,
        high_open=True, source=_SOURCE, advice="give angles from the parallels", doubt=(math.pi / 2.0, 90.0),
        read=_read_angles,
    )  # fmt: skip
    at: Reads[tuple[float, ...] | None] = quantities(
        "1", meaning="places, as shares of the length from the first end; none for evenly spaced", low=0.0,
        low_open=True, high=1.0, source=_SOURCE, default=None,
    )  # fmt: skip
    mirrored: Reads[bool] = switch(meaning="whether the second half mirrors the first", source=_SOURCE, default=False)

    between: Reads[Between] = choice(
        Between, meaning="how the angle goes on between the places", default=Between.SPLINE, quiet=True, source=_SOURCE
    )

    def __attrs_post_init__(self) -> None:
        if len(self.angle) > _MOST:
            raise SpecError("braid.angle_profile.angle", f"{len(self.angle)} angles", f"must be at most {_MOST}")
        for k, angle in enumerate(self.angle):
            check_angle(angle, f"braid.angle_profile.angle[{k}]")
        if self.at is None or any(map(is_traced, self.at)):
            return
        if len(self.at) != len(self.angle):
            said = f"must have as many numbers as angle ({len(self.angle)})"
            raise SpecError("braid.angle_profile.at", self.at, said)
        for k in range(1, len(self.at)):
            if self.at[k] <= self.at[k - 1]:
                said = f"must be above the number before it, {self.at[k - 1]:g}"
                raise SpecError(f"braid.angle_profile.at[{k}]", self.at[k], said, "sort the places")
        if self.at[-1] != self.last:
            where = "mid-length, since the profile is mirrored" if self.mirrored else "the last end"
            said = f"must be {self.last:g}, {where}"
            advice = "say the angle there too" + ("" if self.mirrored else ", or set mirrored to true and end at 0.5")
            raise SpecError(f"braid.angle_profile.at[{len(self.at) - 1}]", self.at[-1], said, advice)

    @property
    def last(self) -> float:
        """The last place: 1, or 0.5 where the profile is mirrored."""
        return 0.5 if self.mirrored else 1.0

    @property
    def places(self) -> tuple[Number, ...]:
        """Where the angles are, as shares of the length."""
        count = len(self.angle)
        return tuple(self.last * (k + 1) / count for k in range(count)) if self.at is None else self.at


def certainly_rises(profile: AngleProfile) -> Any:
    """Whether the places of profiles whose numbers are arrays certainly are where they should be."""
    places: Any = profile.places
    good: Any = (places[-1] == profile.last) & (places[0] > 0.0)
    for before, after in itertools.pairwise(places):
        good = good & (after > before)
    return good


def check_angles(braid: Any) -> None:
    """SpecError for a spline that swings beyond 0 or 90 deg between the angles of a braid's profile."""
    profile = braid.angle_profile
    if profile is None or any(map(is_traced, (*braid.angles, *profile.places))):
        return
    low, high = extremes(braid)
    if min(math.sin(low), math.cos(high)) < FLATTEST or not 0.0 < low <= high < math.pi / 2.0:
        said = (
            f"swings from {show(low, 'rad')} to {show(high, 'rad')} between the angles given: must stay above 0 deg "
            "and below 90 deg"
        )
        raise SpecError("braid.angle_profile", allowed=said, advice='give more places, or set between = "monotone"')


def check_profile(muscle: Any) -> None:
    """SpecError for a programmed braid with something that it does not go with."""
    braid, field = muscle.braid, "braid.angle_profile"
    if braid.angle_profile is None:
        return
    if not braid.fibre.stretch:
        said = "asks for fibres that stretch: the angle of those that do not has no rate of its own along the length"
        raise SpecError(field, allowed=said, advice="set braid.fibre.stretch = true, with the stiffness of the fibres")
    if muscle.end_radii is not None:
        said = (
            "does not go with end_radii: a programmed braid is solved from as it was made, which such fittings strain"
        )
        raise SpecError(field, allowed=said, advice="leave one of the two out")
