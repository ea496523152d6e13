"""`mckibben export`: a map of a muscle for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.chart import MapTolerance
from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say
from mckibben.app.options import Force, Overrides, Quiet

__all__ = ["EPILOG", "export"]

EPILOG = examples(
    "mckibben export chart.nc -o muscle.h",
    "mckibben export chart.nc -o muscle.mat --points 101,61",
    'mckibben export chart.nc -o lift.fmu --mass "2 kg"',
    'mckibben export case.toml --length "60 mm to 115 mm" --pressure "0 to 3 bar" -o muscle.py',
)


@command
def export(
    file: Annotated[
        Path, typer.Argument(metavar="CASE.toml|CHART.nc", help="a muscle, or what mckibben chart saved of one")
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="C (.h), Python (.py), FMI (.fmu), MuJoCo (.xml, .c), or tables: .csv, .mat, .json, Modelica's .txt",
        ),
    ],
    length: Annotated[str | None, typer.Option(metavar="LENGTHS", help='of a muscle: "60 mm to 115 mm"')] = None,
    pressure: Annotated[str | None, typer.Option(metavar="PRESSURES", help='of a muscle: "0 to 3 bar"')] = None,
    tolerance: MapTolerance = 1e-4,
    overrides: Overrides = None,
    points: Annotated[str, typer.Option(help="lengths and pressures of a table")] = "56,31",
    name: Annotated[str, typer.Option(help="what the functions in C begin with; of an FMU, of an actuator")] = "muscle",
    mass: Annotated[
        str | None,
        typer.Option(metavar="MASS", help='.fmu, .xml: hangs on the muscle, such as "2 kg"; an FMU has a valve then'),
    ] = None,
    fmi: Annotated[int | None, typer.Option(help=".fmu: the version of FMI, 2 (by default) or 3")] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> int:
    """Write a map of a muscle for another program; the ending of FILE says which.

    C and Python are the map itself, with its slopes, and go on smoothly outside of its range. Tables are over even
    lengths and pressures, in SI units. An FMU is compiled from C, which it holds as well, and needs no Python. A model
    for MuJoCo (.xml) has an affine actuator; its largest error is printed, and stands in the file. A plugin (.c) is the
    map itself, for MuJoCo alone.

    The exit code is 3 if the error of a map that is made here is above the tolerance.
    """
    from mckibben.files import store
    from mckibben.spec.errors import SpecError

    made_here = file.suffix.lower() != ".nc"
    if not made_here and (length is not None or pressure is not None or overrides):
        raise SpecError("export", allowed="a map has its muscle and range", advice="leave out what is for a muscle")
    parts = points.split(",")
    if len(parts) != 2 or not all(part.strip().isdecimal() for part in parts):
        raise SpecError("--points", points, "must be two whole numbers", "such as 56,31")
    size = int(parts[0]), int(parts[1])
    from mckibben.exports.export import export as exporting
    from mckibben.exports.export import how

    how(output, size, name, mass, force, fmi)
    from mckibben.app import charted

    if made_here:
        found = charted.made(file, overrides, length, pressure, tolerance, hidden=quiet)
    else:
        from mckibben.potential.chart import Chart

        loaded = store.load(file)
        if not isinstance(loaded, Chart):
            raise SpecError(str(file), allowed="holds no map", advice="give what mckibben chart saved")
        found = loaded
    exporting(found, output, points=size, name=name, mass=mass, fmi=fmi, force=force)
    if not quiet:
        charted.show(found)
        if output.suffix.lower() == ".xml":
            from mckibben.exports.affine import affine

            law = affine(found)
            share = f"{100.0 * law.error / law.largest:.2g} % of the largest"
            say(f"- the affine actuator is off the map by up to {law.error:.2g} N, {share}")
        say(f"saved to {output}")
    return COMPLETE if found.converged or not made_here else INCOMPLETE
