"""`mckibben data check`: what a laboratory's file holds, as understood."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import command, examples, say, show_json, table
from mckibben.app.options import AsJson, Columns, Held, Units, pairs

if TYPE_CHECKING:
    from mckibben.data.values import Data

__all__ = ["CHECK", "EPILOG", "check", "data"]

CHECK = examples(
    "mckibben data check bench.csv",
    'mckibben data check bench.xlsx --sheet "3 bar" --column force="Load cell" --unit force=kg',
    'mckibben data check raw.csv --held pressure="3 bar"',
)
EPILOG = examples("mckibben data check bench.csv")
data = typer.Typer(no_args_is_help=True, rich_markup_mode="rich", help="Measured data: look at what a bench wrote.")


@command
def check(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="CSV, TSV, XLSX or MAT; several are several tests")
    ],
    columns: Columns = None,
    units: Units = None,
    held: Held = None,
    reverse: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="a quantity whose sign in the file is the other way round")
    ] = None,
    absolute: Annotated[
        bool | None, typer.Option("--absolute/--gauge", help="what the pressure is, where its head does not say")
    ] = None,
    atmosphere: Annotated[str, typer.Option(help="what to take off an absolute pressure")] = "101325 Pa",
    tests: Annotated[
        str | None, typer.Option(help="what tells tests apart: pressure, length, file, or the head of a column")
    ] = None,
    sheet: Annotated[str | None, typer.Option(help="name or number of the sheet of a workbook")] = None,
    header: Annotated[int | None, typer.Option(help="the line of the heads, the first line being 1")] = None,
    decimal: Annotated[str | None, typer.Option(metavar="MARK", help='the decimal mark, "." or ","')] = None,
    as_json: AsJson = False,
) -> None:
    """Read measured curves and show what was understood: tests, ranges, branches, and what was taken for granted."""
    from mckibben.data.read import read_data

    found = read_data(
        files if len(files) > 1 else files[0], columns=pairs("--column", columns), units=pairs("--unit", units),
        held=pairs("--held", held), reverse=reverse or (), absolute=absolute, atmosphere=atmosphere, tests=tests,
        sheet=sheet, header=header, decimal=decimal,
    )  # fmt: skip
    if as_json:
        show_json(_as_json(found))
        return
    rows = [_row(found.test(name), name) for name in found.tests]
    columns_shown = ("test", "points", "branches", "pressure", found.measured, "force")
    say(table(columns_shown, rows, title=found.source, right=(1,), whole=(0, 3, 4, 5), most=40))
    say("taken for granted:" if found.assumptions else "nothing was taken for granted")
    for note in found.assumptions:
        say(f"- {note}")


def _branches(found: Data) -> dict[str, int]:
    return {word: int((found.branches == word).sum()) for word in dict.fromkeys(found.branches.tolist())}


def _row(test: Data, name: str) -> tuple[str, ...]:
    ways = _branches(test)
    told = ", ".join(ways) if len(ways) == 1 else ", ".join(f"{count} {way}" for way, count in ways.items())
    ranges = (test.described(what) for what in ("pressure", test.measured, "force"))
    return (name, str(len(test)), told, *ranges)


def _as_json(found: Data) -> dict[str, Any]:
    """What `check` understands, for JSON: ranges in SI."""
    tests = []
    for name in found.tests:
        test = found.test(name)
        arrays = {"pressure": test.pressure, found.measured: test.shape, "force": test.force}
        ranges = {what: [float(values.min()), float(values.max())] for what, values in arrays.items()}
        tests.append({"name": name, "points": len(test), "branches": _branches(test), **ranges})
    return {
        "valid": True, "source": found.source, "points": len(found), "measured": found.measured, "tests": tests,
        "assumptions": list(found.assumptions),
    }  # fmt: skip


data.command(epilog=CHECK)(check)


@data.callback(epilog=EPILOG)
def _root() -> None:
    """Measured data: look at what a bench wrote."""
