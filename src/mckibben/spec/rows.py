"""A muscle and a test as understood: rows of text, each field with its value, unit, meaning and source."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mckibben.spec import presets
from mckibben.spec.change import CHANGED
from mckibben.spec.declared import Declared, walk
from mckibben.spec.loading import Test
from mckibben.spec.muscle import Muscle
from mckibben.spec.path import Path

__all__ = ["ASSUMED", "HIDDEN", "muscle_rows", "part_rows", "test_rows"]

ASSUMED = "ASSUMED"
HIDDEN = ("name", "assumed")


def muscle_rows(muscle: Muscle) -> Iterator[tuple[str, str, str, str]]:
    """(field, value, meaning, source) of all that is given; the source of an assumed value starts with ASSUMED."""
    origins = _origins(muscle)
    for name, declared, value in walk(muscle):
        if name in HIDDEN or (value is None and name != "chamber"):
            continue
        if name.startswith("chamber.law.") and muscle.chamber is not None:
            law = muscle.chamber.law
            if name == f"chamber.law.{_first(law)}":
                yield "chamber.law", law.name, "hyperelastic law of the elastomer", ""
        yield name, "none" if value is None else _text(declared, value), declared.meaning, origins.get(name, "")


def _first(law: Any) -> str:
    return next(name for name, _, value in walk(law) if value is not None)


def _origins(muscle: Muscle) -> dict[str, str]:
    """The source of each value that is the same as in the preset of this name, and of those that are assumed."""
    known: dict[str, str] = {}
    preset = (muscle.name or "").removesuffix(CHANGED)
    if preset in presets.names():
        same = {name: value for name, _, value in walk(presets.get(preset))}
        for name, _, value in walk(muscle):
            if name in same and same[name] == value:
                known[name] = presets.sources(preset).get(name, "")
    for name in muscle.assumed:
        known[name] = f"{ASSUMED}: {known[name].removeprefix('assumed: ')}" if name in known else ASSUMED
    return known


def test_rows(test: Test) -> Iterator[tuple[str, str, str]]:
    """(field, value, meaning) of a test; the steps of a protocol one after the other."""
    yield "kind", test.kind, (type(test).__doc__ or "").strip().splitlines()[0].rstrip(".")
    for name, declared, value in walk(test):
        if declared.kind == "steps":
            for index, step in enumerate(value):
                yield from ((f"steps[{index}].{inner}", text, meaning) for inner, text, meaning in test_rows(step))
        elif value is not None:
            said = value.called(name) if isinstance(value, Path) else name
            yield said, _text(declared, value), "contraction 1 - h/H0" if said != name else declared.meaning


test_rows.__test__ = False  # type: ignore[attr-defined]  # not a test for pytest to collect


def part_rows(part: Any) -> Iterator[tuple[str, str, str]]:
    """(field, value, meaning) of what is given of any part of a muscle."""
    yield from (
        (name, _text(declared, value), declared.meaning) for name, declared, value in walk(part) if value is not None
    )


def _text(declared: Declared, value: Any) -> str:
    if declared.kind == "quantity":
        return declared.explained(value)
    if declared.kind == "quantities":
        return ", ".join(declared.text(item) for item in value)
    return str(value)
