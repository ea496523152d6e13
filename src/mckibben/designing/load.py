"""Opening what was saved, by the ending of its name and what is in it."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files import store

if TYPE_CHECKING:
    from xarray import Dataset

    from mckibben.designing.answer import Design
    from mckibben.fitting.answer import Fit
    from mckibben.potential.chart import Chart
    from mckibben.results.motion import Motion
    from mckibben.results.motionfit import MotionFit
    from mckibben.results.result import Result
    from mckibben.results.tolerances import Tolerances

__all__ = ["load"]


def load(path: str | PathLike[str]) -> Result | Fit | Design | Chart | Motion | MotionFit | Tolerances | Dataset:
    """What is in an `.nc` file (equal to what was saved) or a `.zarr` store (a sweep).

    Args:
        path: the file or the store.

    Returns:
        A `Result`, a `Fit`, a `Design`, a `Chart`, a `Motion`, a `MotionFit` or `Tolerances`; for a sweep an xarray
        Dataset, read from the disk when used.

    Raises:
        SpecError: if there is nothing, or nothing that `save` or `sweep` wrote, or a file that is damaged.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> path = mk.save(curve, "curve.nc")
    >>> mk.load(path) == curve
    True
    """
    if Path(path).suffix.lower() == ".zarr":
        from mckibben.sweeps import store as sweeps  # here, because a result takes no Zarr

        return sweeps.load(path)
    found = store.load(path)
    from mckibben.potential.chart import Chart
    from mckibben.results.motion import Motion
    from mckibben.results.result import Result

    if isinstance(found, (Result, Chart, Motion)):
        return found
    from mckibben.results.design import Designed
    from mckibben.results.fit import Fitted

    if isinstance(found, Designed):
        from mckibben.designing.answer import Design

        return Design(found.muscle, found.given, found.data)
    if isinstance(found, Fitted):
        from mckibben.fitting.answer import Fit  # here, because a result takes no solver

        return Fit(found.muscle, found.given, found.data, found.further)
    return found
