"""Saving and loading results, fits, designs, maps, motions and tolerances by the ending of the file's name."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
        result: what `run`, `solve`, `fit`, `design`, `chart`, `simulate`, `fit_motion` or `tolerances` gave.
            Of a `State` its `result` is saved, and that is
            what `load` gives.
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
    result = _result(result)
    from mckibben.results.result import Result

    whole = suffix_of(path) == ".nc"
    if not isinstance(result, Result):
        from mckibben.results.fit import Fitted

        if isinstance(result, Fitted):
            from mckibben.files import fits

            return (fits.save if whole else fits.save_csv)(result, path, force)
        from mckibben.potential.chart import Chart

        if isinstance(result, Chart):
            from mckibben.files import charts

            return (charts.save if whole else charts.save_csv)(result, path, force)
        from mckibben.results.motion import Motion

        if isinstance(result, Motion):
            from mckibben.files import motions

            return (motions.save if whole else motions.save_csv)(result, path, force)
        from mckibben.results.motionfit import MotionFit

        if isinstance(result, MotionFit):
            from mckibben.files import motionfits

            return (motionfits.save if whole else motionfits.save_csv)(result, path, force)
        from mckibben.results.tolerances import Tolerances

        if isinstance(result, Tolerances):
            from mckibben.files import table, tolerances

            return (tolerances.save if whole else table.save_tolerances)(result, path, force)
        from mckibben.files import designs

        return (designs.save if whole else designs.save_csv)(result, path, force)
    if whole:
        from mckibben.files import netcdf

        return netcdf.save(result, path, force)
    from mckibben.files import table

    return table.save_csv(result, path, force)


def _result(given: Any) -> Result | Fitted | Designed | Chart | Motion | MotionFit | Tolerances:
    from mckibben.potential.chart import Chart
    from mckibben.results.design import Designed
    from mckibben.results.fit import Fitted
    from mckibben.results.motion import Motion
    from mckibben.results.motionfit import MotionFit
    from mckibben.results.result import Result, State
    from mckibben.results.tolerances import Tolerances

    if isinstance(given, State):
        return given.result
    if isinstance(given, (Result, Fitted, Designed, Chart, Motion, MotionFit, Tolerances)):
        return given
    if hasattr(given, "to_netcdf"):
        raise SpecError(
            "save",
            allowed="takes what run, solve, fit, design, chart, simulate, fit_motion or tolerances gave",
            advice='write a Dataset with data.to_netcdf("x.nc")',
        )
    raise SpecError(
        "save", given, "must be what run, solve, fit, design, chart, simulate, fit_motion or tolerances gave"
    )


def load(path: str | PathLike[str]) -> Result | Fitted | Designed | Chart | Motion | MotionFit | Tolerances:
    """What `save` wrote into an `.nc` file. SpecError for any other file, or a damaged one."""
    if Path(path).suffix.lower() == ".csv":
        raise SpecError(str(path), allowed="is a table only", advice="save results as .nc to load them again")
    if Path(path).suffix.lower() == ".zarr":
        raise SpecError(str(path), allowed="holds a sweep, not one result", advice="open it with mckibben.load")
    from mckibben.files import hdf5, netcdf

    stored = hdf5.opened(path)
    if hdf5.kind(stored) == "fit":
        from mckibben.files import fits

        return fits.of(stored, str(path))
    if hdf5.kind(stored) == "design":
        from mckibben.files import designs

        return designs.of(stored, str(path))
    if hdf5.kind(stored) == "chart":
        from mckibben.files import charts

        return charts.of(stored, str(path))
    if hdf5.kind(stored) == "motion":
        from mckibben.files import motions

        return motions.of(stored, str(path))
    if hdf5.kind(stored) == "motion fit":
        from mckibben.files import motionfits

        return motionfits.of(stored, str(path))
    if hdf5.kind(stored) == "tolerances":
        from mckibben.files import tolerances

        return tolerances.of(stored, str(path))
    return netcdf.of(stored, str(path))


def load_result(path: str | PathLike[str]) -> Result:
    """The result in an `.nc` file. SpecError for any file that is not a whole result."""
    found = load(path)
    from mckibben.results.result import Result

    if not isinstance(found, Result):
        known = (
            ("quantities", "fit of a motion"), ("residuals", "fit"), ("free_length", "map"), ("consumed", "motion"),
            ("quantiles", "set of tolerances"),
        )  # fmt: skip
        what = next((name for has, name in known if hasattr(found, has)), "design")
        raise SpecError(str(path), allowed=f"holds a {what}, not a result", advice="open it with mckibben.load")
    return found
