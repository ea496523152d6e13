"""`mckibben simulate`: a rig in motion, from a rig file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json
from mckibben.app.options import AsJson, Force, Quiet
from mckibben.app.outputs import Outputs

__all__ = ["EPILOG", "simulate"]

EPILOG = examples(
    "mckibben simulate rig.toml",
    "mckibben simulate rig.toml -o motion.nc --plot motion.png",
    'mckibben simulate rig.toml --set "load.mass=3 kg" --set "until=2 s" -o motion.csv',
    "mckibben plot motion.nc",
)


@command
def simulate(
    file: Annotated[Path, typer.Argument(metavar="RIG.toml", help="the rig: muscle, load, supply, valve, command")],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='change a value, such as "load.mass=3 kg" or "until=2 s"'),
    ] = None,
    chart: Annotated[
        Path | None, typer.Option("--chart", metavar="CHART.nc", help="a map of the muscle that mckibben chart saved")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to motion.nc (everything) or motion.csv (a table)"),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--plot", metavar="PICTURE", help="draw the motion: .png, .pdf, .svg or .html")
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Set a rig in motion: muscle, load, air and valve over time.

    The file has the tables of the muscle, load, supply, valve and command, and how long to simulate. What moves is the
    map of the muscle, which is made first (some seconds), or given.

    The exit code is 3 if the simulation stopped before the end, or left the map: what was reached is shown and saved.
    """
    outputs = Outputs(output, picture, None, force)
    outputs.check()
    from mckibben.motion.rigfile import read_rig

    asked = read_rig(file, overrides or ())
    from time import perf_counter

    from mckibben.app import moved
    from mckibben.app.solving import solving

    with solving("simulation", hidden=quiet or as_json, unit="times") as watch:
        from mckibben.files import store
        from mckibben.motion import simulate as moving
        from mckibben.motion.maps import maps_of

        given = None if chart is None else store.load(chart)
        charts = maps_of(asked.rig, given)
        begun = perf_counter()
        options = {name: value for name, value in asked.options.items() if name != "until"}
        found = moving.simulate(asked.rig, asked.options["until"], chart=charts, **options, watch=watch)
        seconds = perf_counter() - begun
    if not (quiet or as_json):  # before saving, in case that fails
        moved.show_motion(found, seconds)
    files = outputs.write(found, "")
    if as_json:
        show_json(moved.as_json(found, files))
    elif not quiet:
        for name in filter(None, files.values()):
            say(f"saved to {name}")
    return COMPLETE if found.complete and found.inside else INCOMPLETE
