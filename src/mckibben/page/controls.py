"""The controls of a page: a slider for each number of a muscle, a choice for each effect, from the declared fields.

Choices that are no word of a field, such as the law, are of `page/offered.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import StrEnum
from typing import Any

from mckibben.page.chosen import LAW
from mckibben.page.offered import offered
from mckibben.spec import Muscle, numbers, presets
from mckibben.spec.angle import AngleFrom
from mckibben.spec.change import CHANGED
from mckibben.spec.declared import Declared, describe, in_own_words
from mckibben.units import from_si

__all__ = ["GROUPS", "choices", "sliders"]

LABELS = {
    "braid.radius": "Radius", "braid.length": "Length as made", "braid.angle": "Braid angle",
    "braid.fibres": "Fibres", "braid.fibre.diameter": "Diameter", "braid.fibre.E": "Young's modulus",
    "braid.fibre.nu": "Poisson's ratio", "braid.fibre.B1": "Bending B1", "braid.fibre.B2": "Bending B2",
    "braid.fibre.B3": "Twist B3", "braid.fibre.breaking_force": "Breaking force",
    "braid.fibre.axial_stiffness": "Axial stiffness", "chamber.thickness": "Wall thickness",
    "chamber.outer_diameter": "Outer diameter", "chamber.inner_diameter": "Inner diameter",
    "chamber.length": "Length of the tube", "chamber.law.lambda_m": "Locking stretch",
    "fittings.compliance": "Compliance", "fittings.dead_length": "Dead length", "friction.coefficient": "Friction",
    "friction.arm": "Arm of friction", "ends": "Ends", "braid.joint": "Crossings",
    "braid.fibre.stretch": "Fibres stretch",
    "chamber.lies": "Wall lies", "chamber.wall": "Wall taken as", "chamber.gap": "Gap to the braid",
    "chamber.law.E": "Young's modulus", "chamber.law.shore": "Shore A hardness",
    "chamber.law.axial_stiffness": "Stiffness of the folds", "end_radii": "Radius on the fittings",
    "braid.angle_profile.angle": "Angle", "braid.angle_profile.at": "Place",
    "braid.angle_profile.mirrored": "Second half mirrored", "braid.angle_profile.between": "Between the places",
    "braid.fibre.axial_law.strain": "Strain", "braid.fibre.axial_law.force": "Tension",
}  # fmt: skip
"""Names of fields for people; others go by their own."""
GROUPS = {
    "braid": "Braid", "braid.angle_profile": "Angle along the length", "braid.fibre": "Fibre",
    "braid.fibre.axial_law": "Pull test of a fibre", "chamber": "Chamber", "chamber.law": "Rubber",
    "fittings": "Fittings", "end_radii": "Fittings", "friction": "Friction", "": "Effects",
}  # fmt: skip
"""Names of the parts of a muscle, in the order of the page."""
CHOICES = (
    "ends", "braid.joint", "braid.fibre.stretch", "chamber.lies", "chamber.wall", "chamber.gap",
    "braid.angle_profile.mirrored", "braid.angle_profile.between",
)  # fmt: skip
"""What can be switched on a page."""
SWITCHED = {
    "braid.fibre.stretch": ("no", "yes"), "chamber.gap": ("none", "may open"),
    "braid.angle_profile.mirrored": ("no", "yes"),
}  # fmt: skip
"""Words for off and on."""
UNSAID = {"chamber.lies": "outside", "chamber.wall": "thin"}
"""What holds where a choice is left out."""
WIDER = {"Pa": 30.0, "N m^2": 30.0, "N": 30.0, "Jm": 30.0}
"""How many times a slider goes up and down, of numbers that differ by orders of magnitude; 3 times of others."""
ANGLES = (15.0, 80.0)
"""Braid angles of the slider [deg]."""


def sliders(muscle: Muscle) -> list[dict[str, Any]]:
    """What the browser needs to know of each number of a muscle that can be changed: range, unit, meaning, source."""
    preset = (muscle.name or "").removesuffix(CHANGED)
    sources = presets.sources(preset) if preset in presets.names() else {}
    return [
        _slider(muscle, name, declared, value)
        | {"source": sources.get(_field(name), "") if _field(name) in muscle.assumed else ""}
        for name, declared, value in numbers(muscle)
        if declared.kind in ("quantity", "quantities", "count") and not _settled(muscle, name, value)
    ]


def _field(name: str) -> str:
    """The field that a number is of: of one of a list that of the list."""
    return name.partition("[")[0]


def _settled(muscle: Muscle, name: str, value: Any) -> bool:
    """Whether a number of a list can only be what it is: the last place of a profile, the rest point of a pull test."""
    if name.startswith("braid.angle_profile.at["):
        profile: Any = muscle.braid.angle_profile
        return bool(value == profile.last)
    return name.startswith("braid.fibre.axial_law.") and value == 0.0


def _slider(muscle: Muscle, name: str, declared: Declared, value: Any) -> dict[str, Any]:
    if name == "braid.angle":  # in the words of whoever made the muscle
        value = in_own_words(muscle.braid)["angle"]
    unit = declared.display or declared.unit
    shown = float(from_si(float(value), unit)) if unit else float(value)
    scale = float(from_si(_stiffness(muscle), unit)) if declared.unit == "Pa" else 1.0
    least, most, bent = _range(name, declared, shown, scale)
    return {
        "name": name, "label": _label(muscle, name, declared.meaning), "meaning": declared.meaning,
        "group": _group(name),
        "unit": "" if unit == "1" else unit, "value": float(f"{shown:.12g}"), "least": least, "most": most,
        "step": _step(name, declared, most - least), "log": bent, "whole": declared.kind == "count",
        "assumed": _field(name) in muscle.assumed,
    }  # fmt: skip


def _stiffness(muscle: Muscle) -> float:
    return 0.0 if muscle.chamber is None else float(getattr(muscle.chamber.law, "shear_modulus", 0.0))


def _range(name: str, declared: Declared, value: float, scale: float) -> tuple[float, float, bool]:
    """Least and largest value of a slider, and whether its steps grow with the value."""
    if declared.unit == "rad":
        return min(ANGLES[0], value), max(ANGLES[1], value), False
    if name.startswith("braid.angle_profile.at["):
        return 0.01, 0.99, False
    if declared.name == "shore":
        return declared.low, declared.high, False
    if name == "braid.fibre.nu":
        return 0.0, 0.5 - 1e-3, False
    if declared.kind == "count":
        return 4.0, max(12.0, 2.0 * round(1.5 * value)), False
    if value == 0.0:
        size = scale or 1.0
        low = -0.25 * size if declared.low < 0.0 else 0.0
        return _round(low), _round(size), False
    if value < 0.0:
        return _round(3.0 * value), _round(-value), False
    wide = WIDER.get(declared.name, WIDER.get(declared.unit, 3.0))
    low, high = value / wide, value * wide
    if declared.unit == "1" and declared.low == 1.0:  # a stretch, which is above 1
        low = 1.0 + (value - 1.0) / wide
    return _round(low), _round(high), wide > 3.0


def _round(value: float) -> float:
    return float(f"{value:.2g}")


def _step(name: str, declared: Declared, span: float) -> float:
    if declared.kind == "count":
        return 2.0 if name == "braid.fibres" else 1.0
    return float(10.0 ** math.floor(math.log10(span / 100.0)))


def _label(muscle: Muscle, name: str, meaning: str) -> str:
    field, _, rest = name.partition("[")
    label = LABELS.get(field, field.rpartition(".")[2])
    if name == "braid.angle":
        axis = muscle.braid.measured_from == AngleFrom.AXIS
        return f"{label}, from the {'axis' if axis else 'parallels'}"
    if field == "end_radii":
        radii: Any = muscle.end_radii
        return label if len(radii) == 1 else f"{label}, {('first', 'last')[int(rest[0])]} end"
    if field.startswith(f"{LAW}.") and field not in LABELS and not rest:
        return f"{label}, {meaning}"  # a letter alone says little
    return f"{label} {int(rest[:-1]) + 1}" if rest else label


def _group(name: str) -> str:
    """The part of the muscle under which a field stands."""
    owner = _field(name)
    owner = owner if owner == "end_radii" else owner.rpartition(".")[0]
    while owner not in GROUPS:
        owner = owner.rpartition(".")[0]
    return GROUPS[owner]


def choices(muscle: Muscle) -> list[dict[str, Any]]:
    """What the browser needs to know of each choice that this muscle has: its words, and which holds."""
    return [*offered(muscle), *_choices(muscle)]


def _choices(muscle: Muscle) -> Iterator[dict[str, Any]]:
    for name in CHOICES:
        *parts, last = name.split(".")
        owner: Any = muscle
        for part in parts:
            owner = getattr(owner, part, None)
        if owner is None:
            continue
        declared = {item.name: item for item in describe(type(owner))}[last]
        value = getattr(owner, last)
        if name == "chamber.lies" and owner.outer_diameter is not None:
            continue  # a tube of its own diameters lies inside
        if name == "chamber.gap" and not owner.inside:
            continue
        if declared.kind == "switch":
            options = [[flag, SWITCHED[name][flag]] for flag in (False, True)]
        else:
            options = [[word, word] for word in declared.options]
            value = UNSAID.get(name) if value is None else str(value) if isinstance(value, StrEnum) else value
        part = "braid.angle_profile" if name.startswith("braid.angle_profile.") else ""
        yield {"name": name, "label": LABELS[name], "meaning": declared.meaning, "value": value, "options": options,
               "assumed": name in muscle.assumed, "group": GROUPS[part]}  # fmt: skip
