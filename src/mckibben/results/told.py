"""The states of a result for people: which columns, in which units, with how many digits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from mckibben.results.rows import COLUMNS as VARIABLES
from mckibben.results.variables import EXTREMES
from mckibben.spec import Muscle
from mckibben.units import from_si

__all__ = ["cells", "columns", "summary", "verdict"]

COLUMNS = (
    ("length", "length", "mm"),
    ("contraction", "contr.", "%"),
    ("force", "force", "N"),
    ("pressure", "press.", "bar"),
    ("volume", "volume", "mL"),
    ("largest_diameter", "diam.", "mm"),
    ("peak_fibre_tension", "tension", "N"),
)
"""Columns of the table: variable, its short name and the unit it is shown in."""
SAFETY = ("safety_factor", "safety", "")
"""The column of a muscle whose fibres have a breaking force."""
AIR = ("air_volume", "air", "mL")
"""The column of a muscle whose chamber lies inside the braid, after that of the volume."""

CONTACT = ("contact", "contact", "%")
"""The column of a muscle whose chamber may leave the braid."""


def columns(muscle: Muscle) -> tuple[tuple[str, str, str], ...]:
    """The columns that say something of this muscle."""
    inside = muscle.chamber is not None and muscle.chamber.inside
    shown = (column for one in COLUMNS for column in ((one, AIR) if inside and one[0] == "volume" else (one,)))
    gap = muscle.chamber is not None and muscle.chamber.gap
    return (*shown, *((CONTACT,) if gap else ()), *(() if muscle.braid.fibre.breaking_force is None else (SAFETY,)))


def cells(row: dict[str, Any], columns: Iterable[tuple[str, str, str]]) -> Iterator[str]:
    for name, _, unit in columns:
        value = row[name]
        if value is None:
            yield "-"
        else:
            shown = 100.0 * value if unit == "%" else from_si(value, unit or "1")
            digits = 4 if name in EXTREMES else 5
            yield (
                f"{shown:.{digits}g}" if abs(shown) > 1e-9 else "0"
            )  # a force held at 0 N comes out as a rounding error


def verdict(word: str, reason: str) -> str:
    """A verdict with its reason, in which it may be said already."""
    return reason if reason.startswith(word) else f"{word}: {reason}"


def summary(row: dict[str, Any], muscle: Muscle) -> str:
    """One state as lines of text: its verdict, and each number of a table with its meaning and unit."""
    shown = [column for column in columns(muscle) if row[column[0]] is not None]
    known = {name: VARIABLES[name][1] for name, _, _ in shown}
    wide = max(map(len, known.values()), default=0)
    numbers = zip(shown, cells(row, shown), strict=True)
    lines = [f"{known[name]:{wide}}  {text} {unit}".rstrip() for (name, _, unit), text in numbers]
    return "\n".join([verdict(row["verdict"], row["reason"]), *lines])
