"""`mckibben effects`: which effects matter for a muscle."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import COMPLETE, command, examples, say, show_json, table
from mckibben.app.options import AsJson, Force, Overrides, Quiet
from mckibben.app.outputs import picture

if TYPE_CHECKING:
    from mckibben.results.effects import Effects

__all__ = ["EPILOG", "effects"]

EPILOG = examples(
    'mckibben effects case.toml --length "115 mm" --pressure "1 bar"',
    'mckibben effects case.toml --contraction "10 %" --pressure "3 bar" -o effects.png',
)
OUTPUTS = {".csv": "table", ".png": "bar chart", ".pdf": "the same for print", ".svg": "the same for the web"}


@command
def effects(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle")],
    pressure: Annotated[str, typer.Option(metavar="PRESSURE", help='gauge pressure, such as "1 bar"')],
    length: Annotated[str | None, typer.Option(metavar="LENGTH", help='such as "115 mm"')] = None,
    contraction: Annotated[str | None, typer.Option(metavar="CONTRACTION", help="in place of the length")] = None,
    overrides: Overrides = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="a table (.csv) or a chart (.png, .pdf, .svg)"),
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Show how much each effect that can be switched on changes a muscle at one length and pressure.

    Every effect is computed, with it and without. An effect that asks for a number that the case does not have says so.
    """
    from mckibben import disk
    from mckibben.files import store
    from mckibben.files.case import read_case

    muscle = read_case(case, overrides or (), test_required=False).muscle
    suffix = ""
    if output is not None:
        suffix = store.suffix_of(output, OUTPUTS)
        disk.check_target(output, force)
    from mckibben.app.solving import solving

    with solving("effects", hidden=quiet or as_json):
        from mckibben.experiments.effects import effects as experiment

        found = experiment(muscle, length=length, contraction=contraction, pressure=pressure)
    if not (quiet or as_json):
        _show(found)
    if output is not None:
        disk.write(output, _picture(found, suffix), force)
        if not (quiet or as_json):
            say(f"saved to {output}")
    if as_json:
        show_json(_as_json(found, None if output is None else str(output)))
    return COMPLETE


def _picture(found: Effects, suffix: str) -> bytes:
    if suffix == ".csv":
        text: str = found.table.to_csv(index_label="effect")
        return text.encode("utf-8")
    return picture(found, suffix)


def _show(found: Effects) -> None:
    """Print the table, the largest effect first, and what could not be told."""
    frame = found.table
    shown = {"force": "force", "middle_radius": "radius at\nmid-length", "peak_fibre_tension": "fibre\ntension"}
    known = frame[frame["reason"] == ""]
    cells = [
        [name, *(_share(row[f"{key} [%]"]) for key in shown), f"{row['time']:.1f}"] for name, row in known.iterrows()
    ]
    title = str(found.data.attrs["title"])
    heads = ["effect", *shown.values(), "time"]
    say(table(heads, cells, title=title[0].upper() + title[1:], right=range(1, 5)), whole=True)
    assumed = dict(zip(found.data["effect"].values, found.data["assumed"].values, strict=True))
    for name, row in known.iterrows():
        say(f"{name}: {row['switch']}{' (ASSUMED, put in your own number)' if assumed[name] else ''}")
    for name, row in frame.iterrows():
        if row["reason"]:
            say(f"{name}: {row['reason']}")
    say("changes by the effect, with it against without; time: of a state, or its path, over that of a state without")


def _share(value: float) -> str:
    return f"{value:+.2f} %" if value == value else "-"


def _as_json(found: Effects, file: str | None) -> dict[str, Any]:
    """All numbers in SI units, None for NaN."""
    from mckibben.results.effects import QUANTITIES

    data, rows = found.data, []
    for k, name in enumerate(data["effect"].values.tolist()):
        one = data.isel(effect=k)
        values = {key: [None if v != v else v for v in one[key].values.tolist()] for key in QUANTITIES}
        ratio = float(one["time"])
        rows.append({
            "effect": name, "switch": str(one["switch"].values), "assumed": bool(one["assumed"].values),
            "reason": str(one["reason"].values), "time": None if ratio != ratio else ratio, **values,
        })  # fmt: skip
    units = {key: unit for key, (unit, _) in QUANTITIES.items()}
    return {"length": found.length, "pressure": found.pressure, "file": file, "units": units, "effects": rows}
