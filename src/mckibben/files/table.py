"""Results as CSV tables: one row per state, preceded by comment lines that say what was computed and by what."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben import disk
from mckibben.results.result import Result
from mckibben.results.sensitivity import Sensitivity
from mckibben.results.variables import STEP

__all__ = ["rows", "save_csv", "save_sensitivity"]


def save_csv(result: Result, path: str | PathLike[str], force: bool = False) -> Path:
    """Write the variables per state as a table in SI units, NaN as an empty cell. It cannot be loaded as a result."""
    text = io.StringIO(newline="")
    for line in _comments(result):
        text.write(f"# {line}".rstrip() + "\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["state", *(_header(name) for name in STEP)])
    for state, row in enumerate(rows(result)):
        writer.writerow([state, *(_cell(row[name]) for name in STEP)])
    return disk.write(path, text.getvalue().encode("utf-8"), force)


def save_sensitivity(found: Sensitivity, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a sensitivity as a table: a row for each number, with per cents and SI derivative of each result."""
    data, text = found.data, io.StringIO(newline="")
    about = data.attrs
    lines = [about["title"], f"made by mckibben {about['mckibben_version']}", f"{found.verdict}: {found.reason}"]
    lines += [about["angles"], f"assumed, not measured: {about['assumed'] or 'nothing'}"]
    for table in ("muscle", "test"):
        lines += ["", f"the {table} (TOML):", *about[table].splitlines()]
    for line in [*lines, ""]:
        text.write(f"# {line}".rstrip() + "\n")
    results = [str(name) for name in data["result"].values]
    header = ["number", "value", "unit", "assumed", *(f"{name} [% per %]" for name in results)]
    units = dict(zip(results, data["result_unit"].values.tolist(), strict=True))
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*header, *(f"{name} [{units[name]} per unit]" for name in results)])
    for k in found.order:
        known = [data[f"number{part}"].values[k].item() for part in ("", "_value", "_unit", "_assumed")]
        shares = [*data["relative"].values[k].tolist(), *data["absolute"].values[k].tolist()]
        writer.writerow([*map(_cell, known), *(_cell(None if share != share else share) for share in shares)])
    return disk.write(path, text.getvalue().encode("utf-8"), force)


def rows(result: Result) -> Iterator[dict[str, Any]]:
    """The variables of each state as plain Python values in SI units, None for NaN."""
    columns = {name: result.column(name).tolist() for name in STEP}
    for state in range(len(result)):
        values = {name: column[state] for name, column in columns.items()}
        yield {name: None if value != value else value for name, value in values.items()}


def _header(name: str) -> str:
    unit = STEP[name][0]
    return f"{name} [{unit}]" if unit not in ("", "1") else name


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
