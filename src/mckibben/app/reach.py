"""`mckibben limits`, `working-range` and `force-map`: what a muscle can do, without a test."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import asdict

from mckibben.app.console import COMPLETE, INCOMPLETE, command, examples, say, show_json, table
from mckibben.app.options import AsJson, Force, Quiet, Tolerance
from mckibben.app.outputs import PIXELS

if TYPE_CHECKING:
    from xarray import Dataset

    from mckibben.spec import Muscle

__all__ = ["FORCE_MAP", "LIMITS", "WORKING_RANGE", "force_map", "limits", "working_range"]

LIMITS = examples(
    'mckibben limits case.toml --pressure "1 bar"',
    'mckibben limits case.toml --pressure "1 bar" --load "50 N"',
    'mckibben limits case.toml --pressure "1 bar" --json',
)
WORKING_RANGE = examples(
    'mckibben working-range case.toml --pressure "0 to 3 bar" --points 4 -o range.png',
    'mckibben working-range case.toml --pressure "1 bar" --pressure "2 bar" -o range.csv',
)
FORCE_MAP = examples(
    'mckibben force-map case.toml --length "90 mm to 115 mm" --pressure "0.2 to 1 bar" --points 6 -o map.png',
    'mckibben force-map case.toml --length "90 mm to 115 mm" --pressure "0.2 to 1 bar" -o map.csv',
)
OUTPUTS = {".csv": "table", ".png": "picture", ".pdf": "the same for print", ".svg": "the same for the web"}

Case = Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle; a test in it is not used")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help='change a value of the muscle, such as braid.angle="36 deg"'),
]
Output = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="FILE", help="a table (.csv) or a picture (.png, .pdf, .svg)")
]


def _muscle(case: Path, overrides: list[str] | None) -> Muscle:
    from mckibben.files.case import read_case

    return read_case(case, overrides or (), test_required=False).muscle


@command
def limits(
    case: Case,
    pressure: Annotated[str, typer.Option(metavar="PRESSURE", help='gauge pressure, such as "1 bar"')],
    length: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="where it would burst; at rest if not given")
    ] = None,
    contraction: Annotated[
        str | None, typer.Option(metavar="CONTRACTION", help='in place of the length, such as "10 %"')
    ] = None,
    load: Annotated[str | None, typer.Option(metavar="FORCE", help='in place of either, such as "50 N"')] = None,
    overrides: Overrides = None,
    as_json: AsJson = False,
) -> int:
    """Show the shortest and longest length of a muscle at a pressure, how hard it can push, and where it would burst.

    A pressure at which it would burst is an estimate: see what it takes for granted with --json.
    The exit code is 3 if there is no stable state even at the length as made.
    """
    muscle = _muscle(case, overrides)
    from mckibben.app.solving import solving

    with solving("limits", hidden=as_json):
        from mckibben.experiments import limits as experiment

        at: dict[str, Any] = {"length": length, "contraction": contraction, "force": load}
        if all(value is None for value in at.values()):
            at["length"] = float(muscle.rest_length)
        found = experiment.limits(muscle, pressure=pressure, **at)
    burst = found.burst
    values = {name: getattr(found, name) for name in ("pressure", *UNITS)}
    if as_json:
        told = {} if burst is None else {"burst": _without_nan(asdict(burst))}
        show_json(_without_nan(values) | told)
    else:
        rows = [(name, _text(value, UNITS[name][0]), UNITS[name][1]) for name, value in values.items() if name in UNITS]
        if burst is not None:
            rows += [
                ("fibre_breaks", _text(burst.fibre, "Pa"), burst.fibre_reason or f"{BREAKS}, at {burst.held}"),
                ("wall_bulges", _text(burst.wall, "Pa"), burst.wall_reason or f"{BULGES}, at {burst.held}"),
            ]
        say(table(("limit", "value", "meaning"), rows, title=f"Limits at {_text(found.pressure, 'Pa')}", whole=(0,)))
    return COMPLETE if found.shortest == found.shortest else INCOMPLETE


def _without_nan(values: dict[str, Any]) -> dict[str, Any]:
    return {name: None if value != value else value for name, value in values.items()}


UNITS = {
    "shortest": ("m", "shortest length of a stable, admissible state"),
    "shortest_force": ("N", "force there; negative where the muscle pushes"),
    "shortest_cause": ("", "why no shorter one is admissible"),
    "stable_down_to": ("m", "shortest length of a stable state, wherever its wall lies"),
    "stable_force": ("N", "force there"),
    "longest": ("m", "full extension: no equilibrium at or beyond it"),
    "force_extremum": ("N", "least force, that is the largest push, on the way to the shortest length"),
    "force_extremum_length": ("m", "length there"),
}
"""What `limits` finds: unit and meaning."""
BREAKS = "estimated pressure from which the tension of a fibre exceeds its breaking force"
BULGES = "estimated pressure from which the wall bulges through between fibres by half a circle, and may burst"


def _text(value: Any, unit: str) -> str:
    from mckibben.units import show

    return value if isinstance(value, str) else show(value, unit) if value == value else "none"


@command
def working_range(
    case: Case,
    pressure: Annotated[
        list[str], typer.Option(metavar="PRESSURES", help='"0 to 3 bar", or one pressure; may be repeated')
    ],
    points: Annotated[int | None, typer.Option(help="number of pressures along a ramp; 21 by default")] = None,
    overrides: Overrides = None,
    output: Output = None,
    force: Force = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Show the lengths a muscle can be held at, over pressure."""
    muscle = _muscle(case, overrides)
    suffix = _check(output, force)
    from mckibben.app.solving import solving

    with solving("working range", hidden=quiet or as_json):
        from mckibben.experiments.limits import working_range as experiment
        from mckibben.spec import Step

        given: Any = pressure[0] if len(pressure) == 1 else pressure
        step = Step(pressure=given, force=0.0, points=points)
        assert step.pressure is not None  # it was given
        levels = step.pressure.sample(step.points)
        data = experiment(muscle, pressures=[f"{float(level)!r} Pa" for level in levels])
    return _tell(data, "shortest", output, suffix, force, as_json, quiet)


@command
def force_map(
    case: Case,
    pressure: Annotated[str, typer.Option(metavar="PRESSURES", help='such as "0 to 3 bar"')],
    length: Annotated[str | None, typer.Option(metavar="LENGTHS", help='such as "90 mm to 115 mm"')] = None,
    contraction: Annotated[
        str | None, typer.Option(metavar="CONTRACTIONS", help='in place of the lengths, such as "0 to 25 %"')
    ] = None,
    points: Annotated[int | None, typer.Option(help="number of lengths and of pressures; 21 by default")] = None,
    tolerance: Tolerance = 1e-6,
    overrides: Overrides = None,
    output: Output = None,
    force: Force = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Show the force of a muscle over length and pressure.

    The exit code is 3 if part of the map has no admissible equilibrium or was not reached.
    """
    muscle = _muscle(case, overrides)
    suffix = _check(output, force)
    from mckibben.app.solving import solving

    with solving("force map", hidden=quiet or as_json):
        from mckibben.experiments.force_map import force_map as experiment

        data = experiment(
            muscle, length=length, contraction=contraction, pressure=pressure, points=points, tolerance=tolerance
        )
    return _tell(data, "force", output, suffix, force, as_json, quiet)


def _check(output: Path | None, force: bool) -> str:
    """The ending of the output's name, before anything takes time."""
    from mckibben import disk
    from mckibben.files import store

    if output is None:
        return ""
    suffix = store.suffix_of(output, OUTPUTS)
    disk.check_target(output, force)
    return suffix


def _tell(data: Dataset, of: str, output: Path | None, suffix: str, force: bool, as_json: bool, quiet: bool) -> int:
    """Print and save what was found; the exit code."""
    import numpy as np

    from mckibben import disk
    from mckibben.files.table import map_csv, map_rows

    complete = bool(np.isfinite(data[of].values).all())
    if not (quiet or as_json):
        _show(data)
    if output is not None:
        if suffix == ".csv":
            content = map_csv(data).encode("utf-8")
        else:
            from mckibben.view import style
            from mckibben.view.plot import plot

            content = style.picture(plot(data), suffix[1:], PIXELS)
        disk.write(output, content, force)
        if not (quiet or as_json):
            say(f"saved to {output}")
    if as_json:
        units = {str(name): str(item.attrs.get("units", "")) for name, item in data.variables.items()}
        file = None if output is None else str(output)
        rows = list(map_rows(data, units=False))
        show_json({"complete": complete, "file": file, "units": {k: u for k, u in units.items() if u}, "rows": rows})
    return COMPLETE if complete else INCOMPLETE


def _show(data: Dataset) -> None:
    """Print the points of a map in mm, bar and so on."""
    from mckibben.files.table import map_rows
    from mckibben.units import DISPLAY, from_si

    units = {str(name): str(item.attrs.get("units", "")) for name, item in data.variables.items()}
    shown = {name: "" if unit == "1" else DISPLAY.get(unit, unit) for name, unit in units.items()}

    def cell(name: str, value: Any) -> str:
        if value is None or isinstance(value, str):
            return value or "-"
        return f"{from_si(value, shown.get(name) or '1'):.5g}"

    rows = map_rows(data, units=False)
    names = [name for name in rows[0] if not name.endswith("_cause")]
    heads = [name.replace("_", "\n") + (f"\n[{shown[name]}]" if shown.get(name) else "") for name in names]
    cells = [[cell(name, row[name]) for name in names] for row in rows]
    say(table(heads, cells, right=range(len(names)), whole=(), most=40, narrow=True), whole=True)
