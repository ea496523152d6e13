"""`interactive()`: a picture as a page for a browser, in which every point tells its numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben import disk
from mckibben.data.values import Data
from mckibben.potential.chart import Chart
from mckibben.results.design import Designed
from mckibben.results.fit import Fitted
from mckibben.results.motion import Motion
from mckibben.results.result import Result
from mckibben.spec.errors import SpecError
from mckibben.view import web, webcurves, webdesign, webfit, webmaps, webmotion
from mckibben.view.plot import same_kind

__all__ = ["ENDINGS", "check_page", "interactive"]

ENDINGS = {".html": "page for a browser"}
_TAKES = "a result of run, several by their names, a design, a fit, a map or a motion"


def interactive(result: Any, path: str | PathLike[str], *, data: Any = None, force: bool = False) -> Path:
    """Draw what `plot` draws as a page for a browser, in which every point tells its numbers.

    Move over a point to read it; drag to enlarge, click twice to go back, click in the legend to hide a curve. Drawn
    are results, as the kind of their test asks for, each state with the numbers of a table and its verdict, those not
    stable marked; several results as a family of curves; a design as its front, of three goals in space, each design
    with what is free in it and its goals, or as the curves of the best; a fit as measured points over its forces, with
    what is left; a map as its forces over contraction, and over its range; a force map; a motion over time. Nothing is
    solved. The page is one file of some 5 MB that needs no network and asks for nothing. It takes plotly:
    pip install "mckibben[interactive]".

    Args:
        result: what `run`, `design`, `fit`, `chart`, `force_map`, `simulate` or `load` gave, or results of one kind of
            test by their names.
        path: the file, which ends in .html. It is written whole or not at all.
        data: measured points to lay over the curve of a result or a family, as of `plot`.
        force: replace a file that is there already.

    Returns:
        The path of the file.

    Raises:
        SpecError: for what has no interactive picture, data of which no point belongs to the curve, plotly missing, and
            a file that exists (without `force`) or cannot be written.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> mk.interactive(curve, "curve.html")  # doctest: +SKIP
    >>> try:
    ...     mk.interactive(curve, "curve.png")
    ... except mk.SpecError as error:
    ...     print(error)
    curve.png: must end in .html (page for a browser); mk.plot(result).savefig("curve.png") writes a still picture
    """
    check_page(path, force)
    return disk.write(path, drawn(result, data).page(), force)


def check_page(path: str | PathLike[str], force: bool = False) -> None:
    """SpecError if `interactive` would fail for the file's name, its place, or plotly missing."""
    if Path(path).suffix.lower() not in ENDINGS:
        known = " or ".join(f"{name} ({meaning})" for name, meaning in ENDINGS.items())
        advice = f'mk.plot(result).savefig("{Path(path).name}") writes a still picture'
        raise SpecError(str(path), allowed=f"must end in {known}", advice=advice)
    disk.check_target(path, force)
    web.check_plotly(str(path))


def drawn(result: Any, data: Any = None) -> web.Web:
    """The interactive picture of a result."""
    family = isinstance(result, Mapping) and not hasattr(result, "data_vars")
    if family:
        same_kind(result)
    if data is not None:
        return _measured(result, data, family)
    if family:
        return webcurves.family({str(name): one for name, one in result.items()})
    own: dict[type, Callable[[Any], web.Web]] = {
        Result: webcurves.states, Designed: _designed, Chart: webmaps.charted, Motion: webmotion.moved,
        Fitted: webfit.fitted,
    }  # fmt: skip
    draw = next((draw for kind, draw in own.items() if isinstance(result, kind)), None)
    if {"force", "largest_fibre_tension"} <= set(getattr(result, "data_vars", ())):
        draw = webmaps.force_map
    if draw is None:
        what = type(result).__name__
        said = f"has no interactive picture: those are of {_TAKES}"
        raise SpecError("interactive", what, said, "mk.plot(...).savefig writes .png, .pdf and .svg")
    return draw(result)


def _designed(design: Designed) -> web.Web:
    return webdesign.best(design) if design.front is None else webdesign.front(design)


def _measured(result: Any, data: Any, family: bool) -> web.Web:
    if not isinstance(data, Data):
        raise SpecError("interactive.data", data, "must be what read_data gives", 'such as mk.read_data("bench.csv")')
    if family:
        return webcurves.measured({str(name): one for name, one in result.items()}, data)
    if isinstance(result, Result):
        return webcurves.measured({"": result}, data)
    raise SpecError("interactive.data", allowed="goes with a result of run, or several by their names")
