"""`mckibben fit`: the muscle behind measured forces, from a fit file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json
from mckibben.app.options import AsJson, Quiet
from mckibben.app.outputs import Outputs

__all__ = ["EPILOG", "fit"]

EPILOG = examples(
    "mckibben fit fit.toml",
    "mckibben fit fit.toml -o fit.nc --plot fit.png",
    "mckibben fit fit.toml --muscle fitted.toml --set options.starts=20",
    "mckibben plot fit.nc",
)


@command
def fit(
    file: Annotated[Path, typer.Argument(metavar="FIT.toml", help="the fit file: muscle, data and what is free")],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="change a value of the muscle, or such as options.starts=1"),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to fit.nc (everything) or fit.csv (the points)"),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--plot", metavar="PICTURE", help="draw the fit: .png, .pdf, .svg or .html")
    ] = None,
    muscle: Annotated[
        Path | None, typer.Option("--muscle", metavar="FILE.toml", help="write the fitted muscle, for a case file")
    ] = None,
    profiles: Annotated[
        bool, typer.Option("--profiles", help="intervals by the profile likelihood, which takes longer")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="replace output files that exist")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Find numbers of a muscle so that its forces differ least from measured ones.

    The file has the muscle, the measured data and the ranges of what is free. The numbers are shown with their errors,
    and what the data do not determine is said instead of a number.

    The exit code is 0 also where some numbers are not determined, 2 for wrong input, and 3 if the search had not
    settled: what was found is shown and saved all the same.
    """
    outputs = Outputs(output, picture, muscle, force)
    outputs.check()
    from mckibben.fitting.fitfile import read_fit

    asked = read_fit(file, overrides or ())
    options = asked.options | ({"profiles": True} if profiles else {})
    from time import perf_counter

    from mckibben.app import fitted
    from mckibben.app.solving import solving

    begun, tried = perf_counter(), 0
    with solving("fit", hidden=quiet or as_json, unit="muscles") as watch:
        from mckibben.fitting import fit as fitting

        def told(count: int) -> None:
            nonlocal tried
            tried = max(tried, count)
            watch(count, 0)

        found = fitting.fit(asked.muscle, asked.data, asked.free, **options, watch=told)
    seconds = perf_counter() - begun
    if not (quiet or as_json):  # before saving, in case that fails
        fitted.show(found, seconds, tried)
    files = outputs.write(found, fitted.muscle_text(found))
    if as_json:
        show_json(fitted.as_json(found, seconds, tried, files))
    elif not quiet:
        for name in filter(None, files.values()):
            say(f"saved to {name}")
    return COMPLETE if found.converged else INCOMPLETE
