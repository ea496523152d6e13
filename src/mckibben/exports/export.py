"""`export()`: a map of a muscle in the format that the file's name asks for."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from mckibben import disk
from mckibben.charts.chart import chart
from mckibben.exports.compiler import compiler
from mckibben.exports.fmu import as_fmu
from mckibben.exports.fmudescription import MAIN
from mckibben.exports.lookup import as_json, as_mat, as_modelica
from mckibben.exports.mjcf import as_mjcf
from mckibben.exports.mjplugin import as_plugin
from mckibben.files.store import suffix_of
from mckibben.potential.c_source import check_name
from mckibben.potential.chart import Chart
from mckibben.potential.grid import LENGTHS, PRESSURES, table
from mckibben.spec import Muscle, SpecError
from mckibben.spec.declared import Declared
from mckibben.spec.fields import read_quantity

__all__ = ["FORMATS", "How", "export", "how"]

FORMATS = {
    ".h": "C99: the map itself", ".py": "Python with NumPy alone: the map itself", ".csv": "a table",
    ".mat": "tables for MATLAB and Simulink", ".json": "tables", ".txt": "tables for Modelica",
    ".fmu": "FMI 2.0 or 3.0, for co-simulation: the map itself",
    ".xml": "MuJoCo: an affine actuator", ".c": "MuJoCo: a plugin with the map itself",
}  # fmt: skip
"""Endings and what they stand for."""
MOST = 2000
"""Lengths, or pressures, of a table at most."""
MOVING = (".fmu", ".xml")
"""Formats in which a mass can hang on the muscle."""


class How(NamedTuple):
    """What is asked for beside the map."""

    points: tuple[int, int]  #: lengths and pressures of a table
    name: str
    mass: float | None  #: kg
    fmi: int  #: version of FMI


_WRITERS: dict[str, Callable[[Chart, How], bytes | str]] = {
    ".h": lambda made, how: made.to_c(how.name),
    ".py": lambda made, how: made.to_numpy(),
    ".csv": lambda made, how: table(made, *how.points),
    ".mat": lambda made, how: as_mat(made, *how.points),
    ".json": lambda made, how: as_json(made, *how.points),
    ".txt": lambda made, how: as_modelica(made, *how.points),
    ".fmu": lambda made, how: as_fmu(made, how.name, how.mass, how.fmi),
    ".xml": lambda made, how: as_mjcf(made, how.name, how.mass),
    ".c": lambda made, how: as_plugin(made, how.name),
}


def how(
    path: str | PathLike[str], points: tuple[int, int], name: str, mass: Any, force: bool, fmi: int | None = None
) -> How:
    """What is asked for, checked before long work. SpecError for what `export` refuses whatever the map."""
    suffix = suffix_of(path, FORMATS)
    disk.check_target(path, force)
    if not (len(points) == 2 and all(isinstance(n, int) and 2 <= n <= MOST for n in points)):
        raise SpecError("export.points", points, f"must be two whole numbers from 2 to {MOST}", "lengths and pressures")
    check_name(name, "export.name")
    if mass is not None and suffix not in MOVING:
        raise SpecError("export.mass", mass, f"is for {' and '.join(MOVING)}", f"leave it out for {suffix}")
    if fmi is not None and suffix != ".fmu":
        raise SpecError("export.fmi", fmi, "is for .fmu", f"leave it out for {suffix}")
    if fmi not in (None, *MAIN):
        raise SpecError("export.fmi", fmi, "must be 2 or 3", "the version of FMI that the simulator reads; most read 2")
    if suffix == ".fmu":
        compiler()
    declared = Declared(kind="quantity", meaning="mass on the muscle", read=read_quantity, unit="kg", low=0.0,
                        low_open=True, high=1e6)  # fmt: skip
    return How(
        points, name, None if mass is None else float(read_quantity(mass, "export.mass", declared)), int(fmi or 2)
    )


def export(
    muscle: Muscle | Chart,
    path: str | PathLike[str],
    *,
    length: Any = None,
    pressure: Any = None,
    tolerance: float = 1e-4,
    points: tuple[int, int] = (LENGTHS, PRESSURES),
    name: str = "muscle",
    mass: Any = None,
    fmi: int | None = None,
    force: bool = False,
    watch: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a map of a muscle for another program, by the ending of the file's name.

    `.h` is one C99 file and `.py` a module that needs NumPy alone: both are the map itself, outside of its range too.
    `.mat` (MATLAB, with breakpoints as Simulink's look-up tables take them), `.txt` (Modelica's CombiTable2Ds), `.json`
    and `.csv` are tables over even lengths and pressures in SI units, with what must be known of them.

    `.fmu` is for co-simulation by FMI 2.0 or 3.0, in C, compiled here, its source inside: pressure and length in;
    force, volume, their slopes and the largest radius out. With a mass it moves: the command of a valve (ISO 6358) and
    a push in; length, speed, pressure and the state of the air out; conductances, supply and so on are its parameters.
    `.xml` is a model for MuJoCo: a mass that hangs on the muscle, a tendon with an affine actuator whose activation is
    the pressure. How far its force is off the map stands in the file. The map itself is what `in_mujoco` gives it, in
    Python, or `.c`, an engine plugin whose head says how it is compiled and put into a model.

    Args:
        muscle: a map that `chart` gave, or a muscle, of which one is made.
        path: the file.
        length: for a muscle: the lengths [m], as for `chart`.
        pressure: for a muscle: the gauge pressures [Pa].
        tolerance: for a muscle: largest error of the force over the largest force.
        points: lengths and pressures of a table.
        name: what the functions in C begin with; the name of an FMU and of MuJoCo's tendon and actuator.
        mass: mass [kg] on the muscle, for `.fmu` (with a valve then) and `.xml` (a fifth of the largest force by
            default).
        fmi: for `.fmu`: the version of FMI, 2 (by default) or 3.
        force: replace a file that is there already.
        watch: called with (pressures done, pressures in all) as a map is made.

    Returns:
        The path of the file.

    Raises:
        SpecError: for another ending, a file that exists (without `force`), an FMU where there is no C compiler, and
            whatever `chart` refuses.

    >>> chart = mk.chart(mk.presets.paper(), length="60 mm to 115 mm", pressure="0 to 3 bar")
    >>> mk.export(chart, "muscle.h").name
    'muscle.h'
    """
    asked = how(path, points, name, mass, force, fmi)
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
    content = _WRITERS[suffix_of(path, FORMATS)](made, asked)
    return disk.write(path, content.encode("utf-8") if isinstance(content, str) else content, force)
