"""`read_data()`: measured curves from a laboratory's file or a DataFrame → `Data`."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from mckibben.data import branches, groups
from mckibben.data.choose import choose, column_named
from mckibben.data.convert import Settings, converted, measured_kind
from mckibben.data.join import joined
from mckibben.data.numbers import decimal_mark
from mckibben.data.quantities import KINDS, LABELS, QUANTITIES, remedy
from mckibben.data.table import Table, table_of
from mckibben.data.values import Data
from mckibben.spec.constants import ATMOSPHERE
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import Quantity, UnitError, to_si

__all__ = ["read", "read_data"]

TOLD_APART = ("pressure", "length", "file")
"""By what tests are told apart, beside a column."""


def read_data(
    path: Any,
    *,
    columns: Mapping[str, Any] | None = None,
    units: Mapping[str, str] | None = None,
    held: Mapping[str, Any] | None = None,
    reverse: Collection[str] = (),
    absolute: bool | None = None,
    atmosphere: Quantity = ATMOSPHERE,
    tests: str | None = None,
    sheet: str | int | None = None,
    header: int | None = None,
    decimal: str | None = None,
) -> Data:
    """Read measured curves: pressure, force, and a length, contraction or extension, of one or several tests.

    CSV, TSV and text in any usual encoding, XLSX (with `pip install "mckibben[lab]"`), MAT files of MATLAB (vectors of
    the top level or of a struct, whose names are the heads: "pressure_bar"), or a DataFrame. Quantities are
    known by the heads of their columns ("Force [N]", "pressure (bar)", "length_mm", or a row of units below the heads);
    other columns are not read. Nothing is guessed in silence: what leaves a choice is an error that says how to choose,
    and what was taken for granted is in `data.assumptions`. Rows in which a number is missing are left out, and
    counted there.

    Loading and unloading are told apart by the turns of what drives a test: the length where the pressure is held, else
    the pressure. Where a column says it ("branch"), that is taken.

    Args:
        path: a file, a list of files (each a test, or several), or a pandas.DataFrame (or a mapping of columns) whose
            heads have units: "pressure [Pa]".
        columns: heads (with or without their unit) or numbers (from 1) of columns by what they hold: "pressure",
            "force", "length", "contraction", "extension" (from the length without force at that pressure),
            "rest_length" (as made), "free_length" (without force at the pressure), "test", "branch".
        units: units by quantity, for files that say none or a wrong one: {"force": "kg"}. A mass is taken as the weight
            hung.
        held: what the file does not say, by quantity: {"pressure": "3 bar"}, gauge. One value, or one by test.
        reverse: quantities whose sign in the file is the other way round: force is positive where the muscle pulls.
        absolute: whether the pressure is absolute (True) or gauge (False), where its head does not say.
        atmosphere: what to take off an absolute pressure [Pa or text].
        tests: what tells tests apart: "pressure" or "length" (each took few values), "file", or the head of a column.
            By default a column of tests, else the pressure or the length where it stays the same for many rows.
        sheet: name or number (from 1) of a workbook's sheet, or of the struct of a MAT file ("run", "run(2)").
        header: the line of the heads, the first line of the file being 1.
        decimal: the decimal mark, "." or ",", where numbers do not tell.

    Returns:
        A `Data`, in SI.

    Raises:
        SpecError: with file, line and column of whatever is wrong or leaves a choice.

    >>> file = open("bench.csv", "w", encoding="utf-8")
    >>> file.write('''Druck (bar);Länge (mm);Kraft (kg)
    ... 1,0;80,0;0,0
    ... 1,0;90,5;1,5
    ... 2,0;80,0;1,2
    ... 2,0;90,5;3,5
    ... ''') and file.close()
    >>> data = mk.read_data("bench.csv", tests="pressure")
    >>> data.tests, data["2 bar"].force.round(3)  # N
    (('1 bar', '2 bar'), array([11.768, 34.323]))
    >>> data.assumptions[0]
    'pressure: taken as gauge, nothing says absolute'
    """
    return read(
        path, {}, columns=columns, units=units, held=held, reverse=reverse, absolute=absolute, atmosphere=atmosphere,
        tests=tests, sheet=sheet, header=header, decimal=decimal,
    )  # fmt: skip


def read(path: Any, otherwise: Mapping[str, float], **options: Any) -> Data:
    """`read_data`, with values [SI] that are taken where neither file nor user say any."""
    given = {name: value for name, value in options.items() if value is not None}
    columns, units, held = (dict(given.get(name, {})) for name in ("columns", "units", "held"))
    for option, said, known in (
        ("columns", columns, (*QUANTITIES, *LABELS)), ("units", units, QUANTITIES), ("held", held, QUANTITIES),
        ("reverse", _listed(given.get("reverse", ())), QUANTITIES),
    ):  # fmt: skip
        for name in said:
            if name not in known:
                raise SpecError(option, name, "is no quantity of a bench", nearest(str(name), known))
    if len({kind for kind in KINDS if kind in columns or kind in held}) > 1:
        raise SpecError("columns", allowed="only one of " + ", ".join(KINDS) + " can be what was measured")
    if given.get("decimal", ".") not in (".", ","):
        raise SpecError("decimal", given["decimal"], 'must be "." or ","')
    settings: Settings = {
        "units": units, "reverse": _listed(given.get("reverse", ())), "absolute": given.get("absolute"),
        "atmosphere": _si(given.get("atmosphere", ATMOSPHERE), "pressure", "atmosphere"), "mark": given.get("decimal"),
    }  # fmt: skip
    by = given.get("tests")
    if by in QUANTITIES and by not in TOLD_APART:
        raise SpecError("tests", by, "must be " + ", ".join(TOLD_APART) + " or the head of a column")
    several = isinstance(path, (list, tuple))
    files = list(path) if several else [path]
    if not files:
        raise SpecError("read_data", allowed="must be at least one file")
    parts = [
        _one(file, otherwise, columns, held, settings, by, several, given.get("sheet"), given.get("header"))
        for file in files
    ]
    return joined(parts)


def _listed(names: Any) -> tuple[str, ...]:
    return (names,) if isinstance(names, str) else tuple(names)


def _si(value: Any, quantity: str, field: str) -> float:
    try:
        return float(to_si(value, QUANTITIES[quantity].unit))
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error


def _one(
    file: Any, otherwise: Mapping[str, float], columns: Mapping[str, Any], held: Mapping[str, Any],
    settings: Settings, by: str | None, several: bool, sheet: str | int | None, header: int | None,
) -> Data:  # fmt: skip
    """The data of one file."""
    names = [str(name) for name in columns.values()] + [by for by in (by,) if by]
    table = table_of(file, names, sheet, header)
    notes: list[str] = list(table.notes)
    mark = settings["mark"] or decimal_mark(_numeric(table, columns), table.source)
    if by and by not in TOLD_APART:
        columns = dict(columns) | {"test": by}
    chosen, more = choose(table, columns, settings["units"], held, otherwise, mark)
    notes += more
    found, whole = converted(table, chosen, dict(settings) | {"mark": mark}, notes)
    if "force" in chosen and "force" not in settings["reverse"]:
        notes.append("force: positive taken as the muscle pulling its fittings together")
    found = {name: values[whole] for name, values in found.items()}
    cells = {name: _cells(table, chosen[name], whole) for name in LABELS if name in chosen}
    count, stem = int(whole.sum()), Path(file).stem if isinstance(file, (str, PathLike)) else "table"
    fixed = {name: value for name, value in held.items() if not isinstance(value, Mapping)}
    for name, value in fixed.items():
        found[name] = np.full(count, _si(value, name, f"held.{name}"))
    told, which, note = _tests(found, cells, by, stem, several)
    notes += filter(None, (note,))
    for name, value in held.items():
        if isinstance(value, Mapping):
            found[name] = _by_test(value, name, told)[which]
    for name, number in otherwise.items():
        if not (set(found) & set(KINDS) if name in KINDS else name in found):
            found[name] = np.full(count, number)
    measured = measured_kind(found)
    longer = -found[measured] if measured == "contraction" else found[measured]
    return Data(
        source=table.source, tests=told, which=which,
        branches=_branches(table, cells.get("branch"), chosen, found["pressure"], longer, which, whole, notes),
        rows=table.lines[whole], pressure=found["pressure"], force=found["force"], measured=measured,
        shape=found[measured], rest_length=found.get("rest_length"), free_length=found.get("free_length"),
        assumptions=tuple(dict.fromkeys(notes)),
    )  # fmt: skip


def _numeric(table: Table, columns: Mapping[str, Any]) -> list[Sequence[object]]:
    """The columns that the user or their heads say to hold numbers that are read."""
    said = {column_named(table, of, f"columns.{name}") for name, of in columns.items() if name in QUANTITIES}
    read = {k for k, head in enumerate(table.heads) if set(head.readings) & set(QUANTITIES)}
    return [table.columns[k] for k in sorted(said | read)]


def _cells(table: Table, column: int, whole: np.ndarray) -> list[object]:
    return [cell for cell, kept in zip(table.columns[column], whole.tolist(), strict=True) if kept]


def _tests(
    found: Mapping[str, np.ndarray], cells: Mapping[str, Sequence[object]], by: str | None, stem: str, several: bool
) -> tuple[tuple[str, ...], np.ndarray, str]:
    """Names of the tests of one file, which of them each point has, and what was taken for granted."""
    count = len(next(iter(found.values())))
    names: tuple[str, ...] = (stem,)
    which, note = np.zeros(count, int), ""
    kind = next((kind for kind in KINDS if kind in found), None)
    shape = None if kind is None else found[kind]
    unit = "1" if kind == "contraction" else "m"
    if "test" in cells:
        names, which = groups.by_label(cells["test"])
    if (len(names) == 1 or by in ("pressure", "length")) and by != "file":
        only = {"pressure": (found.get("pressure"), None), "length": (None, shape)}
        pressure, length = only.get(str(by), (found.get("pressure"), shape))
        grouped = groups.by_level(pressure, length, unit, asked=by in only)
        if grouped is None and by in only:
            raise SpecError("tests", by, "does not take a few values that stand apart", "name a column, or file")
        if grouped is not None:
            names, which, what = grouped
            if len(names) > 1:
                note = f"tests: told apart by {what}, which takes {len(names)} values"
        elif "test" not in cells and "pressure" in found and shape is not None:
            note = "tests: taken as one, as neither pressure nor length stays the same for several rows on end"
    if several and "test" not in cells:
        names = (stem,) if len(names) == 1 else tuple(f"{stem}, {name}" for name in names)
    return names, which, note


def _by_test(value: Mapping[Any, Any], name: str, tests: tuple[str, ...]) -> np.ndarray:
    """A held quantity that every test has a value of its own of."""
    for test in tests:
        if test not in value:
            said = f'says nothing of the test "{test}"'
            raise SpecError(f"held.{name}", allowed=said, advice=f"the tests are {', '.join(tests)}")
    return np.array([_si(value[test], name, f"held.{name}.{test}") for test in tests])


def _branches(
    table: Table, cells: Sequence[object] | None, chosen: Mapping[str, int], pressure: np.ndarray, longer: np.ndarray,
    which: np.ndarray, whole: np.ndarray, notes: list[str],
) -> np.ndarray:  # fmt: skip
    """The branch of each point."""
    if cells is not None:
        said = [branches.read_word(str(cell)) for cell in cells]
        if None in said:
            k = said.index(None)
            place = table.place(int(np.flatnonzero(whole)[k]), chosen["branch"])
            advice = f"or say {remedy('columns', 'branch', '...')}"
            raise SpecError(place, cells[k], 'must be "loading" or "unloading"', advice)
        return np.array(said, "<U9")
    found = np.full(len(which), branches.UNKNOWN, "<U9")
    for test in range(int(which.max(initial=-1)) + 1):
        of = which == test
        rising = branches.loading(branches.driven(pressure[of], longer[of]))
        if rising is None:
            notes.append("branch: unknown where the points of a test come in no order")
        else:
            found[of] = np.where(rising, branches.LOADING, branches.UNLOADING)
    return found
