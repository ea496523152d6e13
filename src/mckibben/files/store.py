"""Saving and loading results, fits, designs and maps by the ending of the file's name."""

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
    from mckibben.results.result import Result

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
    """Save a result, a fit, a design or a map: `.nc` keeps everything and can be loaded again, `.csv` is a table.

    A table holds nothing but its head and its rows, which are states, of a fit the measured points with their
    residuals, of a design its front, of a map a grid; what was computed and by what is in a text file beside it
    ("out.csv.txt").

    Args:
        result: what `run`, `solve`, `fit`, `design` or `chart` gave. Of a `State` its `result` is saved, and that is
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
        from mckibben.files import designs

        return (designs.save if whole else designs.save_csv)(result, path, force)
    if whole:
        from mckibben.files import netcdf

        return netcdf.save(result, path, force)
    from mckibben.files import table

    return table.save_csv(result, path, force)


def _result(given: Any) -> Result | Fitted | Designed | Chart:
    from mckibben.potential.chart import Chart
    from mckibben.results.design import Designed
    from mckibben.results.fit import Fitted
    from mckibben.results.result import Result, State

    if isinstance(given, State):
        return given.result
    if isinstance(given, (Result, Fitted, Designed, Chart)):
        return given
    if hasattr(given, "to_netcdf"):
        raise SpecError(
            "save",
            allowed="takes what run, solve, fit, design or chart gave",
            advice='write a Dataset with data.to_netcdf("x.nc")',
        )
    raise SpecError("save", given, "must be what run, solve, fit, design or chart gave")


def load(path: str | PathLike[str]) -> Result | Fitted | Designed | Chart:
    """The result, fit, design or map in an `.nc` file. SpecError for any other file, or one that is not whole."""
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
    return netcdf.of(stored, str(path))


def load_result(path: str | PathLike[str]) -> Result:
    """The result in an `.nc` file. SpecError for any file that is not a whole result."""
    found = load(path)
    from mckibben.results.result import Result

    if not isinstance(found, Result):
        what = "fit" if hasattr(found, "residuals") else "map" if hasattr(found, "free_length") else "design"
        raise SpecError(str(path), allowed=f"holds a {what}, not a result", advice="open it with mckibben.load")
    return found
