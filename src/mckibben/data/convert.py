"""The chosen columns → SI numbers: units, hung masses, absolute pressures, rows without a number."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from mckibben.data.heads import unit_of
from mckibben.data.numbers import numbers
from mckibben.data.quantities import KINDS, QUANTITIES, remedy
from mckibben.data.table import Table
from mckibben.data.text import NUMERIC
from mckibben.spec.constants import GRAVITY
from mckibben.spec.errors import SpecError
from mckibben.units import DISPLAY, UnitError, is_unit, scaled, show

__all__ = ["Settings", "converted"]

Settings = Mapping[str, Any]
"""`units` by quantity, `reverse` (quantities), `absolute` (or None), `atmosphere` [Pa], `mark`."""


def converted(
    table: Table, chosen: Mapping[str, int], settings: Settings, notes: list[str]
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """The numbers of each chosen quantity in SI, and which rows have all of them; notes are added to."""
    found: dict[str, np.ndarray] = {}
    whole = np.ones(len(table.lines), bool)
    missing: dict[str, int] = {}
    for name in (name for name in QUANTITIES if name in chosen):
        values = _in_si(table, name, chosen[name], settings, notes)
        found[name] = -values if name in settings["reverse"] else values
        empty = np.isnan(values)
        if empty.any():
            missing[name] = int(np.flatnonzero(empty)[0])
        whole &= ~empty
    if missing:
        name, first = min(missing.items(), key=lambda item: item[1])
        if not whole.any():
            said = "no row has a number in every column that is needed"
            raise SpecError(table.place(first, chosen[name]), allowed=said)
        lost = int((~whole).sum())
        rows = f"{lost} row{'s' if lost > 1 else ''} without a number left out"
        notes.append(f"{rows}: the first is {table.counted} {table.lines[first]}, without {name.replace('_', ' ')}")
    return found, whole


def _in_si(table: Table, name: str, column: int, settings: Settings, notes: list[str]) -> np.ndarray:
    values, wrong = numbers(table.columns[column], settings["mark"])
    if wrong is not None:
        cell = table.columns[column][wrong]
        advice = "correct it, or leave the cell empty" if table.counted == "line" else "correct it, or empty the cell"
        if isinstance(cell, str) and NUMERIC.fullmatch(cell.strip()):
            advice = f'its decimal mark was taken to be "{settings["mark"]}": else say decimal= (--decimal)'
        raise SpecError(table.place(wrong, column), cell, "must be a number", advice)
    head, wanted = table.heads[column], QUANTITIES[name].unit
    told = settings["units"].get(name)
    unit, absolute = unit_of(told) if told is not None else (head.unit, head.absolute)
    if absolute is None:
        absolute = head.absolute
    if not unit or (unit == "1" and wanted != "1"):
        unit = _unsaid(table, name, column, values, notes)
    si = _scaled(table, name, column, values, unit, told is not None, notes)
    return _gauge(si, absolute, settings, notes) if name == "pressure" else si


def _unsaid(table: Table, name: str, column: int, values: np.ndarray, notes: list[str]) -> str:
    """The unit of a column that says none: a force is in N and a contraction a plain number, all else is refused."""
    if name == "force":
        notes.append("unit of force taken as N: the file says none")
        return "N"
    if name == "contraction" and np.nanmax(np.abs(values), initial=0.0) <= 1.0:
        notes.append("contraction taken as a plain number (0.25 is 25 %): the file says no unit")
        return "1"
    place = f'{table.source}, column "{table.heads[column].text}"'
    said = f"the {name.replace('_', ' ')} has no unit"
    if name == "contraction":
        said = "is above 1, as only per cent can be"
    raise SpecError(place, allowed=said, advice=f"say {remedy('units', name, QUANTITIES[name].example)}")


def _scaled(
    table: Table, name: str, column: int, values: np.ndarray, unit: str, told: bool, notes: list[str]
) -> np.ndarray:  # fmt: skip
    wanted = QUANTITIES[name].unit
    try:
        return np.asarray(scaled(values, "" if unit == wanted == "1" else unit, wanted))
    except UnitError as error:
        trouble = error
    if name == "force":
        try:
            weight = GRAVITY * np.asarray(scaled(values, unit, "kg"))
        except UnitError:
            pass
        else:
            notes.append(f"force: {unit} taken as the weight of a mass, with {GRAVITY} m/s^2")
            return weight
    field = f"units.{name}" if told else f'{table.source}, column "{table.heads[column].text}"'
    said = str(trouble) if is_unit(unit) else f'has an unknown unit "{unit}"'
    like = "a unit such as " + DISPLAY.get(wanted, wanted).replace("1", "%")
    advice = f"write {like}, or say {remedy('units', name, QUANTITIES[name].example)}"
    raise SpecError(field, allowed=said, advice=advice)


def _gauge(values: np.ndarray, absolute: bool | None, settings: Settings, notes: list[str]) -> np.ndarray:
    told = settings["absolute"]
    absolute = told if told is not None else absolute
    if absolute is None:
        notes.append("pressure: taken as gauge, nothing says absolute")
    if not absolute:
        return values
    atmosphere = float(settings["atmosphere"])
    notes.append(f"pressure: absolute, less an atmosphere of {show(atmosphere, 'Pa')}")
    return values - atmosphere


def measured_kind(found: Collection[str]) -> str:
    """Which of length, contraction and extension is there."""
    return next(kind for kind in KINDS if kind in found)
