"""`mckibben datasheet`: one or two pages on a muscle, for a colleague."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from mckibben.app.console import COMPLETE, command, examples, say
from mckibben.app.options import Force, Overrides, Quiet

__all__ = ["EPILOG", "datasheet"]

EPILOG = examples(
    "mckibben datasheet muscle.toml -o sheet.pdf",
    'mckibben datasheet muscle.toml --pressure "3 bar" --fibre-density "1380 kg/m^3" -o sheet.html',
)


@command
def datasheet(
    case: Annotated[Path, typer.Argument(metavar="MUSCLE.toml", help="the case file: a muscle")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="the sheet: .pdf or .html")],
    pressure: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PRESSURE", help="the largest one, or repeated, rising; by default the test's or preset's"
        ),
    ] = None,
    overrides: Overrides = None,
    fibre_density: Annotated[str | None, typer.Option(metavar="DENSITY", help='such as "1380 kg/m^3"')] = None,
    chamber_density: Annotated[str | None, typer.Option(metavar="DENSITY", help="likewise; both for the mass")] = None,
    date: Annotated[str | None, typer.Option(help=r"date of the sheet \[default: today]")] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> int:
    """Write a datasheet of a muscle: drawing, curves, key numbers, parameters, assumptions and limits.

    What cannot be computed is told with its reason, and assumed parameters are marked.
    """
    from mckibben.files.case import read_case
    from mckibben.sheet.datasheet import check_sheet
    from mckibben.sheet.datasheet import datasheet as sheet

    asked = read_case(case, overrides or (), test_required=False)
    check_sheet(output, force)
    wanted: Any = pressure if pressure is None or len(pressure) > 1 else pressure[0]
    if wanted is None and asked.test is not None:
        wanted = _largest(asked.test)
    from mckibben.app.solving import solving

    with solving("datasheet", hidden=quiet, unit="parts") as watch:
        sheet(
            asked.muscle, output, pressure=wanted, fibre_density=fibre_density, chamber_density=chamber_density,
            date=date, force=force, watch=watch,
        )  # fmt: skip
    if not quiet:
        say(f"saved to {output}")
    return COMPLETE


def _largest(test: Any) -> str | None:
    """The largest pressure that the file's test goes to; None where it says none above zero."""
    steps = getattr(test, "steps", (test,))
    paths = [step.pressure for step in steps if getattr(step, "pressure", None) is not None]
    most = max((float(value) for path in paths for value in path.waypoints), default=0.0)
    return f"{most!r} Pa" if most > 0.0 else None
