"""A muscle as a page opens it: its controls, where to begin, and what of it is assumed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mckibben.files.case import read_case
from mckibben.page.chosen import chosen
from mckibben.page.controls import GROUPS, choices, sliders
from mckibben.page.muscles import muscle_of, top_pressure
from mckibben.sheet.levels import rated
from mckibben.spec import Muscle, SpecError, Test, presets
from mckibben.spec.change import CHANGED
from mckibben.spec.declared import walk
from mckibben.spec.text import to_mapping
from mckibben.units import to_si

__all__ = ["opened", "opened_file"]

FULLER = 1.5
"""How far the slider of the pressure goes beyond the pressure that a muscle is meant for."""


def opened(said: Mapping[str, Any]) -> dict[str, Any]:
    """What a page shows of the muscle that a browser says, with another choice where it says one, "choose".

    SpecError for whatever is wrong with it.
    """
    start = said.get("from") if isinstance(said, Mapping) else None
    changes = said.get("changes") if isinstance(said, Mapping) else None
    choose = said.get("choose") if isinstance(said, Mapping) else None
    muscle = muscle_of(said)
    for name, value in choose.items() if isinstance(choose, Mapping) else ():
        muscle = chosen(muscle, str(name), value)
    changes = changes or choose
    short = isinstance(start, Mapping) and set(start) == {"preset"}  # what the catalogue knows need not be said
    own: Any = dict(start) if short and not changes and isinstance(start, Mapping) else to_mapping(muscle)
    return _told(muscle, own, None)


def opened_file(path: str, name: str) -> dict[str, Any]:
    """The same of the muscle in a case file, which goes by `name` in messages."""
    try:
        case = read_case(Path(path), test_required=False)
    except SpecError as error:
        raise SpecError(error.field.replace(path, name), error.value, error.allowed, error.advice) from error
    return _told(case.muscle, to_mapping(case.muscle), case.test)


def _told(muscle: Muscle, mapping: dict[str, Any], test: Test | None) -> dict[str, Any]:
    meant = rated(muscle)
    top = top_pressure(None if meant is None else float(to_si(meant, "Pa")), test)
    preset = (muscle.name or "").removesuffix(CHANGED)
    meanings = {name: declared.meaning for name, declared, _ in walk(muscle)}
    return {
        "from": mapping,
        "name": muscle.name or "a muscle without a name",
        "sliders": sliders(muscle),
        "choices": choices(muscle),
        "groups": list(dict.fromkeys(GROUPS.values())),
        "assumed": [{"name": name, "meaning": meanings.get(name, "")} for name in muscle.assumed],
        "about": presets.about(preset) if preset in presets.names() else "",
        "remark": muscle.__remark__(),
        "top": top,
        "most": FULLER * top,
    }
