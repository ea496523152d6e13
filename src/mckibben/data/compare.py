"""A curve against measured points: how far off it is, in numbers. Values only; nothing is solved."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.data.branches import LOADING, UNLOADING
from mckibben.data.values import Data
from mckibben.results.result import Result
from mckibben.spec.errors import SpecError
from mckibben.units import show

__all__ = ["Comparison", "axes_of", "compare", "difference", "matching", "values_of"]

_SAME = 0.02
"""What a test holds is the same if it differs by this part of itself, a length by half of it."""
_SLACK = 0.5
"""A force [N] below which a load cell says nothing: forces that differ by less are the same."""
_DRIVEN = {
    "isometric": ("pressure", "force", "length"), "blocked-force": ("pressure", "force", "length"),
    "isobaric": ("contraction", "force", "pressure"), "isotonic": ("pressure", "contraction", "force"),
    "free-contraction": ("pressure", "contraction", "force"),
}  # fmt: skip
"""Of each kind of test: what its curve is drawn against, what is drawn, and what is held."""


@attrs.frozen(eq=False)
class Comparison:
    """Differences of a curve from measured points, curve less measurement, at the abscissae of the points.

    The curve is interpolated linearly, inside the range that it covers; what lies outside is counted and not compared.
    """

    x: np.ndarray  #: abscissae of the points that are compared (n), SI
    measured: np.ndarray  #: their measured values (n), SI
    differences: np.ndarray  #: curve less measurement (n), SI
    outside: int  #: points beyond the curve's range
    unit: str  #: SI unit of the values, "1" for a contraction
    across: str  #: SI unit of the abscissae

    @property
    def largest_measured(self) -> float:
        """The largest measured value by size: what per cents are of."""
        return float(np.max(np.abs(self.measured), initial=0.0))

    @property
    def rms(self) -> float:
        """Root of the mean square of the differences; NaN without points."""
        return float(np.sqrt(np.mean(self.differences**2))) if len(self.differences) else float("nan")

    @property
    def worst(self) -> int:
        """Place of the largest difference by size; there must be a point."""
        return int(np.argmax(np.abs(self.differences)))

    def percent(self, value: float) -> float:
        """A difference in per cent of the largest measured value; NaN where that is zero."""
        return 100.0 * value / self.largest_measured if self.largest_measured else float("nan")

    def __str__(self) -> str:
        """Root mean square and largest difference, both in per cent of the largest measured value too."""
        count = len(self.x)
        lost = f"; {self.outside} of {count + self.outside} points outside the curve's range" if self.outside else ""
        if not count:
            return f"none of {self.outside} points within the curve's range"
        largest = float(self.differences[self.worst])
        place = _shown(float(self.x[self.worst]), self.across) + (" contraction" if self.across == "1" else "")
        of = f"the largest measured, {_shown(self.largest_measured, self.unit)}"
        return (
            f"rms {_shown(self.rms, self.unit)} ({self.percent(self.rms):.2g} % of {of}), largest difference "
            f"{_shown(largest, self.unit)} ({self.percent(largest):.2g} %) at {place}, {count} points{lost}"
        )


def _shown(value: float, unit: str) -> str:
    return f"{100.0 * value:.3g} %" if unit == "1" else show(value, unit, 3)


def axes_of(result: Result) -> tuple[str, str, str]:
    """What the curve of a result is drawn against, what is drawn, and what is held; SpecError for a protocol."""
    kind = result.test.kind
    if kind not in _DRIVEN:
        advice = "compare a test that holds one thing, such as isobaric"
        raise SpecError("data", allowed=f"a {kind} has no one curve to lay measured points over", advice=advice)
    return _DRIVEN[kind]


def values_of(data: Data, result: Result, name: str) -> np.ndarray:
    """A quantity of the points [SI], for the muscle of a result."""
    if name in ("pressure", "force"):
        return np.asarray(getattr(data, name))
    lengths = data.lengths(result.muscle)
    return lengths if name == "length" else 1.0 - lengths / float(result.muscle.rest_length)


def matching(result: Result, data: Data) -> Data:
    """The points at which the bench held what the test of a result holds; SpecError where there are none."""
    held = axes_of(result)[2]
    wanted = result.column(held)
    wanted = wanted[np.isfinite(wanted)]
    if not len(wanted):
        return data
    value, points = float(np.median(wanted)), values_of(data, result, held)
    slack = {
        "length": 0.5 * _SAME * float(result.muscle.rest_length),
        "pressure": _SAME * abs(value),
        "force": max(_SAME * abs(value), _SLACK),
    }[held]
    same = np.abs(points - value) <= slack
    if not same.any():
        unit = {"length": "m", "pressure": "Pa", "force": "N"}[held]
        near = ", ".join(dict.fromkeys(show(x, unit, 3) for x in np.quantile(points, [0.0, 0.5, 1.0])))
        said = f"no point has the {held} of the curve, {show(value, unit, 4)}: they have {near} and the like"
        raise SpecError(data.source, allowed=said, advice=f"run the test at a {held} that was measured")
    return data.where(same)


def difference(
    xs: np.ndarray, ys: np.ndarray, x: np.ndarray, y: np.ndarray, rising: np.ndarray, unit: str, across: str
) -> Comparison:
    """A curve (xs, ys) less points (x, y); a curve that turns back is compared way by way.

    `rising` (n) says whether the point was reached with growing x, and is asked only where several ways cover it.
    """
    good = np.isfinite(xs) & np.isfinite(ys)
    xs, ys = xs[good], ys[good]
    moved = np.diff(xs, prepend=np.nan) != 0.0
    xs, ys = xs[moved], ys[moved]
    turns = np.flatnonzero(np.diff(np.diff(xs) > 0.0)) + 1
    starts, stops = [0, *turns.tolist()], [*turns.tolist(), len(xs) - 1]
    found = np.full(len(x), np.nan)
    ways = [(xs[a : b + 1], ys[a : b + 1]) for a, b in zip(starts, stops, strict=True) if b > a]
    for own in (True, False):  # the ways of the point's own direction come first
        for way, values in ways:
            up = bool(way[-1] > way[0])
            ends = (way.min(), way.max())
            slack = 1e-9 * max(map(abs, ends))
            inside = (x >= ends[0] - slack) & (x <= ends[1] + slack) & np.isnan(found)
            inside &= (rising == up) if own else True
            order = slice(None) if up else slice(None, None, -1)
            found[inside] = np.interp(x[inside], way[order], values[order])
    kept = np.isfinite(found)
    return Comparison(x[kept], y[kept], (found - y)[kept], int((~kept).sum()), unit, across)


def compare(result: Result, data: Data) -> Comparison:
    """The curve of a result less the measured points that held the same (`matching`)."""
    across, what, _ = axes_of(result)
    picked = matching(result, data)
    x, y = (values_of(picked, result, name) for name in (across, what))
    rising = picked.branches == (UNLOADING if across == "contraction" else LOADING)
    unit = {"pressure": "Pa", "contraction": "1", "force": "N"}
    return difference(result.column(across), result.column(what), x, y, rising, unit[what], unit[across])
