"""Results as CSV tables, one row per state; a text file beside a table says what was computed and by what."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mckibben import disk
from mckibben.results.result import Result
from mckibben.results.rows import COLUMNS, headed, rows
from mckibben.results.sensitivity import Sensitivity
from mckibben.results.tolerances import Tolerances
from mckibben.results.variables import has

__all__ = ["map_csv", "map_rows", "notes_file", "save_csv", "save_sensitivity", "save_tolerances", "write"]


if TYPE_CHECKING:
    from xarray import Dataset


def notes_file(path: str | PathLike[str]) -> Path:
    """The file beside a table that says what was computed and by what: out.csv.txt beside out.csv."""
    return Path(f"{fspath(path)}.txt")


def save_csv(result: Result, path: str | PathLike[str], force: bool = False) -> Path:
    """Write the variables per state as a table in SI units, NaN as an empty cell. It cannot be loaded as a result."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    names = [name for name in COLUMNS if has(result.muscle, name)]
    writer.writerow(["state", *(headed(name, COLUMNS[name][0]) for name in names)])
    for state, row in enumerate(rows(result)):
        writer.writerow([state, *(_cell(row[name]) for name in names)])
    return write(path, _comments(result), text.getvalue(), force)


def write(path: str | PathLike[str], notes: Iterable[str], text: str, force: bool) -> Path:
    """A table that any program reads, and the notes on it in a file beside it."""
    disk.check_target(path, force)
    told = "".join(f"{line}".rstrip() + "\n" for line in notes)
    disk.write(notes_file(path), told.encode("utf-8"), force)
    return disk.write(path, text.encode("utf-8"), force)


def save_sensitivity(found: Sensitivity, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a sensitivity as a table: a row for each number, with per cents and SI derivative of each result."""
    data, text = found.data, io.StringIO(newline="")
    about = data.attrs
    lines = [about["title"], f"made by mckibben {about['mckibben_version']}", f"{found.verdict}: {found.reason}"]
    lines += [about["angles"], f"assumed, not measured: {about['assumed'] or 'nothing'}"]
    for table in ("muscle", "test"):
        lines += ["", f"the {table} (TOML):", *about[table].splitlines()]
    results = [str(name) for name in data["result"].values]
    header = ["number", "value", "unit", "assumed", *(f"{name} [% per %]" for name in results)]
    units = dict(zip(results, data["result_unit"].values.tolist(), strict=True))
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*header, *(f"{name} [{units[name]} per unit]" for name in results)])
    for k in found.order:
        known = [data[f"number{part}"].values[k].item() for part in ("", "_value", "_unit", "_assumed")]
        shares = [*data["relative"].values[k].tolist(), *data["absolute"].values[k].tolist()]
        writer.writerow([*map(_cell, known), *(_cell(None if share != share else share) for share in shares)])
    return write(path, lines, text.getvalue(), force)


def save_tolerances(found: Tolerances, path: str | PathLike[str], force: bool = False) -> Path:
    """Write tolerances as a table in SI units: a row for each number, with its part in each result."""
    data, text = found.data, io.StringIO(newline="")
    about = data.attrs
    lines = [about["title"], f"made by mckibben {about['mckibben_version']}", *found.notes, ""]
    lines += found.spread.to_string().splitlines()
    for table in ("muscle", "test"):
        lines += ["", f"the {table} (TOML):", *about[table].splitlines()]
    known = ["value", "tolerance", "deviation", "distribution", "unit", "assumed"]
    parts = [(name, kind) for name in range(len(found.results)) for kind in ("effect", "share", "first", "total")]
    units = data["result_unit"].values.tolist()
    heads = [f"{found.results[k]} {kind}" + (f" [{units[k]}]" if kind == "effect" else "") for k, kind in parts]
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["number", *known, *heads])
    for row in found.order.tolist():
        values = [data[kind].values[row, k].item() for k, kind in parts]
        told = [data[f"number_{kind}"].values[row].item() for kind in known]
        cells = [None if value != value else value for value in values]
        writer.writerow([found.numbers[row], *map(_cell, told), *map(_cell, cells)])
    return write(path, lines, text.getvalue(), force)


def map_rows(data: Dataset, units: bool = True) -> list[dict[str, Any]]:
    """The points of a force map or a working range as plain values in SI, None for NaN; with `units` in their names."""
    frame = data.to_dataframe().reset_index()
    if units:
        known = {str(name): str(item.attrs.get("units", "")) for name, item in data.variables.items()}
        frame = frame.rename(columns={name: headed(name, known.get(name, "")) for name in frame.columns})
    records: list[dict[str, Any]] = frame.to_dict("records")
    return [{name: None if value != value else value for name, value in row.items()} for row in records]


def map_csv(data: Dataset) -> str:
    """A force map or a working range as a CSV table in SI units."""
    text, records = io.StringIO(newline=""), map_rows(data)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(records[0])
    writer.writerows([_cell(value) for value in row.values()] for row in records)
    return text.getvalue()


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else str(value)  # str of a float has all its digits, so that it reads back equal


def _comments(result: Result) -> Iterator[str]:
    about = result.attributes
    yield about["title"]
    yield f"made by mckibben {about['mckibben_version']} ({about['versions']}) on {about['date']}"
    yield f"assumed, not measured: {about['assumed'] or 'nothing'}"
    for warning in filter(None, about["warnings"].splitlines()):
        yield f"warning: {warning}"
    yield "units are SI, in brackets; force > 0 pulls the fittings together; pressure is gauge"
    for table in ("muscle", "test"):
        yield ""
        yield f"the {table} (TOML):"
        yield from about[table].splitlines()
    yield ""
