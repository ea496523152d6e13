"""`export()`: a map of a muscle in the format that the file's name asks for."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben import disk
from mckibben.charts.chart import chart
from mckibben.exports.lookup import as_json, as_mat
from mckibben.files.store import suffix_of
from mckibben.potential.chart import Chart
from mckibben.potential.grid import LENGTHS, PRESSURES, table
from mckibben.spec import Muscle, SpecError

__all__ = ["FORMATS", "export"]

FORMATS = {
    ".h": "C99: the map itself", ".py": "Python with NumPy alone: the map itself", ".csv": "a table",
    ".mat": "tables for MATLAB and Simulink", ".json": "tables",
}  # fmt: skip
"""Endings and what they stand for."""
MOST = 2000
"""Lengths, or pressures, of a table at most."""

_WRITERS: dict[str, Callable[[Chart, int, int, str], bytes]] = {
    ".h": lambda made, lengths, pressures, name: made.to_c(name).encode("utf-8"),
    ".py": lambda made, lengths, pressures, name: made.to_numpy().encode("utf-8"),
    ".csv": lambda made, lengths, pressures, name: table(made, lengths, pressures).encode("utf-8"),
    ".mat": lambda made, lengths, pressures, name: as_mat(made, lengths, pressures),
    ".json": lambda made, lengths, pressures, name: as_json(made, lengths, pressures).encode("utf-8"),
}


def export(
    muscle: Muscle | Chart,
    path: str | PathLike[str],
    *,
    length: Any = None,
    pressure: Any = None,
    tolerance: float = 1e-4,
    points: tuple[int, int] = (LENGTHS, PRESSURES),
    name: str = "muscle",
    force: bool = False,
    watch: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a map of a muscle for another program, by the ending of the file's name.

    `.h` is one C99 file and `.py` a module that needs NumPy alone: both are the map itself, outside of its range too.
    `.mat` (MATLAB, with breakpoints as Simulink's look-up tables take them), `.json` and `.csv` are tables over even
    lengths and pressures in SI units, with what must be known of them.

    Args:
        muscle: a map that `chart` gave, or a muscle, of which one is made.
        path: the file.
        length: for a muscle: the lengths [m], as for `chart`.
        pressure: for a muscle: the gauge pressures [Pa].
        tolerance: for a muscle: largest error of the force over the largest force.
        points: lengths and pressures of a table.
        name: what the functions in C begin with.
        force: replace a file that is there already.
        watch: called with (pressures done, pressures in all) as a map is made.

    Returns:
        The path of the file.

    Raises:
        SpecError: for another ending, a file that exists (without `force`), and whatever `chart` refuses.

    >>> chart = mk.chart(mk.presets.paper(), length="60 mm to 115 mm", pressure="0 to 3 bar")
    >>> mk.export(chart, "muscle.h").name
    'muscle.h'
    """
    suffix = suffix_of(path, FORMATS)
    disk.check_target(path, force)
    if not (len(points) == 2 and all(isinstance(n, int) and 2 <= n <= MOST for n in points)):
        raise SpecError("export.points", points, f"must be two whole numbers from 2 to {MOST}", "lengths and pressures")
    if isinstance(muscle, Chart):
        if length is not None or pressure is not None:
            raise SpecError("export", allowed="a map has its range", advice="leave out length and pressure")
        made = muscle
    else:
        if length is None or pressure is None:
            missing = "length" if length is None else "pressure"
            example = '"60 mm to 115 mm"' if length is None else '"0 to 3 bar"'
            raise SpecError(f"export.{missing}", allowed="is missing", advice=f"give a range, such as {example}")
        made = chart(muscle, length=length, pressure=pressure, tolerance=tolerance, watch=watch)
    return disk.write(path, _WRITERS[suffix](made, *points, name), force)
