"""`mckibben run`: a test on a muscle, from a case file."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mckibben.app.console import command, examples, say, show_json
from mckibben.app.options import AsJson, Force, Overrides, Quiet, Tolerance

if TYPE_CHECKING:
    from mckibben.spec.text import Case

__all__ = ["EPILOG", "run"]

EPILOG = examples(
    "mckibben presets paper --toml > case.toml",
    "mckibben run case.toml",
    "mckibben run case.toml -o out.nc",
    'mckibben run case.toml --set braid.angle="36 deg" --set test.pressure="0 to 2 bar" -o out.csv',
    'mckibben run case.toml --pressure "1 bar" --pressure "2 bar" -o out.nc',
    "mckibben run case.toml --json | jq '.states[].force'",
)


class Discretisation(StrEnum):
    """The functions that the shape is a sum of."""

    spectral = "spectral"
    paper = "paper"


@command
def run(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle and a test")],
    overrides: Overrides = None,
    pressure: Annotated[
        list[str] | None,
        typer.Option(metavar="PRESSURE", help='in place of test.pressure; repeated, a curve for each: "1 bar"'),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to out.nc (everything) or out.csv (the table)"),
    ] = None,
    force: Force = False,
    tolerance: Tolerance = 1e-6,
    discretisation: Annotated[
        Discretisation, typer.Option(help="spectral, or the paper's 43 B-splines to compare with")
    ] = Discretisation.spectral,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Run the test of a case file and show its states.

    The exit code is 0 if every state was found, 2 for wrong input, and 3 if part of the test has no admissible
    equilibrium or was not reached: what was found is shown and saved all the same.

    With several pressures the test is run at each of them, and the files are named by them: out_1_bar.nc, out_2_bar.nc;
    with --json there is an object on a line for each.
    """
    if not pressure:
        return _one(case, overrides or [], output, force, tolerance, discretisation, as_json, quiet)
    several = len(pressure) > 1
    named = [_named(output, text) if several else output for text in pressure]
    for text, target in zip(pressure, named, strict=True):  # all that can be wrong, before anything takes time
        _asked(case, [*(overrides or []), f"test.pressure={text}"], target, force)
    codes = []
    for text, target in zip(pressure, named, strict=True):
        given = [*(overrides or []), f"test.pressure={text}"]
        codes.append(_one(case, given, target, force, tolerance, discretisation, as_json, quiet))
    return max(codes)


def _named(output: Path | None, pressure: str) -> Path | None:
    """out.nc and "1 bar": out_1_bar.nc."""
    if output is None:
        return None
    return output.with_name(f"{output.stem}_{re.sub(r'[^A-Za-z0-9.+-]+', '_', pressure.strip())}{output.suffix}")


def _asked(case: Path, overrides: list[str], output: Path | None, force: bool) -> Case:
    """The case, and a place for its result. SpecError if either will not do."""
    from mckibben.files import store
    from mckibben.files.case import read_case

    asked = read_case(case, overrides)
    if output is not None:
        store.check_output(output, force)
    return asked


def _one(
    case: Path, overrides: list[str], output: Path | None, force: bool, tolerance: float,
    discretisation: Discretisation, as_json: bool, quiet: bool,
) -> int:  # fmt: skip
    """Run, show and save one test; the exit code."""
    from mckibben.files import store

    asked = _asked(case, overrides, output, force)
    assert asked.test is not None  # read_case raises without a test
    from mckibben.app.solving import solving

    with solving(asked.test.kind, hidden=quiet or as_json) as watch:
        from mckibben.experiments import run as experiment

        result = experiment.run(
            asked.muscle, asked.test, tolerance=tolerance, discretisation=str(discretisation), watch=watch
        )
    from mckibben.app import states

    if not (quiet or as_json):  # before saving, in case that fails
        states.show(result, tolerance)
    if output is not None:
        store.save(result, output, force)
        if not (quiet or as_json):
            say(f"saved to {output}")
    if as_json:
        show_json(states.as_json(result, None if output is None else str(output)))
    return states.exit_code(result)
