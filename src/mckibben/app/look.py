"""`mckibben check`, `presets` and `info`: what a case, a preset, a file or the installation holds, without solving."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mckibben.app.console import command, examples, say, show_json, table

if TYPE_CHECKING:
    from mckibben.sweeps.sweepfile import SweepCase

__all__ = ["CHECK", "INFO", "PRESETS", "check", "info", "presets"]

AsJson = Annotated[bool, typer.Option("--json", help="print one JSON object and nothing else, errors included")]
CHECK = examples("mckibben check case.toml", 'mckibben check case.toml --set braid.angle="36 deg"')
PRESETS = examples("mckibben presets", "mckibben presets paper", "mckibben presets paper --toml > case.toml")
INFO = examples("mckibben info", "mckibben info out.nc", "mckibben info out.zarr")


@command
def check(
    case: Annotated[Path, typer.Argument(metavar="CASE.toml", help="the case file: a muscle and, maybe, a test")],
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help='change a value of the case, such as braid.angle="36 deg"'),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check a case file and show the muscle and the test as understood, without solving.

    Every field is shown with its unit and, where known, its source; what is assumed is marked. Numbers that follow from
    them, such as the longest possible length, come after.
    """
    from mckibben.sweeps.sweepfile import read_sweep

    asked = read_sweep(case, overrides or (), required=False)
    found = asked.case
    from mckibben.app import fields
    from mckibben.experiments import foresee
    from mckibben.spec.rows import muscle_rows, test_rows

    if as_json:
        show_json(_as_json(asked))
        return
    name = f' "{found.muscle.name}"' if found.muscle.name else ""
    columns = ("field", "value", "meaning", "source")
    rows = list(muscle_rows(found.muscle))
    marks, sources = fields.numbered(row[3] for row in rows)
    marked = [(*_short(*row[:3]), mark) for row, mark in zip(rows, marks, strict=True)]
    say(table(columns, marked, title=f"Muscle{name}", whole=(0, 1, 3)))
    for source in sources:
        say(source)
    say()
    if found.test is not None:
        say(table(columns[:3], list(test_rows(found.test)), title="Test"))
    if asked.over is not None or asked.designs is not None:
        say(table(("field", "values"), _swept(asked), title="Sweep"))
    say(table(("derived", *columns[1:3]), list(foresee.derived(found.muscle)), title="What follows"))
    for note in foresee.beyond(found.muscle, found.test):
        say(note)
    if found.test is None:
        say('There is no test: add a [test] table, such as kind = "isometric".')


def _short(field: str, value: str, meaning: str) -> tuple[str, str, str]:
    """A row with a short value: from what an angle is measured goes to its meaning."""
    number, measured, more = value.partition(" from the ")
    return field, number, f"{meaning}: {number}{measured}{more}" if measured else meaning


def _narrow(value: str) -> str:
    """A value for a column: what is added in brackets goes on a line of its own."""
    return value.replace(" (", "\n(")


def _as_json(asked: SweepCase) -> dict[str, Any]:
    """What `check` understands, for JSON: the specification in SI units, and texts of what follows."""
    from mckibben.experiments import foresee
    from mckibben.spec.text import to_mapping

    case = asked.case
    swept = None if asked.over is None and asked.designs is None else dict(_swept(asked))
    return {
        "valid": True,
        **to_mapping(case, allow_custom=True),
        "assumed": list(case.muscle.assumed),
        "braid": foresee.turns(case.muscle),
        "derived": {name: value for name, value, _ in foresee.derived(case.muscle)},
        "sweep": swept,
        "notes": list(foresee.beyond(case.muscle, case.test)),
    }


def _swept(asked: SweepCase) -> list[tuple[str, str]]:
    from mckibben.sweeps.plan import plan

    assert asked.case.test is not None  # read_sweep raises without a test
    wanted = plan(asked.case.muscle, asked.case.test, asked.over, asked.designs, chunk=asked.chunk)
    rows = [(varied.field, _range(varied.coordinate, varied.about)) for varied in wanted.varied]
    return [*rows, ("designs in all", str(len(wanted)))]


@command
def presets(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="one preset; all are listed without it")] = None,
    toml: Annotated[bool, typer.Option("--toml", help="print a case file with the preset, ready to run")] = False,
    as_json: AsJson = False,
) -> None:
    """List the named muscles, or show one: each value with its source or marked as assumed."""
    from mckibben.spec import presets as known
    from mckibben.spec.errors import SpecError

    if name is None:
        if toml:
            raise SpecError("--toml", allowed="needs the name of a preset", advice="one of " + ", ".join(known.names()))
        lines = [(key, known.about(key)) for key in known.names()]
        if as_json:
            show_json({"presets": [{"name": key, "about": about} for key, about in lines]})
        else:
            say(table(("preset", "what it is"), lines))
        return
    from mckibben.app import fields
    from mckibben.spec.rows import muscle_rows

    muscle = known.get(name)
    if toml:
        typer.echo(fields.case_text(name), nl=False)
        return
    if as_json:
        from mckibben.spec.text import to_mapping

        show_json({"name": name, "muscle": to_mapping(muscle), "sources": known.sources(name)})
        return
    rows = [(field, _narrow(value), source) for field, value, _, source in muscle_rows(muscle)]
    say(table(("field", "value", "source"), rows, title=f'Muscle "{name}"', whole=(0, 1)))


@command
def info(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="a saved result or fit (.nc), or a sweep (.zarr)")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show the versions and the machine, or with a file what it holds."""
    look = _sweep if file is not None and file.suffix.lower() == ".zarr" else _content
    rows = _installation() if file is None else look(file)
    if as_json:
        found: dict[str, Any] = {}
        for name, value in rows:
            found.setdefault(name, []).append(value)
        show_json({name: values[0] if len(values) == 1 else values for name, values in found.items()})
    else:
        say(table(("", ""), rows))


def _installation() -> list[tuple[str, str]]:
    import os
    import platform
    import sys
    from importlib.metadata import entry_points, version

    from mckibben.compiled import folder

    place = folder.ready()
    packages = ("mckibben", "jax", "jaxlib", "numpy", "scipy", "xarray", "h5netcdf", "h5py", "matplotlib")
    rows = [(name, version(name)) for name in packages]
    rows += [("python", f"{platform.python_version()} ({sys.executable})"), ("platform", platform.platform())]
    found = ", ".join(sorted({"cpu", *(plugin.name for plugin in entry_points(group="jax_plugins"))}))  # not by JAX:
    rows.append(("JAX platforms", os.environ.get("JAX_PLATFORMS") or found))  # importing it takes a second
    if place is None:
        why = "MCKIBBEN_CACHE is off" if folder.off() else f"{folder.folder()} cannot be written, or others can"
        return [*rows, ("compiled functions", f"not kept: {why}")]
    count, size = folder.size(place)
    return [*rows, ("compiled functions", f"{count} ({size / 2**20:.1f} MB) in {place}")]


def _content(file: Path) -> list[tuple[str, str]]:
    from collections import Counter

    from mckibben.files import store
    from mckibben.spec.rows import test_rows
    from mckibben.units import from_si

    found = store.load(file)
    from mckibben.results.result import Result

    if not isinstance(found, Result):
        from mckibben.results.fit import Fitted

        if isinstance(found, Fitted):
            from mckibben.app import fitted

            return [("file", str(file)), *fitted.described(found)]
        from mckibben.potential.chart import Chart

        if isinstance(found, Chart):
            from mckibben.app import charted

            return [("file", str(file)), *charted.described(found)]
        from mckibben.results.motion import Motion

        if isinstance(found, Motion):
            from mckibben.app import moved

            return [("file", str(file)), *moved.described(found)]
        from mckibben.results.design import Designed

        if isinstance(found, Designed):
            from mckibben.app import designed

            return [("file", str(file)), *designed.described(found)]
        rows = [("file", str(file)), ("holds", repr(found).strip("<>"))]
        rows += [("made", f"with mckibben {found.data.attrs['mckibben_version']}")]
        rows += [(str(name), str(row["value"])) for name, row in found.table.iterrows()]
        return rows + [("note", note) for note in found.notes]
    result = found
    about = result.attributes
    verdicts = Counter(result.verdict)
    rows = [
        ("file", str(file)),
        ("holds", f"{about['title']}, {len(result)} states"),
        ("verdicts", ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())),
        ("made", f"{about['date']} with {about['versions']}"),
        ("assumed", about["assumed"] or "nothing"),
    ]
    rows += [("warning", warning) for warning in about["warnings"].splitlines() if warning]
    rows += [(f"test {name}", value) for name, value, _ in test_rows(result.test)]
    for name, unit in (("length", "mm"), ("force", "N"), ("pressure", "bar"), ("volume", "mL")):
        values = from_si(result.column(name), unit)
        values = values[values == values]  # without NaN
        rows.append((name, f"{values.min():.5g} to {values.max():.5g} {unit}" if len(values) else "none reached"))
    return rows


def _sweep(file: Path) -> list[tuple[str, str]]:
    import numpy as np

    from mckibben.app.sweep import counts
    from mckibben.sweeps import store as sweeps
    from mckibben.units import from_si

    data = sweeps.load(file)
    about = data.attrs
    rows = [
        ("store", str(file)),
        ("holds", f"{about['title']}, {data.sizes['step']} states each"),
        ("designs", ", ".join(f"{count} {status}" for status, count in counts(data).items())),
        ("made", f"from {about['date']} with {about['versions']}"),
        ("tolerance", f"{about['tolerance']:g}"),
        ("assumed", about["assumed"] or "nothing"),
    ]
    for name, coordinate in data.coords.items():
        if name != "step":
            rows.append((str(name), _range(coordinate.values, coordinate.attrs)))
    for name, unit in (("length", "mm"), ("force", "N"), ("pressure", "bar"), ("peak_fibre_tension", "N")):
        values = data[name].values
        values = from_si(values[~np.isnan(values)], unit)
        rows.append((name, f"{values.min():.5g} to {values.max():.5g} {unit}" if len(values) else "none reached"))
    return rows


def _range(values: Any, about: Mapping[str, Any]) -> str:
    """The values of a swept field in words: their number and either the range or all of them."""
    from mckibben.units import DISPLAY, from_si

    unit, measured = str(about.get("units", "")), about.get("measured_from")
    if values.dtype.kind not in "if":
        words = list(dict.fromkeys(str(value) for value in values))
        return f"{len(values)}: " + ", ".join(words[:6]) + (", ..." if len(words) > 6 else "")
    shown = "" if unit == "1" else DISPLAY.get(unit, unit)
    numbers = from_si(values, shown) if shown else values
    said = f"{len(values)}: {numbers.min():.6g} to {numbers.max():.6g} {shown}".rstrip()
    if measured in ("parallels", "axis"):
        return f"{said} from the {measured}"
    return f"{said}, from what {measured} says" if measured else said
