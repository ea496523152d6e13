"""A muscle and a test as understood, each field with its unit and source; and a case file to start from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

from mckibben.spec import Muscle, Path, Test, presets, walk
from mckibben.spec.change import CHANGED
from mckibben.spec.declared import Declared
from mckibben.units import show, to_si

__all__ = ["case_text", "muscle_rows", "numbered", "test_rows"]

ASSUMED = "ASSUMED"
_HIDDEN = ("name", "assumed")


def muscle_rows(muscle: Muscle) -> Iterator[tuple[str, str, str, str]]:
    """(field, value, meaning, source) of all that is given; the source of an assumed value starts with ASSUMED."""
    origins = _origins(muscle)
    for name, declared, value in walk(muscle):
        if name in _HIDDEN or (value is None and name != "chamber"):
            continue
        if name.startswith("chamber.law.") and muscle.chamber is not None:
            law = muscle.chamber.law
            if name == f"chamber.law.{_first(law)}":
                yield "chamber.law", law.name, "hyperelastic law of the elastomer", ""
        yield name, "none" if value is None else _text(declared, value), declared.meaning, origins.get(name, "")


def numbered(sources: Iterable[str]) -> tuple[list[str], list[str]]:
    """Sources as short marks, "[1]" or "ASSUMED [2]", and the list of what the numbers stand for."""
    marks: list[str] = []
    notes: list[str] = []
    for source in sources:
        lead = ASSUMED if source.startswith(ASSUMED) else ""
        said = source.removeprefix(lead).removeprefix(": ")
        if said and said not in notes:
            notes.append(said)
        marks.append(" ".join(part for part in (lead, f"[{notes.index(said) + 1}]" if said else "") if part))
    return marks, [f"[{index + 1}] {note}" for index, note in enumerate(notes)]


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


def _text(declared: Declared, value: Any) -> str:
    if declared.kind == "quantity":
        return declared.explained(value)
    if declared.kind == "quantities":
        return ", ".join(declared.text(item) for item in value)
    return str(value)


def case_text(name: str) -> str:
    """A case file with a preset written out, each value with its source, and a test to change."""
    muscle = presets.get(name)
    sources = presets.sources(name)
    tables: dict[str, list[str]] = {"": []}
    for dotted, declared, value in walk(muscle):
        if value is None or dotted in _HIDDEN:
            continue
        table, _, key = dotted.rpartition(".")
        note = f"  # {sources[dotted]}" if dotted in sources else ""
        lines = tables.setdefault(table, [])
        if table == "chamber.law" and not lines and muscle.chamber is not None:
            lines.append(f'name = "{muscle.chamber.law.name}"')
        lines.append(f"{key} = {_toml(declared, value)}{note}")
    assumed = "".join(f'\n    "{field}",' for field in muscle.assumed)
    text = [
        f'# The preset "{name}". Run it with: mckibben run FILE.toml',
        "",
        "[muscle]",
        f'name = "{name}"',
        *tables[""],
    ]
    text += (
        ["# marked wherever they show; take out what you have measured", f"assumed = [{assumed}\n]"] if assumed else []
    )
    for table, lines in tables.items():
        text += ["", f"[muscle.{table}]", *lines] if table else []
    long = _TEST_STRETCH * math.sin(muscle.braid.angle) < 0.9  # well below the length of a fibre
    length = f"{1e3 * (_TEST_STRETCH if long else 1.0) * muscle.rest_length:.0f} mm"
    text += ["", "[test]", 'kind = "isometric"', f'length = "{length}"', 'pressure = "0 to 1 bar"', "points = 11", ""]
    return "\n".join(text)


_TEST_STRETCH = 1.35
"""Length of the example test over that of the muscle, where it gets so long: 115 mm for the paper's 85 mm."""


def _toml(declared: Declared, value: Any) -> str:
    if declared.kind == "quantity" and declared.unit != "1":
        for digits in (6, 12, 15, 17):
            text = show(value, declared.display or declared.unit, digits)
            if to_si(text, declared.unit) == value:
                return f'"{text}"'
    if isinstance(value, bool):
        return str(value).lower()
    return repr(float(value)) if declared.kind == "quantity" else f'"{value}"' if isinstance(value, str) else str(value)
