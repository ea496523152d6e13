"""What a choice makes of a muscle: one of another law, with other lists of numbers; it begins near the one before."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mckibben.spec import (
    AngleProfile,
    ArrudaBoyce,
    Bellows,
    Gent,
    MooneyRivlin,
    Muscle,
    NeoHookean,
    Ogden,
    Rubber,
    SpecError,
    Yeoh,
)
from mckibben.spec.angle_profile import Between
from mckibben.spec.declared import describe
from mckibben.spec.rubber import stiffness_of_shore
from mckibben.spec.winding import angle_along

__all__ = ["LAW", "PROFILE", "RADII", "TERMS", "changes_of", "chosen", "law_choice"]

LAW, TERMS, RADII, PROFILE = "chamber.law", "chamber.law.mu", "end_radii", "braid.angle_profile"
"""Fields of which a page offers a choice that is no word of their own."""
MOST = 4
"""Terms of Ogden's law and places of a profile that a page offers; a case file may have more, and keeps them."""
LOCKING = {"Jm": 100.0, "lambda_m": 5.0}
"""Where chains lock, of a rubber of which nothing is known: far off."""


def law_choice(muscle: Muscle) -> str:
    """Which of the laws that a page offers a muscle has; empty without a chamber."""
    law = None if muscle.chamber is None else muscle.chamber.law
    if isinstance(law, Rubber):
        return "rubber E" if law.shore is None else "rubber shore"
    return "" if law is None else law.name


def chosen(muscle: Muscle, name: str, value: Any) -> Muscle:
    """The muscle with another choice. SpecError for one that it cannot have."""
    if name == LAW:
        return _of_law(muscle, value)
    if name == TERMS:
        return _of_terms(muscle, value)
    if name == RADII:
        held = muscle.end_radii or (muscle.braid.radius,)
        count = _count(name, value, 2)
        return muscle.replace(RADII, None if not count else [held[0], held[-1]][:count])
    if name == PROFILE:
        return muscle.replace(PROFILE, _profile(muscle, _count(name, value, 100)))
    if name == f"{PROFILE}.mirrored" and muscle.braid.angle_profile is not None:
        return muscle.replace(PROFILE, _mirrored(muscle.braid.angle_profile, value))
    return muscle.replace(name, value)


def _count(name: str, value: Any, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= most:
        raise SpecError(name, value, f"must be a whole number from 0 to {most}")
    return value


def _of_law(muscle: Muscle, word: Any) -> Muscle:
    """The muscle with another law that is as stiff at small strains, so far as that law can be.

    Its constants are assumptions until they are given.
    """
    if muscle.chamber is None:
        raise SpecError(LAW, word, "this muscle has no chamber", "open one that has")
    made = _laws(muscle)
    if not isinstance(word, str) or word not in made:
        raise SpecError(LAW, word, f"must be one of {', '.join(made)}")
    law = made[word]
    other = muscle.replace(LAW, law)
    fields = [f"{LAW}.{item.name}" for item in describe(type(law)) if getattr(law, item.name) is not None]
    return other.replace("assumed", list(dict.fromkeys([*other.assumed, *fields])))


def _laws(muscle: Muscle) -> dict[str, Any]:
    """The laws by their words, each as stiff at small strains as that of the muscle."""
    chamber: Any = muscle.chamber
    area = float(chamber.area(muscle.braid.radius))
    folded = isinstance(chamber.law, Bellows)
    if folded and not area:
        said = "the wall of these bellows is not told, so that no tube takes their place"
        raise SpecError(LAW, chamber.law.name, said, "give the chamber a thickness in the case file")
    G = chamber.law.axial_stiffness / (3.0 * area) if folded else chamber.law.shear_modulus
    E = 3.0 * G
    hardnesses = np.linspace(20.0, 80.0, 601)
    shore = float(np.interp(E, stiffness_of_shore(hardnesses), hardnesses))
    chains = G**2 / ArrudaBoyce(mu=G, lambda_m=LOCKING["lambda_m"]).shear_modulus
    return {
        "neo-hookean": NeoHookean(c1=_short(G / 2.0)),
        "mooney-rivlin": MooneyRivlin(c1=_short(G / 2.0)),
        "yeoh": Yeoh(c1=_short(G / 2.0)),
        "ogden": Ogden(mu=[_short(G)], alpha=[2.0]),
        "gent": Gent(mu=_short(G), Jm=LOCKING["Jm"]),
        "arruda-boyce": ArrudaBoyce(mu=_short(chains), lambda_m=LOCKING["lambda_m"]),
        "rubber E": Rubber(E=_short(E)),
        "rubber shore": Rubber(shore=round(shore, 1)),
        "bellows": Bellows(axial_stiffness=_short(E * area)) if area else chamber.law,
    }


def _short(value: float) -> float:
    return float(f"{value:.9g}")


def _of_terms(muscle: Muscle, count: Any) -> Muscle:
    """Ogden's law with so many terms; a new one does nothing until its modulus is given."""
    law = None if muscle.chamber is None else muscle.chamber.law
    if not isinstance(law, Ogden):
        raise SpecError(TERMS, count, "this muscle has no law of Ogden's")
    more = max(0, _count(TERMS, count, 100) - len(law.mu))
    return muscle.replace(LAW, Ogden(mu=[*law.mu[:count], *[0.0] * more], alpha=[*law.alpha[:count], *[-2.0] * more]))


def _profile(muscle: Muscle, count: int) -> AngleProfile | None:
    """A profile with so many places, near the one before; None for one angle."""
    braid, was = muscle.braid, muscle.braid.angle_profile
    if not count:
        return None
    last = 1.0 if was is None else was.last
    at = [last * (k + 1) / count for k in range(count)]
    return AngleProfile(
        angle=angle_along(braid, at).tolist(), at=at, mirrored=was is not None and was.mirrored,
        between=Between.SPLINE if was is None else was.between,
    )  # fmt: skip


def _mirrored(profile: AngleProfile, value: Any) -> AngleProfile:
    """The same angles on half the length, or on all of it."""
    if not isinstance(value, bool):
        raise SpecError(f"{PROFILE}.mirrored", value, "must be true or false")
    last = 0.5 if value else 1.0
    at = [place * last / profile.last for place in profile.places[:-1]]
    return AngleProfile(angle=profile.angle, at=[*at, last], mirrored=value, between=profile.between)


def changes_of(muscle: Muscle, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Changes as `Muscle.replace` takes them: those of single numbers of a list ("end_radii[1]") as the whole list."""
    plain: dict[str, Any] = {}
    for name, value in changes.items():
        field, bracket, rest = name.partition("[")
        if not bracket:
            plain[name] = value
            continue
        owner: Any = muscle
        for part in field.split("."):
            owner = getattr(owner, part, None)
        index = rest.removesuffix("]")
        if not isinstance(owner, tuple) or not index.isdecimal() or len(index) > 3 or int(index) >= len(owner):
            raise SpecError(name, value, "is no number of a list of this muscle")
        several = plain.setdefault(field, list(owner))
        if not isinstance(several, list):
            raise SpecError(name, value, f"is given beside {field} as a whole", "give one of the two")
        several[int(index)] = value
    return plain
