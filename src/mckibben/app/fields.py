"""A case file to start from, and sources as numbers below a table."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from mckibben.spec import presets, walk
from mckibben.spec.declared import Declared
from mckibben.spec.rows import ASSUMED, HIDDEN
from mckibben.spec.winding import extremes
from mckibben.units import show, to_si

__all__ = ["case_text", "numbered"]


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


def case_text(name: str) -> str:
    """A case file with a preset written out, each value with its source, and a test to change."""
    muscle = presets.get(name)
    sources = presets.sources(name)
    tables: dict[str, list[str]] = {"": []}
    for dotted, declared, value in walk(muscle):
        if value is None or dotted in HIDDEN:
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
    long = _TEST_STRETCH * math.sin(extremes(muscle.braid)[1]) < 0.9  # well below the length of a fibre
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
