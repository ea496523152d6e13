"""`mckibben design`: the muscle that does what is wanted, from a design file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json
from mckibben.app.options import AsJson, Quiet
from mckibben.app.outputs import Outputs

__all__ = ["EPILOG", "design"]

EPILOG = examples(
    "mckibben design design.toml",
    "mckibben design design.toml -o design.nc --plot design.png",
    "mckibben design design.toml --muscle best.toml --set options.designs=5000",
    "mckibben plot design.nc",
)


@command
def design(
    file: Annotated[
        Path, typer.Argument(metavar="DESIGN.toml", help="the design file: muscle, what is free and what is wanted")
    ],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="change a value of the muscle, or such as options.seed=1"),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="save to design.nc (everything) or design.csv (a table)"),
    ] = None,
    picture: Annotated[
        Path | None, typer.Option("--plot", metavar="PICTURE", help="draw the design: .png, .pdf, .svg or .html")
    ] = None,
    muscle: Annotated[
        Path | None, typer.Option("--muscle", metavar="FILE.toml", help="write the best muscle, for a case file")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="replace output files that exist")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Find the muscle that does best what is wanted, within limits.

    The file has a muscle, what is free in it (ranges, whole numbers, lists), an objective and demands. What is shown is
    the best design, what it does, which demands it just meets and what a little more room would give; several
    objectives give a front. Ctrl-C ends the search with the best so far.

    The exit code is 0, 2 for wrong input, and 3 if the demands cannot be met together or the search had not settled:
    what was found is shown and saved all the same.
    """
    outputs = Outputs(output, picture, muscle, force)
    outputs.check()
    from mckibben.designing.designfile import read_design

    asked = read_design(file, overrides or ())
    from time import perf_counter

    from mckibben.app import designed
    from mckibben.app.solving import solving

    begun = perf_counter()
    with solving("design", hidden=quiet or as_json, unit="designs") as watch:
        from mckibben.designing import design as designing

        found = designing.design(
            asked.muscle, asked.free, asked.objective, asked.subject_to, **asked.options, watch=watch,
        )  # fmt: skip
    seconds = perf_counter() - begun
    if not (quiet or as_json):  # before saving, in case that fails
        designed.show(found, seconds)
    files = outputs.write(found, designed.muscle_text(found))
    if as_json:
        show_json(designed.as_json(found, seconds, files))
    elif not quiet:
        for name in filter(None, files.values()):
            say(f"saved to {name}")
    return COMPLETE if found.feasible and found.converged else INCOMPLETE
