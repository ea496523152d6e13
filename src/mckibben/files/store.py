"""Saving and loading results, fits, designs, maps, motions and tolerances by the ending of the file's name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mckibben import disk
from mckibben.spec.errors import SpecError

if TYPE_CHECKING:
    from mckibben.potential.chart import Chart
    from mckibben.results.design import Designed
    from mckibben.results.fit import Fitted
    from mckibben.results.motion import Motion
    from mckibben.results.motionfit import MotionFit
    from mckibben.results.result import Result
    from mckibben.results.tolerances import Tolerances

__all__ = ["SUFFIXES", "check_output", "load", "load_result", "save", "suffix_of"]

SUFFIXES = {".nc": "everything, to be loaded again (NetCDF-4)", ".csv": "the table of states, with notes beside it"}


_HELD = {
    "fit": "fits", "design": "designs", "chart": "charts", "motion": "motions", "motion fit": "motionfits",
    "tolerances": "tolerances",
}  # fmt: skip
"""The module that reads what a file says that it holds; a file of a result says nothing."""


def suffix_of(path: str | PathLike[str], allowed: dict[str, str] = SUFFIXES) -> str:
    """The ending of a file's name, in lower case; SpecError unless it is one of `allowed`."""
    suffix = Path(path).suffix.lower()
    if suffix not in allowed:
        known = " or ".join(f"{ending} ({meaning})" for ending, meaning in allowed.items())
        raise SpecError(str(path), allowed=f"must end in {known}")
    return suffix


def check_output(path: str | PathLike[str], force: bool = False) -> None:
    """SpecError if `save` to `path` would fail for its name, its folder or a file that is there already."""
    suffix = suffix_of(path)
    disk.check_target(path, force)
    if suffix == ".csv":
        from mckibben.files import table

        disk.check_target(table.notes_file(path), force)


def save(result: Any, path: str | PathLike[str], force: bool = False) -> Path:
    """Save what a call gave: `.nc` keeps everything and can be loaded again, `.csv` is a table.

    A table holds nothing but its head and its rows, which are states, of a fit the measured points with their
    residuals, of a design its front, of a map a grid, of a motion what was seen over time, of tolerances the numbers;
    what was computed and by what is in a text file beside it ("out.csv.txt").

    Args:
        result: what `run`, `solve`, `fit`, `design`, `chart`, `simulate`, `fit_motion` or `tolerances` gave. Of a
            `State` its `result` is saved, and that is what `load` gives.
        path: the file; its ending says the format. It is written whole or not at all.
        force: replace a file that is there already.

    Returns:
        The path of the file.

    Raises:
        SpecError: for what is no result, another ending, a file that exists (without `force`), or one that cannot be
            written.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> mk.save(curve, "curve.nc").name
    'curve.nc'
    """
    from mckibben.results.result import State

    result = result.result if isinstance(result, State) else result
    kind = next((one for one in _kinds() if isinstance(result, one.type)), None)
    if kind is None:
        calls = "run, solve, fit, design, chart, simulate, fit_motion or tolerances gave"
        if hasattr(result, "to_netcdf"):
            advice = 'write a Dataset with data.to_netcdf("x.nc")'
            raise SpecError("save", allowed=f"takes what {calls}", advice=advice)
        raise SpecError("save", result, f"must be what {calls}")
    written: Path = (kind.save if suffix_of(path) == ".nc" else kind.save_csv)(result, path, force)
    return written


class _Kind(NamedTuple):
    """A kind of answer, and what puts it into files."""

    said: str  #: the word for people
    type: type
    save: Callable[..., Path]
    save_csv: Callable[..., Path]


def _kinds() -> tuple[_Kind, ...]:
    """All of them; imported here, because most calls need none."""
    from mckibben.files import charts, designs, fits, motionfits, motions, netcdf, table, tolerances
    from mckibben.potential.chart import Chart
    from mckibben.results.design import Designed
    from mckibben.results.fit import Fitted
    from mckibben.results.motion import Motion
    from mckibben.results.motionfit import MotionFit
    from mckibben.results.result import Result
    from mckibben.results.tolerances import Tolerances

    return (
        _Kind("result", Result, netcdf.save, table.save_csv),
        _Kind("fit", Fitted, fits.save, fits.save_csv),
        _Kind("design", Designed, designs.save, designs.save_csv),
        _Kind("map", Chart, charts.save, charts.save_csv),
        _Kind("motion", Motion, motions.save, motions.save_csv),
        _Kind("fit of a motion", MotionFit, motionfits.save, motionfits.save_csv),
        _Kind("set of tolerances", Tolerances, tolerances.save, table.save_tolerances),
    )


def load(path: str | PathLike[str]) -> Result | Fitted | Designed | Chart | Motion | MotionFit | Tolerances:
    """What `save` wrote into an `.nc` file. SpecError for any other file, or a damaged one."""
    if Path(path).suffix.lower() == ".csv":
        raise SpecError(str(path), allowed="is a table only", advice="save results as .nc to load them again")
    if Path(path).suffix.lower() == ".zarr":
        raise SpecError(str(path), allowed="holds a sweep, not one result", advice="open it with mckibben.load")
    from mckibben.files import hdf5

    stored = hdf5.opened(path)
    module = import_module(f"mckibben.files.{_HELD.get(hdf5.kind(stored), 'netcdf')}")  # which says what is wrong
    found: Result | Fitted | Designed | Chart | Motion | MotionFit | Tolerances = module.of(stored, str(path))
    return found


def load_result(path: str | PathLike[str]) -> Result:
    """The result in an `.nc` file. SpecError for any file that is not a whole result."""
    return result_in(load(path), path)


def result_in(found: Any, path: str | PathLike[str]) -> Result:
    """What a file holds, where that is a result; SpecError, which names the file, where it is something else."""
    from mckibben.results.result import Result

    if not isinstance(found, Result):
        what = next(kind.said for kind in _kinds() if isinstance(found, kind.type))
        raise SpecError(str(path), allowed=f"holds a {what}, not a result", advice="open it with mckibben.load")
    return found
