"""Which column holds what: as the user says, or as the heads say where they leave no choice."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from mckibben.data.heads import Head
from mckibben.data.numbers import numbers
from mckibben.data.quantities import DERIVED, KINDS, LABELS, QUANTITIES, remedy
from mckibben.data.table import Table
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import UnitError, scaled

__all__ = ["choose", "column_named", "fits"]


def fits(unit: str, quantity: str) -> bool:
    """Whether a unit measures a quantity; a force may be hung as a mass."""
    wanted = QUANTITIES[quantity].unit
    for kind in (wanted, "kg") if quantity == "force" else (wanted,):
        try:
            scaled(1.0, "" if unit == kind == "1" else unit, kind)
        except UnitError:
            continue
        return True
    return False


def column_named(table: Table, wanted: Any, field: str) -> int:
    """The place of the column with a head (with or without its unit), or with a number, the first being 1."""
    if isinstance(wanted, (int, np.integer)) and not isinstance(wanted, bool):
        if 1 <= wanted <= len(table.heads):
            return int(wanted) - 1
        raise SpecError(field, wanted, f"{table.source} has the columns 1 to {len(table.heads)}")
    said = " ".join(str(wanted).split()).lower()
    for texts in (
        [head.text.lower() for head in table.heads],
        [head.name for head in table.heads],
        [head.text.lower().partition("[")[0].partition("(")[0].strip() for head in table.heads],
    ):
        if texts.count(said) == 1:
            return texts.index(said)
        if texts.count(said) > 1:
            places = ", ".join(str(k + 1) for k, text in enumerate(texts) if text == said)
            raise SpecError(field, wanted, f"is the head of several columns of {table.source}: {places}", "say which")
    if said.isdigit():  # a number, as the command line gives it
        return column_named(table, int(said), field)
    advice = nearest(str(wanted), [head.text for head in table.heads])
    raise SpecError(field, wanted, f"is no column of {table.source}", advice)


def choose(
    table: Table, said: Mapping[str, Any], units: Mapping[str, str], held: Collection[str], absent: Collection[str],
    mark: str,
) -> tuple[dict[str, int], list[str]]:  # fmt: skip
    """The column of each quantity and label that the table has, and what was taken for granted.

    Args:
        said: columns by quantity, in the user's words; they come first.
        units: units by quantity, in the user's words.
        held: quantities that the user gave a value: they need no column.
        absent: quantities that may be missing.
        mark: the decimal mark.
    """
    chosen = {name: column_named(table, wanted, f"columns.{name}") for name, wanted in said.items()}
    notes: list[str] = []
    told = [kind for kind in KINDS if kind in chosen or kind in held]
    taken = {place for name, place in chosen.items() if name in QUANTITIES}
    free = {k: head for k, head in enumerate(table.heads) if k not in taken}
    for name in (*QUANTITIES, *LABELS):
        if name in chosen or name in held or (name in KINDS and told):
            continue
        found = {k: head for k, head in free.items() if name in head.readings}
        if name in QUANTITIES:
            usable = {k: head for k, head in found.items() if name in units or not head.unit or fits(head.unit, name)}
            found = usable or found
        measured = {k: head for k, head in found.items() if not DERIVED & set(head.words)}
        found = measured or found
        if len(found) > 1:
            listed = " and ".join(f'"{head.text}"' for head in found.values())
            first = next(iter(found.values())).text
            said_of = f"several columns could be the {name.replace('_', ' ')}: {listed}"
            raise SpecError(_heads(table), allowed=said_of, advice=f"say {remedy('columns', name, first)}")
        chosen |= dict.fromkeys([name], next(iter(found))) if found else {}
    if not told:
        _one_kind(table, chosen, mark, notes)
    _check_missing(table, chosen, held, absent)
    return chosen, notes


def _heads(table: Table) -> str:
    return f"{table.source}, line {table.head_line}" if table.head_line else table.source


def _one_kind(table: Table, chosen: dict[str, int], mark: str, notes: list[str]) -> None:
    """Leave one of length, contraction and extension: what was measured."""
    found = {kind: table.heads[chosen[kind]] for kind in KINDS if kind in chosen}
    for kind, head in found.items():
        if DERIVED & set(head.words) and any(not DERIVED & set(other.words) for other in found.values()):
            notes.append(f'column "{head.text}": left out, as its head says that it is derived')
            del chosen[kind]
    if {"length", "contraction"} <= set(chosen) and "extension" not in chosen and _agree(table, chosen, mark):
        head = table.heads[chosen.pop("contraction")]
        notes.append(f'column "{head.text}": left out, as it says what the length says')
    left = [kind for kind in KINDS if kind in chosen]
    if len(left) > 1:
        listed = " and ".join(f'"{table.heads[chosen[kind]].text}"' for kind in left)
        advice = f"say {remedy('columns', left[0], table.heads[chosen[left[0]]].text)}"
        raise SpecError(_heads(table), allowed=f"which of them was measured: {listed}?", advice=advice)


def _agree(table: Table, chosen: Mapping[str, int], mark: str) -> bool:
    """Whether length and contraction are two names of one thing: length/(1 - contraction) is one number, to 0.1 %."""
    read = [numbers(table.columns[chosen[kind]], mark) for kind in ("length", "contraction")]
    (h, wrong), (c, other) = read
    if wrong is not None or other is not None:
        return False
    percent = 0.01 if table.heads[chosen["contraction"]].unit == "%" else 1.0
    with np.errstate(all="ignore"):
        rest = (h / (1.0 - percent * c))[np.isfinite(h + c)]
    return bool(len(rest)) and bool(np.ptp(rest) <= 2e-3 * np.median(np.abs(rest)))


def _check_missing(table: Table, chosen: Mapping[str, int], held: Collection[str], absent: Collection[str]) -> None:
    """SpecError for a table without pressure, force, or what tells the length."""
    for names in (("pressure",), ("force",), KINDS):
        if any(name in chosen or name in held or name in absent for name in names):
            continue
        what = names[0] if len(names) == 1 else "length, contraction or extension"
        example = {"pressure": "3 bar", "force": "0 N", "length": "115 mm"}[names[0]]
        near = next((head.text for head in table.heads if _could_be(head, names)), "...")
        advice = f"say {remedy('columns', names[0], near)}, or {remedy('held', names[0], example)} if it was held"
        strain = next((head.text for head in table.heads if "strain" in head.words), None)
        if strain and names == KINDS:
            advice = (
                f'say {remedy("columns", "contraction", strain)}, with reverse=["contraction"] if it grows with length'
            )
        raise SpecError(_heads(table), allowed=f"has no column of {what} among {table.shown}", advice=advice)


def _could_be(head: Head, names: Collection[str]) -> bool:
    unread = bool(head.unit) and not head.readings
    return unread and any(fits(head.unit, name) for name in names if name != "contraction")
