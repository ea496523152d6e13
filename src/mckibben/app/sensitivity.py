"""`mckibben sensitivity`: what drives the result of a test."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json, table
from mckibben.app.options import AsJson, Force, Overrides, Quiet, Tolerance
from mckibben.app.outputs import numbers as plain_numbers
from mckibben.app.outputs import picture

if TYPE_CHECKING:
    from mckibben.results.sensitivity import Sensitivity

__all__ = ["SENSITIVITY", "sensitivity"]

SENSITIVITY = examples(
    "mckibben sensitivity case.toml",
    "mckibben sensitivity case.toml -o tornado.png",
    "mckibben sensitivity case.toml --of force --of volume --by braid --state 0 -o table.csv",
)
OUTPUTS = {".csv": "table", ".png": "tornado chart", ".pdf": "the same for print", ".svg": "the same for the web"}


@command
def sensitivity(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle and a test")],
    overrides: Overrides = None,
    of: Annotated[
        list[str] | None, typer.Option(metavar="RESULT", help="a result, such as force or peak_fibre_tension")
    ] = None,
    by: Annotated[
        list[str] | None, typer.Option(metavar="NUMBER", help="a number or all within a name: braid.angle, chamber")
    ] = None,
    state: Annotated[int, typer.Option(help="which state of the test: 0 is the first, -1 the last one")] = -1,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="a table (.csv) or a chart (.png, .pdf, .svg)"),
    ] = None,
    force: Force = False,
    tolerance: Tolerance = 1e-6,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Show how much each number of a case matters to the result of its test: per cent per per cent.

    The derivatives are exact ones of the equilibrium. A per cent of an angle is one of the angle from the parallels.
    The exit code is 3 if the state has no admissible equilibrium or was not reached.
    """
    from mckibben import disk
    from mckibben.files import store
    from mckibben.files.case import read_case

    asked = read_case(case, overrides or ())
    assert asked.test is not None  # read_case raises without a test
    suffix = ""
    if output is not None:
        suffix = store.suffix_of(output, OUTPUTS)
        disk.check_target(output, force)
    from mckibben.app.solving import solving

    with solving("sensitivity", hidden=quiet or as_json):
        from mckibben.experiments import sensitivity as derivative

        found = derivative.sensitivity(asked.muscle, asked.test, of or None, by or None, state, tolerance=tolerance)
    if not (quiet or as_json):
        _show(found)
    if output is not None:
        _save(found, output, suffix, force)
        if not (quiet or as_json):
            say(f"saved to {output}")
    if as_json:
        show_json(_as_json(found, None if output is None else str(output)))
    return COMPLETE if found.complete else INCOMPLETE


def _save(found: Sensitivity, output: Path, suffix: str, force: bool) -> None:
    from mckibben import disk

    if suffix == ".csv":
        from mckibben.files import table as tables

        tables.save_sensitivity(found, output, force)
        return
    disk.write(output, picture(found, suffix), force)


def _show(found: Sensitivity) -> None:
    """Print the table, the largest influence first, and the notes on it."""
    from mckibben.results.told import verdict
    from mckibben.units import show

    data = found.data
    results = [str(name) for name in data["result"].values]
    cells = []
    for k in found.order:
        shares = [f"{share:+.4g}" if share == share else "-" for share in data["relative"].values[k].tolist()]
        mark = "ASSUMED" if bool(data["number_assumed"].values[k]) else ""
        cells.append([str(data["number"].values[k]), str(data["number_shown"].values[k]), *shares, mark])
    columns = ["number", "value", *(f"{name}\n[% per %]" for name in results), ""]
    title = str(data.attrs["title"])
    say(table(columns, cells, title=title, right=range(2, 2 + len(results)), whole=(0, 1, len(columns) - 1)))
    for k, name in enumerate(results):
        value = float(data["result_value"].values[k])
        if value == value:
            unit = str(data["result_unit"].values[k])
            say(f"{name} = {show(value, unit)}: {data['result_meaning'].values[k]}")
    if found.verdict != "stable":
        say(verdict(found.verdict, found.reason))
    say(f"{data.attrs['angles']}; -: the number, or the result, is zero" if found.complete else data.attrs["angles"])


def _as_json(found: Sensitivity, file: str | None) -> dict[str, Any]:
    """The whole sensitivity for JSON, in SI units, None for NaN."""
    import tomllib

    data = found.data
    results = [str(name) for name in data["result"].values]

    numbers = {}
    for k, name in enumerate(data["number"].values):
        numbers[str(name)] = {
            "value": float(data["number_value"].values[k]),
            "unit": str(data["number_unit"].values[k]),
            "assumed": bool(data["number_assumed"].values[k]),
            "relative": dict(zip(results, plain_numbers(data["relative"].values[k]), strict=True)),
            "absolute": dict(zip(results, plain_numbers(data["absolute"].values[k]), strict=True)),
        }
    about = data.attrs
    values, units = plain_numbers(data["result_value"].values), [str(unit) for unit in data["result_unit"].values]
    return {
        "complete": found.complete,
        "file": file,
        "muscle": tomllib.loads(about["muscle"]),
        "test": tomllib.loads(about["test"]),
        "state": int(about["state"]),
        "verdict": found.verdict,
        "reason": found.reason,
        "results": {n: {"value": v, "unit": u} for n, v, u in zip(results, values, units, strict=True)},
        "numbers": numbers,
        "angles": about["angles"],
        "mckibben_version": about["mckibben_version"],
    }
