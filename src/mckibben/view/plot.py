"""`plot()`: the picture of whatever the package's calls give."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from matplotlib.figure import Figure

from mckibben.data.values import Data
from mckibben.potential.chart import Chart
from mckibben.results.answers import Bode
from mckibben.results.design import Designed
from mckibben.results.effects import Effects
from mckibben.results.fit import Fitted
from mckibben.results.motion import Motion
from mckibben.results.motionfit import MotionFit
from mckibben.results.result import Result, State
from mckibben.results.sensitivity import Sensitivity
from mckibben.results.swept import is_sweep
from mckibben.results.tolerances import Tolerances
from mckibben.spec.errors import SpecError, nearest
from mckibben.view import curves, maps, style
from mckibben.view.bode import answered
from mckibben.view.chart import charted
from mckibben.view.design import designed
from mckibben.view.effects import bars
from mckibben.view.fit import fitted
from mckibben.view.measured import overlay
from mckibben.view.motion import moved
from mckibben.view.motionfit import followed
from mckibben.view.swept import swept
from mckibben.view.tolerances import scatter
from mckibben.view.tornado import tornado
from mckibben.view.words import headline

__all__ = ["KINDS", "plot"]

KINDS: dict[str, Callable[[Result], Figure]] = {
    "auto": curves.plot,
    "profiles": curves.profiles,
    "tension": curves.tension,
    "energy": curves.energy,
    "shares": curves.shares,
}
"""The pictures of a result."""
_TAKES = "a result of run, solve, sweep, fit, design, chart, simulate, sensitivity, tolerances, effects, a map"


def plot(result: Any, kind: str = "auto", data: Any = None) -> Figure:
    """Draw what `run`, `solve`, `load`, `fit`, `design`, `chart`, `simulate`, `effects` and so on gave.

    Nothing is solved.

    A result is drawn as the kind of its test asks for. Isometric and blocked: force against pressure. Isobaric: force
    against contraction. Isotonic and free contraction: contraction (and length) against pressure. Protocol and step:
    force, length and pressure state by state, and force against length. States that are not stable are marked; states
    that were not reached are gaps, with a note. A `State` is drawn as its radius and braid angle along the muscle, a
    force map as contours over length and pressure, a sweep as its last states over what varies, a working range as the
    region in that plane, a sensitivity as a tornado chart, tolerances as distributions with the part of each number,
    effects as bars, a fit as its forces over the measured ones, with what is left, a design as the force of the best
    over its contraction with what was demanded, or as its front, a map that `chart` made as its forces over
    contraction, and over the range with its edges, a motion as what moves, pressure, force and air over time, a fit of
    one as measured values over it with what is left, a frequency response as gain and phase.

    Args:
        result: what one of these calls gave, or several results of one kind of test by their names, as
            {"1 bar": first, "2 bar": second}: a family of curves.
        kind: of a result or a state, as on the command line: "auto" (as above), "profiles" (radius and angle along the
            muscle), "tension" (of one fibre along it), "energy" (the stored energies) or "shares" (of the axial load
            that mesh and chamber carry).
        data: measured points to lay over the curve of one result or of a family, as `read_data` gives them. Those at
            which the bench held what the test holds are drawn, and the rms and the largest difference of the curve from
            them are noted below, in N and in per cent of the largest measured force (where contractions are drawn, in
            per cent of the length), inside the range that the curve covers.

    Returns:
        A matplotlib Figure, in mm, N, bar and per cent; `figure.savefig("curve.pdf")` writes it.

    Raises:
        SpecError: for anything else, an unknown kind, or data of which no point belongs to the curve. A result without
            a single state is no error: its picture says why.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> figure = mk.plot(curve)
    >>> figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()
    ('Pressure (bar)', 'Force (N)')
    >>> mk.plot(curve, kind="tension").axes[0].get_ylabel()
    'Fibre tension T (N)'
    """
    if isinstance(kind, str) and kind.lower().endswith(".html"):
        raise SpecError("plot.kind", kind, "is a file's name", f'mk.interactive(result, "{kind}") writes a page')
    if not isinstance(kind, str) or kind not in KINDS:
        raise SpecError("plot.kind", kind, "is unknown", nearest(str(kind), KINDS))
    if data is not None:
        return _measured(result, kind, data)
    if isinstance(result, Result):
        return _headed(KINDS[kind](result), result)
    if isinstance(result, State):
        return _headed(KINDS["profiles" if kind == "auto" else kind](result.result), result.result)
    if isinstance(result, Mapping) and not hasattr(result, "data_vars"):
        return _family(result, kind)
    own: dict[type, Callable[[Any], Figure]] = {
        Sensitivity: tornado, Tolerances: scatter, Effects: bars, Fitted: fitted, Designed: designed,
        Chart: charted, Motion: moved, MotionFit: followed, Bode: answered,
    }  # fmt: skip
    draw = next((draw for kinds, draw in own.items() if isinstance(result, kinds)), None) or _of_dataset(result)
    if kind != "auto":
        raise SpecError("plot.kind", kind, "is for a result or a state", "leave it out")
    return draw(result)


def _measured(result: Any, kind: str, data: Any) -> Figure:
    """The curve of a result, or a family of curves, with measured points over it."""
    if not isinstance(data, Data):
        raise SpecError("plot.data", data, "must be what read_data gives", 'such as mk.read_data("bench.csv")')
    if kind != "auto":
        raise SpecError("plot.kind", kind, "has no room for measured points", "leave it out")
    if isinstance(result, Result):
        return overlay(plot(result), {"": result}, data)
    if isinstance(result, Mapping) and not hasattr(result, "data_vars"):
        return overlay(plot(result), {str(name): item for name, item in result.items()}, data)
    raise SpecError("plot.data", allowed="goes with a result of run, or several by their names")


def _family(results: Mapping[Any, Any], kind: str) -> Figure:
    """Several results of one kind of test in one picture."""
    if kind != "auto":
        raise SpecError("plot.kind", kind, "is for one result", "leave it out")
    same_kind(results)
    return curves.family({str(name): result for name, result in results.items()})


def same_kind(results: Mapping[Any, Any]) -> None:
    """SpecError unless these are results of one kind of test by their names."""
    wrong = [name for name, result in results.items() if not isinstance(result, Result)]
    if wrong or not results:
        raise SpecError("plot", wrong[0] if wrong else "{}", "must hold results of run by their names")
    kinds = list(dict.fromkeys(result.test.kind for result in results.values()))
    if len(kinds) > 1:
        raise SpecError("plot", ", ".join(kinds), "are tests of several kinds", "draw those of one kind together")


def _headed(figure: Figure, result: Result) -> Figure:
    """The figure with a line that names the muscle, the test and what is held."""
    style.heading(figure, headline(result))
    return figure


def _of_dataset(data: Any) -> Callable[[Any], Figure]:
    """What draws a Dataset; SpecError for what is none of the package's."""
    names = set(getattr(data, "data_vars", ()))
    if {"force", "largest_fibre_tension"} <= names:
        return maps.force_map
    if {"shortest", "longest"} <= names:
        return maps.region
    if "sweep" in getattr(data, "attrs", {}):
        if not is_sweep(data):
            advice = "draw it by data.plot(), or keep its verdict and status"
            raise SpecError("plot", allowed="this part of a sweep does not say how its states came out", advice=advice)
        return swept
    raise SpecError("plot", data, f"must be {_TAKES}")
