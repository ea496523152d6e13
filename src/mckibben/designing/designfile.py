"""Reading a design file (TOML): a muscle, what is free, what is wanted, and what `design` takes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any

import attrs

from mckibben.files.case import dotted, read_mapping
from mckibben.spec import Muscle
from mckibben.spec.asked import MEASURES
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.merge import apply_overrides
from mckibben.spec.text import build, from_mapping
from mckibben.spec.wishes import Demand, Goal, Maximise, Measure, Minimise

__all__ = ["DesignCase", "read_design"]

_TABLES = ("muscle", "free", "objective", "subject_to", "options")
_NEEDED = {
    "muscle": 'a [muscle] table, such as preset = "paper"',
    "free": 'a [free] table, such as "braid.angle" = "55 deg to 70 deg"',
    "objective": 'an [objective] table, such as minimise = "mass"',
}
"""Tables that must be there, and what to write."""
_OPTIONS = ("designs", "seed", "tolerance")
_SENSES: dict[str, type[Goal]] = {"maximise": Maximise, "minimise": Minimise}
_LIMITS = {"at_least": "least", "at_most": "most"}


@attrs.frozen
class DesignCase:
    """What a design file says: the muscle, and the other arguments of `design`."""

    muscle: Muscle
    free: dict[str, Any]
    objective: tuple[Goal, ...]
    subject_to: tuple[Demand, ...]
    options: dict[str, Any]  #: designs, seed, tolerance, where the file gives them


def read_design(path: str | PathLike[str], overrides: Iterable[str] = ()) -> DesignCase:
    """The design in the file at `path`, with "dotted.name=value" overrides put in first: "options.designs=500".

    Names are the muscle's unless they begin with another table's. SpecError, in one line, for a file that cannot be
    read or is not TOML, and for whatever is wrong in it; ranges and lists are for `design` to read.
    """
    mapping = apply_overrides(read_mapping(path), overrides, _TABLES)
    for name in mapping:
        if name not in _TABLES:
            raise SpecError(str(name), allowed="unknown key", advice=nearest(str(name), _TABLES))
    for name, line in _NEEDED.items():
        if name not in mapping:
            raise SpecError(name, allowed="is missing", advice=f"write {line}")
    for name in ("muscle", "free", "options"):
        if not isinstance(mapping.get(name, {}), Mapping):
            raise SpecError(name, mapping[name], "must be a table", f"write [{name}] with its keys below")
    muscle = from_mapping({"muscle": mapping["muscle"]}, test_required=False).muscle
    options = dict(mapping.get("options", {}))
    for key, value in options.items():
        if key not in _OPTIONS:
            raise SpecError(f"options.{key}", allowed="unknown key", advice=nearest(str(key), _OPTIONS))
        kind, said = (int, "a whole number") if key != "tolerance" else ((int, float), "a number")
        if isinstance(value, bool) or not isinstance(value, kind):
            raise SpecError(f"options.{key}", value, f"must be {said}")
    goals = tuple(_goal(table, field) for table, field in _tables(mapping["objective"], "objective"))
    demands = tuple(_demand(table, field) for table, field in _tables(mapping.get("subject_to", []), "subject_to"))
    return DesignCase(muscle, dict(dotted(mapping["free"], "points")), goals, demands, options)


def _tables(given: Any, name: str) -> list[tuple[dict[str, Any], str]]:
    """One table or several, each with its name in errors."""
    if isinstance(given, Mapping):
        return [(dict(given), name)]
    if not isinstance(given, list) or not all(isinstance(one, Mapping) for one in given):
        raise SpecError(name, given, "must be a table, or several", f"write [[{name}]] for each")
    return [(dict(one), f"{name}[{k}]") for k, one in enumerate(given)]


def _goal(table: dict[str, Any], field: str) -> Goal:
    given = [sense for sense in _SENSES if sense in table]
    if len(given) != 1:
        said = "is neither maximise nor minimise" if not given else "is both maximise and minimise"
        raise SpecError(field, allowed=said, advice='such as minimise = "mass"')
    word = table.pop(given[0])
    return _SENSES[given[0]](_measure(word, table, field, given[0]))


def _demand(table: dict[str, Any], field: str) -> Demand:
    if "measure" not in table:
        raise SpecError(f"{field}.measure", allowed="is missing", advice=f"choose from {', '.join(MEASURES)}")
    limits = {_LIMITS[key]: table.pop(key) for key in _LIMITS if key in table}
    measure = _measure(table.pop("measure"), table, field, "measure")
    try:
        return Demand(measure, **limits)
    except SpecError as error:
        raise error.renamed(f"{field}{error.field.removeprefix(measure.kind)}") from error


def _measure(word: Any, table: dict[str, Any], field: str, key: str) -> Measure:
    """A measure by its word, with the rest of its table."""
    if not isinstance(word, str) or word not in MEASURES:
        raise SpecError(f"{field}.{key}", word, "is no measure", nearest(str(word), MEASURES))
    cls: Any = MEASURES[word]
    measure: Measure = build(cls, table, field, field)
    return measure
