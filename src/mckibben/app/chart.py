"""`mckibben chart`: the map of a muscle over length and pressure, with its error."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json
from mckibben.app.options import AsJson, Force, Overrides, Quiet
from mckibben.app.outputs import Outputs

__all__ = ["EPILOG", "MapTolerance", "chart"]

EPILOG = examples(
    'mckibben chart case.toml --length "60 mm to 115 mm" --pressure "0 to 3 bar" -o chart.nc',
    'mckibben chart case.toml --length "60 mm to 115 mm" --pressure "0 to 3 bar" --plot chart.png',
    "mckibben export chart.nc -o muscle.h",
)

MapTolerance = Annotated[
    float, typer.Option("--tolerance", help="largest error of the force over the largest force, from 1e-6 to 1e-2")
]


@command
def chart(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle; a test is not used")],
    length: Annotated[str | None, typer.Option(metavar="LENGTHS", help='such as "60 mm to 115 mm"')] = None,
    pressure: Annotated[str | None, typer.Option(metavar="PRESSURES", help='such as "0 to 3 bar"')] = None,
    tolerance: MapTolerance = 1e-4,
    overrides: Overrides = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to chart.nc (the map) or chart.csv (a table)"),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--plot", metavar="PICTURE", help="draw the map: .png, .pdf, .svg or .html")
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Make a map of a muscle: force, volume and their slopes over length and pressure, with the largest error.

    Force and volume are slopes of one potential, so that they agree. Lengths at which the muscle is not stable are left
    out, with a note. mckibben export writes a map for C, NumPy, MATLAB and others; plot and info take a saved one.

    The exit code is 3 if the error is above the tolerance; the map is saved all the same.
    """
    outputs = Outputs(output, picture, None, force)
    outputs.check()
    from mckibben.app import charted

    found = charted.made(case, overrides, length, pressure, tolerance, hidden=quiet or as_json)
    if not (quiet or as_json):  # before saving, in case that fails
        charted.show(found)
    files = outputs.write(found, "")
    if as_json:
        show_json(charted.as_json(found) | files)
    elif not quiet:
        for name in filter(None, files.values()):
            say(f"saved to {name}")
    return COMPLETE if found.converged else INCOMPLETE
