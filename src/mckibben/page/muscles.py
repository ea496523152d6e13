"""The muscle that a page works on: where it started from and what was changed since, as the browser keeps them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mckibben.page.chosen import changes_of
from mckibben.spec import Muscle, SpecError, Test
from mckibben.spec.change import changed_muscle
from mckibben.spec.declared import walk
from mckibben.spec.merge import check_depth
from mckibben.spec.text import muscle_from_mapping

__all__ = ["MOST_CHANGES", "kind_of", "muscle_of", "top_pressure"]

MOST_CHANGES = 100
"""Fields that a page may have changed; no muscle has as many."""
TOP = 3e5
"""Largest pressure [Pa] that a page offers where nothing says one."""


def muscle_of(said: Any) -> Muscle:
    """The muscle of what a browser says: a table "from" as in a case file, and "changes" by dotted name.

    The changes are put in together, as `Muscle.replace` would each; a number of a list goes by "end_radii[1]".
    SpecError for whatever is wrong.
    """
    if not isinstance(said, Mapping) or not isinstance(said.get("from"), Mapping):
        raise SpecError("muscle", allowed="must be a table with what it starts from")
    check_depth(said, "muscle")
    changes = said.get("changes", {})
    if not isinstance(changes, Mapping) or len(changes) > MOST_CHANGES:
        raise SpecError("changes", allowed=f"must be a table of at most {MOST_CHANGES} fields")
    muscle = muscle_from_mapping(said["from"])
    if not changes:
        return muscle
    made: Muscle = changed_muscle(muscle, changes_of(muscle, changes))
    return made


def kind_of(muscle: Muscle) -> str:
    """What two muscles have in common that differ in their numbers alone: the same compiled functions serve both."""
    law = None if muscle.chamber is None else muscle.chamber.law.name
    said = [law]
    for name, declared, value in walk(muscle):
        if value is None or name in ("name", "assumed"):
            continue
        several = declared.kind == "quantities"
        said.append(name if declared.kind in ("quantity", "count") else f"{name} {len(value) if several else value}")
    return ", ".join(map(str, said))


def top_pressure(rated: float | None, test: Test | None) -> float:
    """The pressure [Pa] up to which a page shows a muscle: what it is meant for, else what its test goes to."""
    if rated is not None:
        return rated
    steps: Any = () if test is None else getattr(test, "steps", (test,))
    paths = [step.pressure for step in steps if getattr(step, "pressure", None) is not None]
    largest = max((float(value) for path in paths for value in path.waypoints), default=0.0)
    return largest if largest > 0.0 else TOP
