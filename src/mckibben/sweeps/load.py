"""Opening what was saved, by the ending of its name: one result, or the store of a sweep."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.store import load_result

if TYPE_CHECKING:
    from xarray import Dataset

    from mckibben.results.result import Result

__all__ = ["load"]


def load(path: str | PathLike[str]) -> Result | Dataset:
    """The result in an `.nc` file, equal to what was saved, or the sweep in a `.zarr` store, finished or not.

    Args:
        path: the file or the store.

    Returns:
        A `Result`, or for a sweep an xarray Dataset that is read from the disk when used.

    Raises:
        SpecError: if there is nothing, or nothing that `save` or `sweep` wrote, or a file that is damaged.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> path = mk.save(curve, "curve.nc")
    >>> mk.load(path) == curve
    True
    """
    if Path(path).suffix.lower() == ".zarr":
        from mckibben.sweeps import store  # here, because a result takes no Zarr

        return store.load(path)
    return load_result(path)
