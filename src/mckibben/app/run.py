"""`mckibben run`: a test on a muscle, from a case file."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import command, examples, say, show_json

__all__ = ["EPILOG", "run"]

EPILOG = examples(
    "mckibben presets paper --toml > case.toml",
    "mckibben run case.toml",
    "mckibben run case.toml -o out.nc",
    'mckibben run case.toml --set braid.angle="36 deg" --set test.pressure="0 to 2 bar" -o out.csv',
    "mckibben run case.toml --json | jq '.states[].force'",
)


class Discretisation(StrEnum):
    """The functions that the shape is a sum of."""

    spectral = "spectral"
    paper = "paper"


@command
def run(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle and a test")],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='change a value of the case, such as braid.angle="36 deg"'),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to out.nc (everything) or out.csv (the table)"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="replace the output file if it exists")] = False,
    tolerance: Annotated[float, typer.Option(help="relative error aimed at, from 1e-10 to 1e-2")] = 1e-6,
    discretisation: Annotated[
        Discretisation, typer.Option(help="spectral, or the paper's 43 B-splines to compare with")
    ] = Discretisation.spectral,
    as_json: Annotated[
        bool, typer.Option("--json", help="print one JSON object, in SI units, and nothing else")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print nothing but errors")] = False,
) -> int:
    """Run the test of a case file and show its states.

    The exit code is 0 if every state was found, 2 for wrong input, and 3 if part of the test has no admissible
    equilibrium or was not reached: what was found is shown and saved all the same.
    """
    from mckibben.files import store
    from mckibben.files.case import read_case

    asked = read_case(case, overrides or ())
    assert asked.test is not None  # read_case raises without a test
    if output is not None:
        store.check_output(output, force)
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
