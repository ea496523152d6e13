"""A map for people and for programs: its range and errors as tables and JSON, and how commands make one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mckibben.app.console import say, table

if TYPE_CHECKING:
    from mckibben.potential.chart import Chart

__all__ = ["as_json", "described", "made", "show"]


def made(case: Path, overrides: list[str] | None, length: Any, pressure: Any, tolerance: float, hidden: bool) -> Chart:
    """The map of the muscle in a case file, with a progress bar."""
    from mckibben.files.case import read_case
    from mckibben.spec.errors import SpecError

    for option, given, example in (("--length", length, "60 mm to 115 mm"), ("--pressure", pressure, "0 to 3 bar")):
        if given is None:
            raise SpecError(option, allowed="is missing", advice=f'give a range, such as "{example}"')
    muscle = read_case(case, overrides or (), test_required=False).muscle
    from mckibben.app.solving import solving

    with solving("map", hidden=hidden, unit="pressures") as watch:
        from mckibben.charts.chart import chart

        return chart(muscle, length=length, pressure=pressure, tolerance=tolerance, watch=watch)


def show(chart: Chart) -> None:
    """Print the range, the errors and the notes."""
    rows = [(str(name), *map(str, row)) for name, row in zip(chart.summary.index, chart.summary.values, strict=True)]
    head = ("", "largest", "largest error", "relative")
    say(table(head, rows, title=f"Map of {chart.range_said}", right=(1, 2, 3), whole=(0, 1, 2, 3)))
    say(f"errors at {chart.data.sizes['check']} states that the map was not made of")
    for note in chart.notes:
        say(f"- {note}")


def as_json(chart: Chart) -> dict[str, Any]:
    """Range, errors and notes for JSON, in SI units."""
    about = chart.data.attrs
    low, high = chart.lengths(chart.pressures)
    stiff = () if math.isnan(chart.stiffness_error) else ("stiffness",)
    errors = {name: float(about[f"{name}_error"]) for name in ("force", "volume", "radius", *stiff)}
    return {
        "converged": chart.converged, "pressure": list(chart.pressures),
        "length": [float(low.min()), float(high.max())], "errors": errors,
        "largest": {name: float(about[f"largest_{name}"]) for name in errors}, "tolerance": chart.tolerance,
        "notes": list(chart.notes), "mckibben_version": str(about["mckibben_version"]),
    }  # fmt: skip


def described(chart: Chart) -> list[tuple[str, str]]:
    """What a saved map is, in rows of a name and a text."""
    rows = [
        ("holds", f"a map of {chart.range_said}"),
        ("made", f"with mckibben {chart.data.attrs['mckibben_version']}, of {chart.data.attrs['states']} states"),
    ]
    for name, row in zip(chart.summary.index, chart.summary.values.tolist(), strict=True):
        rows.append((str(name), f"to {row[1]} ({row[2]} of the largest, {row[0]})"))
    return rows + [("note", note) for note in chart.notes]
