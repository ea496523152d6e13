"""`mckibben tolerances`: how far the result of a test scatters where numbers of the muscle do."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json, table
from mckibben.app.options import AsJson, Force, Overrides, Quiet, pairs
from mckibben.app.outputs import numbers as plain_numbers
from mckibben.app.outputs import picture

if TYPE_CHECKING:
    from mckibben.results.tolerances import Tolerances

__all__ = ["EPILOG", "tolerances"]

EPILOG = examples(
    'mckibben tolerances case.toml --vary "braid.angle=1 deg" --vary "chamber.thickness=10 %"',
    'mckibben tolerances case.toml --vary "braid.length=0.5 mm uniform" --of force -o spread.png',
)
OUTPUTS = {
    ".nc": "everything, to be loaded again",
    ".csv": "table",
    ".png": "picture",
    ".pdf": "the same for print",
    ".svg": "the same for the web",
}


@command
def tolerances(
    case: Annotated[
        Path, typer.Argument(metavar="CASE.toml", help=r"the case file: a muscle, a test, maybe \[tolerances]")
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="NUMBER=TOLERANCE", help='a number and how far it scatters, such as "braid.angle=1 deg"'),
    ] = None,
    overrides: Overrides = None,
    of: Annotated[
        list[str] | None, typer.Option(metavar="RESULT", help="a result, such as force or peak_fibre_tension")
    ] = None,
    state: Annotated[int, typer.Option(help="which state of the test: 0 is the first, -1 the last one")] = -1,
    distribution: Annotated[
        str, typer.Option(help="normal: a tolerance is one standard deviation; uniform: it is half a range")
    ] = "normal",
    samples: Annotated[int, typer.Option(help="muscles that make the distribution, a power of 2")] = 1024,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE", help="everything (.nc), a table (.csv) or a picture (.png, .pdf, .svg)"
        ),
    ] = None,
    force: Force = False,
    tolerance: Annotated[float, typer.Option(help="relative error of each state, from 1e-10 to 1e-2")] = 1e-4,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Show how far the result of a test scatters where numbers of a case do, and which number has what part in it.

    By derivatives, to first order, and by sampling muscles. A tolerance is one standard deviation of a normal
    distribution, or half the range of a uniform one ("0.1 mm uniform"). What is given here counts before what the
    file's table of tolerances says. The exit code is 3 if the state of any muscle that was tried is not stable.
    """
    from mckibben import disk
    from mckibben.files import store
    from mckibben.files.table import notes_file
    from mckibben.scatter.tolerancefile import read_tolerances
    from mckibben.spec.errors import SpecError

    asked = read_tolerances(case, overrides or ())
    wanted = asked.vary | pairs("--vary", vary, '"braid.angle=1 deg"')
    if not wanted:
        said = r'give --vary "braid.angle=1 deg", or write [tolerances] and "braid.angle" = "1 deg" into the file'
        raise SpecError("tolerances", allowed="none are given", advice=said)
    suffix = ""
    if output is not None:
        suffix = store.suffix_of(output, OUTPUTS)
        for file in (output, *((notes_file(output),) if suffix == ".csv" else ())):
            disk.check_target(file, force)
    from mckibben.app.solving import solving

    with solving("tolerances", hidden=quiet or as_json, unit="muscles") as watch:
        from mckibben.scatter.tolerances import tolerances as scattered

        assert asked.case.test is not None  # read_tolerances raises without a test
        found = scattered(
            asked.case.muscle, asked.case.test, wanted, of or None, state, distribution=distribution, samples=samples,
            tolerance=tolerance, watch=watch,
        )  # fmt: skip
    if not (quiet or as_json):
        _show(found)
    if output is not None:
        _save(found, output, suffix, force)
        if not (quiet or as_json):
            say(f"saved to {output}")
    if as_json:
        show_json(_as_json(found, None if output is None else str(output)))
    return COMPLETE if found.stable else INCOMPLETE


def _save(found: Tolerances, output: Path, suffix: str, force: bool) -> None:
    from mckibben import disk

    if suffix in (".nc", ".csv"):
        from mckibben.files import store

        store.save(found, output, force)
        return
    disk.write(output, picture(found, suffix), force)


def _show(found: Tolerances) -> None:
    """Print the spread of each result, the part of each number in it, and the notes."""
    spread, parts = found.spread, found.table
    title = str(found.data.attrs["title"])
    cells = [[name, *row] for name, row in zip(spread.index, spread.values.tolist(), strict=True)]
    say(table(["result", *spread.columns], cells, title=title, right=range(1, 7)), whole=True)
    assumed = dict(zip(found.numbers, found.data["number_assumed"].values.tolist(), strict=True))
    kinds = {"share": "derivatives", "first": "alone", "total": "in all"}
    heads = [f"{name}\n{said}" for name in found.results for said in kinds.values()]
    rows = [
        [name, row[0], row[1], *("-" if share != share else f"{share:.1f} %" for share in row[2:]),
         "ASSUMED" if assumed[name] else ""]
        for name, row in zip(parts.index, parts.values.tolist(), strict=True)
    ]  # fmt: skip
    columns = ["number", "value", "tolerance", *heads, ""]
    last = len(columns) - 1
    said = "Part of each number in the variance: by derivatives; sampled, by itself and in all"
    say(table(columns, rows, title=said, right=range(3, last), whole=(0, 1, 2, last)), whole=True)
    for note in found.notes:
        say(f"- {note}")


def _as_json(found: Tolerances, file: str | None) -> dict[str, Any]:
    """All but the samples, in SI units, None for NaN."""
    import tomllib

    data = found.data
    about, units = data.attrs, data["result_unit"].values.tolist()
    numbers = {}
    for k, name in enumerate(found.numbers):
        known = {
            kind: data[f"number_{kind}"].values[k].item()
            for kind in ("value", "tolerance", "deviation", "distribution", "unit", "assumed")
        }
        parts = {kind: dict(zip(found.results, plain_numbers(data[kind].values[k]), strict=True))
                 for kind in ("effect", "share", "first", "total")}  # fmt: skip
        numbers[name] = known | parts
    columns = [plain_numbers(data["result_value"].values), plain_numbers(found.linear), plain_numbers(found.deviation),
               *map(plain_numbers, found.quantiles)]  # fmt: skip
    heads = ("value", "linear_deviation", "sampled_deviation", "quantile_5", "quantile_50", "quantile_95")
    results = {
        name: {"unit": unit, **dict(zip(heads, row, strict=True))}
        for name, unit, row in zip(found.results, units, zip(*columns, strict=True), strict=True)
    }
    return {
        "stable": found.stable, "file": file, "muscle": tomllib.loads(about["muscle"]),
        "test": tomllib.loads(about["test"]), "state": int(about["state"]), "verdict": str(about["verdict"]),
        "results": results, "numbers": numbers, "samples": int(data.sizes["sample"]), "tried": int(about["tried"]),
        "lost": int(about["lost"]), "notes": list(found.notes), "mckibben_version": about["mckibben_version"],
    }  # fmt: skip
