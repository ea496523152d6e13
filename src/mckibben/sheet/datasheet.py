"""`datasheet()`: one or two pages on a muscle, as PDF or HTML."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from importlib.util import find_spec
from itertools import pairwise
from os import PathLike
from pathlib import Path as FilePath
from typing import Any

from mckibben import disk
from mckibben.sheet.facts import facts
from mckibben.sheet.html import html
from mckibben.sheet.levels import rated
from mckibben.sheet.pdf import pdf
from mckibben.sheet.pictures import curves, drawing, svg
from mckibben.sheet.words import page
from mckibben.spec import Muscle, Path, SpecError, Step
from mckibben.units import UnitError, to_si

__all__ = ["FORMATS", "check_sheet", "datasheet"]

FORMATS = {".pdf": "pages for print", ".html": "one page that needs nothing beside it"}
LEVELS = 4
"""Pressures of a sheet where only the largest is given."""


def datasheet(
    muscle: Muscle,
    path: str | PathLike[str],
    *,
    pressure: Any = None,
    fibre_density: Any = None,
    chamber_density: Any = None,
    date: str | None = None,
    force: bool = False,
    watch: Callable[[int, int], None] | None = None,
) -> FilePath:
    """Write a datasheet of a muscle, one or two pages for a colleague: drawing, curves, key numbers, limits.

    The curves end where the muscle is free. They begin at the length as made; of a muscle that hardly contracts by
    itself, which pulls where it is stretched, at 60 % of the way to full extension. What cannot be computed is told
    with its reason. The numbers are those of `run` at a tolerance of 1e-4.

    Args:
        muscle: the specification.
        path: the file: `.pdf` (which takes typst, extra "report") or `.html`, which stands alone.
        pressure: the largest gauge pressure [Pa], of which a quarter, a half and three quarters are shown too; or a
            list of rising ones. By default, of a preset, what it is meant for.
        fibre_density: of the fibres' material [kg/m^3], such as "1380 kg/m^3"; without it the mass is not known.
        chamber_density: of the chamber's, likewise.
        date: of the sheet, in words; today by default. Equal sheets of one date are equal files.
        force: replace a file that is there already.
        watch: called with (parts done, parts in all).

    Returns:
        The path of the file.

    Raises:
        SpecError: for another ending, a pressure that is not above 0 or missing, a file that exists (without `force`),
            and where typst is not installed.

    >>> mk.datasheet(mk.presets.paper(), "paper.html", pressure="1 bar", fibre_density="1380 kg/m^3").name
    'paper.html'
    """
    suffix = check_sheet(path, force)
    levels = _pressures(muscle, pressure)
    given = _density("fibre_density", fibre_density), _density("chamber_density", chamber_density)
    found = facts(muscle, levels, given, watch or (lambda done, total: None))
    today = datetime.date.today().isoformat() if date is None else date
    made = page(found, svg(drawing(found)), svg(curves(found)), today)
    return disk.write(path, pdf(made) if suffix == ".pdf" else html(made), force)


def check_sheet(path: str | PathLike[str], force: bool = False) -> str:
    """The ending of the file's name; SpecError if `datasheet` would fail for its name, its place, or typst missing."""
    suffix = FilePath(path).suffix.lower()
    if suffix not in FORMATS:
        known = " or ".join(f"{ending} ({meaning})" for ending, meaning in FORMATS.items())
        raise SpecError(str(path), allowed=f"must end in {known}")
    disk.check_target(path, force)
    if suffix == ".pdf" and find_spec("typst") is None:
        said = "a datasheet as PDF takes typst to set it"
        raise SpecError(str(path), allowed=said, advice='pip install "mckibben[report]", or write .html')
    return suffix


def _pressures(muscle: Muscle, given: Any) -> tuple[float, ...]:
    """Rising gauge pressures [Pa]."""
    if given is None:
        given = rated(muscle)
        if given is None:
            said = "is missing: no pressure is known that this muscle is meant for"
            raise SpecError("datasheet.pressure", allowed=said, advice='give the largest one, such as "3 bar"')
    path = Step(pressure=given, force=0.0).pressure
    assert isinstance(path, Path)
    if path.needs_present or (path.varies and path.mode != "list"):
        raise SpecError("datasheet.pressure", given, "must be one value or a list", 'such as "3 bar"')
    values = [float(value) for value in path.waypoints]
    if values[0] <= 0.0 or any(b <= a for a, b in pairwise(values)):
        raise SpecError("datasheet.pressure", given, "must be above 0, and a list must rise", 'such as "3 bar"')
    if len(values) > 2 * LEVELS:
        raise SpecError("datasheet.pressure", given, f"must be at most {2 * LEVELS} pressures")
    return tuple(values) if len(values) > 1 else tuple((k + 1) / LEVELS * values[0] for k in range(LEVELS))


def _density(name: str, given: Any) -> float | None:
    if given is None:
        return None
    try:
        value = float(to_si(given, "kg/m^3"))
    except UnitError as error:
        raise SpecError(f"datasheet.{name}", given, str(error), 'write it like "1380 kg/m^3"') from error
    if not value > 0.0:
        raise SpecError(f"datasheet.{name}", given, "must be above 0")
    return value
