"""`mckibben sweep`: one test on many muscles, from a sweep file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import COMPLETE, INCOMPLETE, INTERRUPTED, command, complain, examples, say, show_json, table
from mckibben.app.options import Quiet, Tolerance

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

__all__ = ["EPILOG", "counts", "one_by_one", "sweep"]

EPILOG = examples(
    "mckibben sweep sweep.toml -o out.zarr",
    "mckibben sweep sweep.toml -o out.zarr --workers 4",
    "mckibben sweep sweep.toml -o out.zarr --scheduler tcp://head:8786",
    "mckibben info out.zarr",
)


@command
def sweep(
    file: Annotated[Path, typer.Argument(metavar="SWEEP.toml", help=r"a case file with a \[sweep] table")],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='change a value of the base, such as braid.angle="36 deg"'),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="STORE.zarr", help=r"where the results go \[default: SWEEP.zarr]"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="delete another sweep that is there")] = False,
    workers: Annotated[
        int | None,
        typer.Option(min=0, help=r"processes on this machine, 0 for this one alone \[default: one per core]"),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="a Dask scheduler that is running, such as tcp://head:8786")
    ] = None,
    tolerance: Tolerance = 1e-6,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a summary as one JSON object, and nothing else")
    ] = False,
    quiet: Quiet = False,
) -> int:
    """Run the test of a sweep file on all its designs, into a Zarr store.

    Results are kept as they come. A sweep that was interrupted or killed goes on from there when the same command is
    given again, to the same numbers. A design that cannot be is noted and spoils no other.

    The exit code is 0 if every design is complete, 2 for wrong input, 3 if some are not, and 4 if something outside,
    such as a full disk, ended the sweep.
    """
    from mckibben.sweeps.sweepfile import read_sweep

    asked = read_sweep(file, overrides or ())
    target = file.with_suffix(".zarr") if output is None else output
    from mckibben.app.solving import solving

    said = [0, 0]
    try:
        with solving("sweep", hidden=quiet or as_json, unit="designs") as watch:
            from mckibben.sweeps.sweep import sweep as run

            def told(done: int, total: int) -> None:
                said[:] = done, total
                watch(done, total)

            assert asked.case.test is not None  # read_sweep raises without a test
            data = run(
                asked.case.muscle, asked.case.test, asked.over, designs=asked.designs, tolerance=tolerance, to=target,
                force=force, workers=workers, scheduler=scheduler, chunk=asked.chunk, watch=told,
            )  # fmt: skip
    except KeyboardInterrupt:
        kept = "nothing was begun" if not said[1] else f"about {said[0]} of {said[1]} designs are in {target}"
        complain(f"interrupted: {kept}; the same command goes on from there")
        return INTERRUPTED
    found = counts(data)
    if not quiet and not sys.stderr.isatty() and (words := one_by_one(data)):
        complain(words, style=None)
    if as_json:
        show_json(_summary(data, found, str(target)))
    elif not quiet:
        _show(data, found, str(target))
    return COMPLETE if set(found) == {"complete"} else INCOMPLETE


def counts(data: Dataset) -> dict[str, int]:
    """Number of designs by status, the most frequent first; a status that no design has is left out."""
    found = {word.replace("_", " "): int(has.sum()) for word, has in _flagged(data["status"]).items()}
    return {word: count for word, count in sorted(found.items(), key=lambda item: -item[1]) if count}


def one_by_one(data: Dataset) -> str:
    """How many designs were solved one by one, which takes far longer than in a batch, and why; empty for none."""
    alone = _flagged(data["method"])["single"].ravel()
    if not alone.any():
        return ""
    lost = ~_flagged(data["status"])["complete"].ravel()
    shaky = ~_flagged(data["verdict"])["stable"].reshape(alone.size, -1).all(axis=1) & ~lost
    reasons = {
        "states that are not there": lost,
        "states that are not stable": shaky,
        "a test, a muscle or a step that batches do not take or follow": ~lost & ~shaky,
    }
    told = [f"{(alone & part).sum()} for {why}" for why, part in reasons.items() if (alone & part).any()]
    return f"{alone.sum()} of {alone.size} designs were solved one by one: {', '.join(told)}"


def _flagged(variable: DataArray) -> dict[str, Any]:
    """By each word of a variable of flags, where it holds."""
    words, flags = variable.attrs["flag_meanings"].split(), variable.attrs["flag_values"]
    return {word: variable.values == flag for word, flag in zip(words, flags, strict=True)}


def _summary(data: Dataset, found: dict[str, int], target: str) -> dict[str, Any]:
    sizes = {str(name): int(size) for name, size in data.sizes.items()}
    return {"file": target, "complete": set(found) == {"complete"}, "dimensions": sizes, "designs": found}


def _show(data: Dataset, found: dict[str, int], target: str) -> None:
    which, reason = _flagged(data["status"]), data["reason"].values
    rows = [(word, str(count), str(reason[which[word.replace(" ", "_")]][0])) for word, count in found.items()]
    say(table(("status", "designs", "the first because"), rows, right=(1,), title=data.attrs["title"]))
    say(f"saved to {target}: open it with mckibben.load({target!r})")
