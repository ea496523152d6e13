"""`mckibben plot` and `mckibben reproduce`: pictures of a saved result, and of the paper's tests."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mckibben.app.console import command, examples, say, table
from mckibben.app.options import Columns, Held, Units, pairs
from mckibben.app.outputs import PICTURES, PIXELS, check_picture, picture

__all__ = ["PLOT", "REPRODUCE", "plot", "reproduce"]

PLOT = examples(
    "mckibben plot out.nc",
    "mckibben plot out.nc -o force.pdf",
    "mckibben plot out.nc -o force.html",
    "mckibben plot out.nc --kind tension -o tension.svg",
    "mckibben plot out.nc --data bench.csv",
)
REPRODUCE = examples(
    "mckibben reproduce", "mckibben reproduce -o paper --force", "mckibben reproduce --measured a=lab.csv"
)


class Kind(StrEnum):
    """What to draw."""

    auto = "auto"
    profiles = "profiles"
    tension = "tension"
    energy = "energy"
    shares = "shares"


@command
def plot(
    file: Annotated[Path, typer.Argument(metavar="FILE.nc", help="what run, fit, design, chart or simulate saved")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PICTURE",
            help=r"the picture: .png, .pdf, .svg, or an interactive .html \[default: FILE.png]",
        ),
    ] = None,
    kind: Annotated[
        Kind, typer.Option(help="auto: the curve of the test; profiles: radius and angle along the muscle")
    ] = Kind.auto,
    force: Annotated[bool, typer.Option("--force", help="replace the picture if it exists")] = False,
    data: Annotated[
        Path | None, typer.Option(metavar="FILE", help="measured points to lay over the curve: CSV, TSV, XLSX or MAT")
    ] = None,
    columns: Columns = None,
    units: Units = None,
    held: Held = None,
) -> None:
    """Draw a saved result, without solving anything again.

    An .html is one page for a browser in which every point tells its numbers; it needs no network.

    With --data, measured points are drawn over the curve, and how far it is from them is noted and printed. How their
    file is read, mckibben data check tells; --column, --unit and --held are of that file.
    """
    from mckibben import disk
    from mckibben.files import store

    target = file.with_suffix(".png") if output is None else output
    suffix = store.suffix_of(target, PICTURES)
    disk.check_target(target, force)
    check_picture(target)
    result = store.load(file)
    measured = None
    if data is not None:
        from mckibben.data import compare, read

        asked = pairs("--column", columns), pairs("--unit", units), pairs("--held", held)
        measured = read.read_data(data, columns=asked[0], units=asked[1], held=asked[2])
    from mckibben.results.result import Result

    disk.write(target, picture(result, suffix, PIXELS, str(kind), measured), force)
    say(f"drawn: {target}")
    if measured is not None and isinstance(result, Result):
        for note in measured.assumptions:
            say(f"{measured.source}: {note}")
        say(f"model less measured: {compare.compare(result, measured)}")


@command
def reproduce(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="the folder of the pictures")] = Path(
        "out"
    ),
    force: Annotated[bool, typer.Option("--force", help="replace pictures that exist")] = False,
    measured: Annotated[
        list[str] | None,
        typer.Option(metavar="CASE=FILE.csv", help="a measured curve to draw beside case a, b, c or d"),
    ] = None,
) -> None:
    """Run the tests of the paper, draw its figures, and sum up how the numbers compare.

    A measured curve is a file as mckibben data check takes it: pressure and force (a, b), or pressure and length (c,
    d). How far the model is from it is noted in the figure and printed. No measured data come with this package.
    """
    curves = dict(_pair(text) for text in measured or ())
    from mckibben.app.solving import solving

    with _folder(output), solving("reproducing") as watch:
        from mckibben.paper import reproduce as making

        made = making.reproduce(output, watch=watch, measured=curves, force=force)
    rows = [
        (
            row.case,
            row.what,
            row.unit,
            *("-" if x is None else f"{x:.5g}" for x in (row.model, row.formula, row.stated)),
        )
        for row in made.rows
    ]
    columns = ("case", "what", "model", "Eq. (31)", "stated")
    say(table(columns, rows, title="The paper's actuator", right=(2, 3, 4), whole=()))
    say("model: this package; Eq. (31): the formula without stored energy; stated: the values of docs/theory.md")
    say("assumed, not measured: " + ", ".join(made.muscle.assumed))
    for name, points in made.measured.items():
        say(f"{name}: {points.said}")
    for path in made.pictures:
        say(str(path))


def _pair(text: str) -> tuple[str, str]:
    name, equals, path = text.partition("=")
    if not (equals and name and path):
        from mckibben.spec.errors import SpecError

        raise SpecError("--measured", text, "must be CASE=FILE.csv", 'write it like "a=lab.csv"')
    return name.strip(), path.strip()


@contextmanager
def _folder(folder: Path) -> Iterator[None]:
    """Make the folder of the pictures and see that files can be made in it, before anything takes time.

    What was made goes again if the work inside fails and left it empty.
    """
    from mckibben import disk
    from mckibben.spec.errors import SpecError

    missing = [part for part in (folder, *folder.parents) if not part.exists()]
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SpecError(str(folder), allowed=f"cannot be made: {error.strerror or error}") from error
        disk.check_target(folder / "picture.pdf", force=True)
        yield
    except BaseException:
        with suppress(OSError):  # the first that is not empty ends it
            for part in missing:
                part.rmdir()
        raise
