"""Several fields of a muscle and its test changed at once: what a sweep varies.

A field is named as everywhere else: "braid.angle", "chamber.law.c1", "ends"; those of the test begin with "test.", and
those of a protocol's steps with "test.steps.0.". Fields are changed together, and only the result is checked: more
fibres may fit only because they are also thinner.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mckibben.spec.change import changed as put_in
from mckibben.spec.change import changed_muscle
from mckibben.spec.contraction import DECLARED as CONTRACTION
from mckibben.spec.contraction import takes_it
from mckibben.spec.declared import Declared, describe, walk
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.loading import Test
from mckibben.spec.muscle import Muscle
from mckibben.spec.text import part_from_plain

__all__ = ["changed", "declared_at", "full_name", "read"]

_FIXED = {
    "points": "every design must have as many states",
    "along": "every design must have as many states",
    "steps": "vary what is inside a step, such as test.steps.0.pressure",
    "assumed": "it says nothing of the muscle",
}


def full_name(name: str) -> str:
    """A field as errors and results name it: a leading "muscle." may be left out."""
    return name.removeprefix("muscle.")


def declared_at(muscle: Muscle, test: Test, name: str) -> Declared:
    """The declaration of the field of that name. SpecError if there is none, or if it cannot be varied."""
    names = full_name(name).split(".")
    owner: Any = muscle
    if names[0] == "test":
        owner, names = test, names[1:]
    found: Declared | None = None
    while names:
        if isinstance(owner, tuple) and names[0].isdecimal() and int(names[0]) < len(owner):
            owner, names = owner[int(names[0])], names[1:]
            continue
        known = {} if owner is None or isinstance(owner, tuple) else _fields(owner)
        found = known.get(names[0])
        if found is None or (len(names) > 1 and found.kind not in ("part", "steps")):
            raise SpecError(name, allowed="is no field that can be varied", advice=nearest(name, _names(muscle, test)))
        owner, names = getattr(owner, found.name, None), names[1:]
    if found is None:
        raise SpecError(name, allowed="is no field that can be varied", advice=nearest(name, _names(muscle, test)))
    if found.name in _FIXED:
        raise SpecError(name, allowed="cannot be varied", advice=_FIXED[found.name])
    return found


def _fields(owner: Any) -> dict[str, Declared]:
    fields = {item.name: item for item in describe(type(owner))}
    return fields | {"contraction": CONTRACTION} if takes_it(owner) else fields


def _names(muscle: Muscle, test: Test) -> list[str]:
    names = [name for name, _, _ in walk(muscle)]
    steps = getattr(test, "steps", ())
    names += [f"test.steps.{k}.{name}" for k, step in enumerate(steps) for name, _, _ in walk(step)]
    names += [f"test.{name}" for name, _, _ in walk(test)]
    return [name for name in names if name.rpartition(".")[2] not in _FIXED]


def read(name: str, declared: Declared, value: Any) -> Any:
    """`value` as the field stores it (an SI float, a word, a Path, a part). SpecError if it cannot be."""
    if declared.kind == "part":
        owner = full_name(name).rpartition(".")[0] or "muscle"
        return part_from_plain(declared, value, owner)
    return None if value is None and declared.default is None else declared.read(value, full_name(name), declared)


def changed(muscle: Muscle, test: Test, values: Mapping[str, Any]) -> tuple[Muscle, Test]:
    """The muscle and the test with all of `values` put in at once. SpecError if they do not go together.

    What was changed leaves `assumed`, and the name says that the muscle was changed, as with `Muscle.replace`.
    """
    of_muscle = {name: value for name, value in values.items() if not name.startswith("test.")}
    of_test = {name.removeprefix("test."): value for name, value in values.items() if name.startswith("test.")}
    if of_muscle:
        muscle = changed_muscle(muscle, of_muscle)
    if of_test:
        try:
            test = put_in(test, of_test, "test.")
        except SpecError as error:
            own: str = type(test).__spec_path__  # type: ignore[union-attr]
            if error.field.startswith(own):
                raise error.renamed("test" + error.field.removeprefix(own)) from error
            raise
    return muscle, test
