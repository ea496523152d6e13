"""`Recording`: what was measured over time; `read_recording()`: a file or table → `Recording`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import attrs
import numpy as np

from mckibben.data.choose import column_named
from mckibben.data.heads import Head, unit_of
from mckibben.data.numbers import decimal_mark, numbers
from mckibben.data.table import Table, table_of
from mckibben.shown import Shown
from mckibben.spec.constants import ATMOSPHERE
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import UnitError, from_si, scaled, to_si

__all__ = ["OVER_TIME", "Recording", "read_recording"]

OVER_TIME = {"length": "m", "pressure": "Pa", "force": "N", "angle": "rad"}
"""What is measured over time, and its SI unit; the angle is that of a pulley."""
_TIME = frozenset(("time", "zeit", "temps"))
_ANGLE = frozenset(("angle", "winkel"))
_SHOWN = {"length": "mm", "pressure": "bar", "force": "N", "angle": "deg"}


def _frozen(values: Any) -> np.ndarray:
    array = np.array(values, float)
    array.flags.writeable = False
    return array


@attrs.frozen(eq=False, repr=False)
class Recording(Shown):
    """Length, pressure, force or angle over time, in SI: what `read_recording` gives.

    Args:
        source: the file, for people.
        time: times [s], rising, from 0 on; of n points.
        values: by the name of a quantity its values (n): length [m], gauge pressure [Pa], force [N], positive where the
            muscle pulls, angle [rad] of a pulley.
        assumptions: what was taken for granted in reading, a sentence each.

    >>> mk.read_recording({"time [s]": [0, 0.1, 0.2], "pressure [bar]": [0, 1.2, 1.9]})
    <Recording: 3 points to 0.2 s, pressure 0 to 1.9 bar>
    """

    source: str
    time: np.ndarray = attrs.field(converter=_frozen)
    values: dict[str, np.ndarray]
    assumptions: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        told = []
        for name, values in self.values.items():
            low, high = (
                f"{value + 0.0:.4g}" for value in (from_si(ends(values), _SHOWN[name]) for ends in (np.min, np.max))
            )
            told.append(f"{name} {low} to {high} {_SHOWN[name]}")
        return f"<Recording: {len(self)} points to {self.time[-1]:.4g} s, {', '.join(told)}>"


def read_recording(
    path: Any,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    absolute: bool | None = None,
    atmosphere: Any = ATMOSPHERE,
    sheet: str | int | None = None,
) -> Recording:
    """Read a measured motion: a column of time, and length, pressure, force or angle over it.

    Args:
        path: a CSV, TSV, XLSX or MAT file, a pandas.DataFrame or a mapping of columns, with heads such as "time [s]"
            and "pressure [bar]".
        columns: heads by quantity where they do not say it themselves, {"pressure": "p2"}.
        units: units by quantity where the heads say none, {"time": "ms"}.
        absolute: whether pressures are absolute; as the head says, gauge where it says nothing.
        atmosphere: pressure around [Pa], taken off absolute ones.
        sheet: name or number (from 1) of a workbook's sheet, or of the struct of a MAT file.

    Returns:
        A `Recording`. Rows without a number are left out; time counts from 0.

    Raises:
        SpecError: for a file that cannot be read, a quantity that is missing, twice there or without a unit, and
            times that do not rise.

    >>> table = {"t [ms]": [0, 100, 200], "length_mm": [100, 99, 97], "p (bar abs)": [1.01325, 2.01325, 3.01325]}
    >>> found = mk.read_recording(table)
    >>> found.time, found.values["pressure"].round(6)
    (array([0. , 0.1, 0.2]), array([     0., 100000., 200000.]))
    """
    said, told = dict(columns or {}), dict(units or {})
    for option, given in (("columns", said), ("units", told)):
        for name in given:
            if name not in ("time", *OVER_TIME):
                known = ("time", *OVER_TIME)
                raise SpecError(
                    f"{option}.{name}", allowed="is no quantity over time", advice=nearest(str(name), known)
                )
    table = table_of(path, [str(name) for name in said.values()], sheet, None)
    chosen = {name: column_named(table, wanted, f"columns.{name}") for name, wanted in said.items()}
    for name in ("time", *OVER_TIME):
        found = [k for k, head in enumerate(table.heads) if k not in chosen.values() and _names(head, name)]
        if name not in chosen and len(found) > 1:
            listed = " and ".join(f'"{table.heads[k].text}"' for k in found)
            advice = f'say columns={{"{name}": "{table.heads[found[0]].text}"}}'
            raise SpecError(table.source, allowed=f"several columns could be the {name}: {listed}", advice=advice)
        if name not in chosen and found:
            chosen[name] = found[0]
    if "time" not in chosen or len(chosen) < 2:
        what = "time" if "time" not in chosen else "length, pressure, force or angle"
        raise SpecError(table.source, allowed=f"has no column of {what}: its heads are {table.shown}",
                        advice='write heads such as "time [s]" and "pressure [bar]", or say columns=')  # fmt: skip
    mark = decimal_mark([table.columns[k] for k in chosen.values()], table.source)
    notes: list[str] = list(table.notes)
    si = {name: _in_si(table, name, column, told.get(name), mark) for name, column in chosen.items()}
    if "pressure" in si:
        si["pressure"] -= _off(table.heads[chosen["pressure"]], told.get("pressure"), absolute, atmosphere, notes)
    whole = np.all([np.isfinite(values) for values in si.values()], axis=0)
    if (~whole).any():
        notes.append(f"{int((~whole).sum())} rows without a number left out")
    time = si.pop("time")[whole]
    if len(time) < 2 or not (np.diff(time) > 0.0).all():
        k = int(np.argmin(np.diff(time))) + 1 if len(time) > 1 else 0
        where = f"{table.source}, {table.counted} {table.lines[whole][k]}" if len(time) else table.source
        raise SpecError(where, allowed="times must rise, and be two at least")
    return Recording(table.source, time - time[0], {name: _frozen(values[whole]) for name, values in si.items()},
                     tuple(notes))  # fmt: skip


def _names(head: Head, name: str) -> bool:
    if name == "time":
        return bool(_TIME & set(head.words)) or head.words == ("t",)
    if name == "angle":
        return bool(_ANGLE & set(head.words)) and "braid" not in head.words
    return name in head.readings


def _in_si(table: Table, name: str, column: int, told: str | None, mark: str) -> np.ndarray:
    values, wrong = numbers(table.columns[column], mark)
    if wrong is not None:
        raise SpecError(table.place(wrong, column), table.columns[column][wrong], "must be a number")
    head, wanted = table.heads[column], OVER_TIME.get(name, "s")
    unit = unit_of(told)[0] if told is not None else head.unit
    place = f'{table.source}, column "{head.text}"'
    if not unit or unit == "1":
        example = {"time": "s"} | _SHOWN
        raise SpecError(place, allowed=f"the {name} has no unit", advice=f'say units={{"{name}": "{example[name]}"}}')
    try:
        return np.array(scaled(values, unit, wanted), float)
    except UnitError as error:
        raise SpecError(place, allowed=f"{name} in {unit}: {error}", advice=error.advice) from error


def _off(head: Head, told: str | None, absolute: bool | None, atmosphere: Any, notes: list[str]) -> float:
    """What is taken off pressures [Pa]."""
    if absolute is None:
        absolute = unit_of(told)[1] if told is not None else None
        absolute = head.absolute if absolute is None else absolute
    if absolute is None:
        notes.append("pressure: taken as gauge, nothing says absolute")
    if not absolute:
        return 0.0
    try:
        return float(to_si(atmosphere, "Pa"))
    except UnitError as error:
        raise SpecError("atmosphere", atmosphere, str(error), error.advice) from error
