"""Choices of a page that are no word of a field: the law of the rubber, how many numbers a list has."""

from __future__ import annotations

from typing import Any

from mckibben.page.chosen import LAW, MOST, PROFILE, RADII, TERMS, law_choice
from mckibben.spec import Muscle, Ogden

__all__ = ["offered"]

LAWS = {
    "neo-hookean": "neo-Hookean", "mooney-rivlin": "Mooney-Rivlin", "yeoh": "Yeoh", "ogden": "Ogden", "gent": "Gent",
    "arruda-boyce": "Arruda-Boyce", "rubber E": "by Young's modulus", "rubber shore": "by Shore A hardness",
    "bellows": "bellows, by their folds",
}  # fmt: skip
"""Names of the laws for people."""


def offered(muscle: Muscle) -> list[dict[str, Any]]:
    """The choices that this muscle has, each with its words, which holds, and under which part it stands."""
    made = []
    chamber = muscle.chamber
    if chamber is not None:
        made.append(_choice(LAW, "Law", "hyperelastic law of the elastomer; another one begins as stiff at small "
                            "strains", "Rubber", law_choice(muscle), list(LAWS.items())))  # fmt: skip
        if isinstance(chamber.law, Ogden):
            count = len(chamber.law.mu)
            options = [(k, str(k)) for k in range(1, max(count, MOST) + 1)]
            made.append(_choice(TERMS, "Terms", "number of terms of Ogden's law", "Rubber", count, options))
    radii = 0 if muscle.end_radii is None else len(muscle.end_radii)
    words = [(0, "as the braid"), (1, "one for both ends"), (2, "one for each end")]
    made.append(_choice(RADII, "Radius held", "radius of the fibres on the fittings", "Fittings", radii, words))
    profile = muscle.braid.angle_profile
    count = 0 if profile is None else len(profile.angle)
    options = [(k, f"at {k + 1} places" if k else "the same") for k in range(max(count, MOST) + 1)]
    made.append(_choice(PROFILE, "Braid angle", "how the braid angle goes on from the first end",
                        "Angle along the length", count, options))  # fmt: skip
    return made


def _choice(name: str, label: str, meaning: str, group: str, value: Any, options: list[tuple[Any, str]]) -> Any:
    return {"name": name, "label": label, "meaning": meaning, "group": group, "value": value,
            "options": [list(option) for option in options], "assumed": False}  # fmt: skip
