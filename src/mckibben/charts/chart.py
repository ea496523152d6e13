"""`chart()`: force, volume and their slopes over length and pressure as one smooth function with a known error."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from mckibben.charts import edges as of_edges
from mckibben.charts.friction import check_map, with_friction
from mckibben.charts.sample import Samples, sample
from mckibben.charts.series import Edges, Scales, fitted, scales_of
from mckibben.measure.report import versions
from mckibben.model.extension import longest
from mckibben.model.parameters import parameters
from mckibben.potential.chart import Chart
from mckibben.potential.evaluate import Table, evaluate, largest_radius, unbounded
from mckibben.potential.table import variables_of
from mckibben.spec import Muscle, SpecError, Step
from mckibben.spec.declared import evolved
from mckibben.spec.text import to_toml
from mckibben.units import show

__all__ = ["chart"]

TOLERANCES = (1e-6, 1e-2)
LEVELS = ((24, 24), (32, 32), (40, 56))
"""Pressures and lengths of the states of which maps are made, one level after the other; those before are used too."""
CHECKS = 8
"""Pressures at which the error is measured, at as many lengths each."""
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
SOFT = 1e-3
"""Pressure under the root at which states are placed, over the range of pressures."""
SURER = 0.03
"""Tolerance of the states over that of the map."""
CLOSER = 64
"""Lengths at least where the range ends at states that barely exist: near them a path is followed in short steps."""


def chart(
    muscle: Muscle,
    *,
    length: Any,
    pressure: Any,
    tolerance: float = 1e-4,
    watch: Callable[[int, int], None] | None = None,
) -> Chart:
    """A map of a muscle that can be trusted: force, volume, radius and stiffness over length and pressure at once.

    States are solved in batches over the range. One potential W, a polynomial in length and in the root of the
    pressure, is fitted to their forces, volumes and energies, so that force, volume and stiffness are its exact slopes.
    It gets more terms, and states, until it misses none of the states that it was not made of by more than the
    tolerance; the largest error there is `chart.error`. At these states the stiffness, of which the map is not made, is
    compared with that of the equations (`chart.stiffness_error`). Lengths at which the muscle is not stable and
    admissible are left out of the range, with a note.

    Of a muscle with friction the map is that without, and beside it half of what lies between its sliding branches
    (`Chart.friction`, `Chart.branches`) and how stiff crossings are that stick: which of the forces between them there
    is depends on the path, which `simulate` follows.

    Args:
        muscle: the specification.
        length: the lengths [m], from the shortest to the longest: "60 mm to 115 mm", or a pair.
        pressure: the gauge pressures [Pa], from the lowest to the highest: "0 to 3 bar", or a pair.
        tolerance: largest error of the force, over the largest force, and of the volume, over the largest volume; from
            1e-6 to 1e-2.
        watch: called with (pressures done, pressures in all).

    Returns:
        A `Chart`: functions of length and pressure, for arrays, one point, JAX, C or NumPy alone.

    Raises:
        SpecError: for an empty range, one at or near full extension, or one in which the muscle has no stable state;
            for so much friction that states in which all crossings slip are not found.

    >>> chart = mk.chart(mk.presets.paper(), length="60 mm to 115 mm", pressure="0 to 3 bar")
    >>> bool(chart.error < 1e-4), round(float(chart.force("115 mm", "1 bar")), 1)  # N
    (True, 101.2)
    """
    if muscle.friction is not None:
        check_map(muscle)
        plain = chart(
            evolved(muscle, friction=None), length=length, pressure=pressure, tolerance=tolerance, watch=watch
        )
        return with_friction(muscle, plain, watch or (lambda done, total: None))
    if not isinstance(tolerance, (int, float)) or not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
        raise SpecError("chart.tolerance", tolerance, f"must be from {TOLERANCES[0]:g} to {TOLERANCES[1]:g}")
    asked = _asked(muscle, length, pressure)
    making = _Making(muscle, tolerance, watch or (lambda done, total: None))
    edges = making.looked(asked)
    for level, (paths, n) in enumerate(LEVELS):
        edges = making.more(edges, paths, n)
        table = making.fitted(edges, (LEVELS[level][1] * 3 // 4, LEVELS[level][0] * 2 // 3))
        errors = _errors(table, making.checks, scales_of(making.states))
        if max(errors[:2]) <= tolerance:
            break
    return _answer(muscle, table, making, asked, edges, tolerance)


def _asked(muscle: Muscle, length: Any, pressure: Any) -> Edges:
    """The range as it was asked for, checked."""
    low, high = _pair("length", length, muscle)
    first, last = _pair("pressure", pressure, muscle)
    most = longest(muscle)
    if high > of_edges.NEAR * most:
        said = f"must be below {show(of_edges.NEAR * most, 'm', 5)}, {100 * of_edges.NEAR:g} % of full extension"
        raise SpecError("chart.length", show(high, "m"), said, "the force has no bound there; end the map before")
    span = last - first
    return Edges(first, last, np.array([low]), np.array([high]), SOFT * span)


def _pair(name: str, given: Any, muscle: Muscle) -> tuple[float, float]:
    """Both ends of a range, the lower first."""
    (step,) = Step(**({"force": 0.0} | {name: given})).as_steps(muscle)
    path = getattr(step, name)
    unit = "m" if name == "length" else "Pa"
    if path.needs_present or not path.varies:
        example = '"60 mm to 115 mm"' if name == "length" else '"0 to 3 bar"'
        raise SpecError(f"chart.{name}", str(path), "must be a range", f"such as {example}")
    ends = [float(one) for one in path.waypoints]
    if len(ends) > 2 and path.mode != "list":
        raise SpecError(f"chart.{name}", str(path), "must have two ends")
    low, high = min(ends), max(ends)
    if not high - low > 1e-6 * max(abs(low), abs(high)):
        raise SpecError(f"chart.{name}", str(path), f"is empty: both ends are {show(low, unit)}", "give two ends")
    return low, high


@attrs.define
class _Making:
    """The states so far."""

    muscle: Muscle
    tolerance: float
    watch: Callable[[int, int], None]
    states: Any = None  #: points that maps are made of
    checks: Any = None  #: points by which their errors are measured
    done: int = 0
    total: int = LEVELS[0][0] + CHECKS

    def looked(self, asked: Edges) -> Edges:
        """The first states, and the range without what is not admissible where a quick look finds that."""
        first = self._sampled(asked, *LEVELS[0], singly=False)
        if first.good.all():
            self.states = _points(first.take(np.arange(LEVELS[0][0])))
            self.checks = _points(first.take(np.arange(LEVELS[0][0], len(first.good))))
            return asked
        return of_edges.admissible(self.muscle, asked)

    def more(self, edges: Edges, paths: int, n: int) -> Edges:
        """More states, and the range without the points at which there is none."""
        if (paths, n) == LEVELS[0] and self.states is not None:
            return edges
        n = n if len(edges.low) == 1 else max(n, CLOSER)
        self.done, self.total = 0, paths + CHECKS
        seen = self._sampled(edges, paths, n, singly=True)
        made, checks = (_points(seen.take(some)) for some in np.split(np.arange(len(seen.good)), [paths]))
        self.states = made if self.states is None else self.states + made
        self.checks = checks if self.checks is None else self.checks + checks
        edges = of_edges.narrowed(edges, _points(seen))
        self.checks = _within(edges, self.checks)
        return edges

    def _sampled(self, edges: Edges, paths: int, n: int, singly: bool) -> Samples:
        """States for the map at places that crowd at the ends, then some for checking at others."""
        t = np.arange(CHECKS)
        y = np.concatenate([-np.cos(np.pi * np.arange(paths) / (paths - 1)), 2.0 * ((0.5 + GOLDEN * t) % 1.0) - 1.0])
        y[paths : paths + 2] = -1.0, 1.0
        made = 0.5 + 0.5 * np.cos(np.pi * np.arange(n) / (n - 1))
        shifts = ((GOLDEN * t) % 1.0)[:, None]
        checked = 1.0 - np.clip((np.arange(n) + shifts - 0.5) / (n - 1), 0.0, 1.0)
        shares = np.concatenate([np.tile(made, (paths, 1)), checked])
        ends = of_edges.lengths_in(edges, y)
        lengths = ends[:, :1] + shares * (ends[:, 1:] - ends[:, :1])
        P, before = of_edges.pressures_in(edges, y), self.done

        def tell(done: int) -> None:
            self.done = min(before + done, self.total)
            self.watch(self.done, self.total)

        solver = max(1e-10, min(1e-6, SURER * self.tolerance))
        return sample(self.muscle, lengths, P, solver, singly, tell, stiff=paths)

    def fitted(self, edges: Edges, most: tuple[int, int]) -> Table:
        """The map through the states so far."""
        low, high = float(edges.low.min()), float(edges.high.max())
        good = self.states.take(np.flatnonzero(self.states.good))
        scales = scales_of(good)
        length = (0.5 * (low + high), 0.5 * (high - low))
        return fitted(good, edges, length, self.tolerance, most, lambda table: max(_errors(table, good, scales)[:2]))


def _points(seen: Samples) -> Samples:
    """The states as points in a row."""
    numbers = {name: values.ravel() for name, values in seen.numbers.items()}
    return Samples(seen.length.ravel(), seen.pressure.ravel(), numbers, seen.good.ravel())


def _within(edges: Edges, seen: Samples) -> Samples:
    """The good points that lie in a range."""
    low, high = np.moveaxis(of_edges.lengths_in(edges, edges.across(seen.pressure)), -1, 0)
    return seen.take(np.flatnonzero(seen.good & (seen.length >= low) & (seen.length <= high)))


def _errors(table: Table, seen: Samples, scales: Scales) -> tuple[float, float, float]:
    """Largest errors of force, volume and radius at states, over the scales."""
    free = unbounded(table)
    found = evaluate(free, seen.length, seen.pressure)
    numbers = seen.numbers
    off = [np.abs(found.force - numbers["force"]).max() / scales.force,
           np.abs(found.volume - numbers["volume"]).max() / scales.volume]  # fmt: skip
    if table.radius.size > 1:
        radius = largest_radius(free, seen.length, seen.pressure)
        off.append(np.abs(radius - numbers["largest_radius"]).max() / scales.radius)
    return tuple(float(one) for one in [*off, np.nan][:3])  # type: ignore[return-value]


def _stiffness(table: Table, seen: Samples) -> tuple[float, float]:
    """The largest error [N/m] of the stiffness where the solver's is known, and the largest one; NaN where none is."""
    there = np.isfinite(seen.numbers["stiffness"])
    if not there.any():
        return np.nan, np.nan
    known = seen.take(np.flatnonzero(there))
    own = known.numbers["stiffness"]
    found = evaluate(unbounded(table), known.length, known.pressure).stiffness
    return float(np.abs(found - own).max()), float(np.abs(own).max())


def _answer(muscle: Muscle, table: Table, making: _Making, asked: Edges, edges: Edges, tolerance: float) -> Chart:
    """The map as a value."""
    import xarray as xr

    checks = making.checks
    inside = _within(edges, making.states)
    scales = scales_of(inside + checks)
    force, volume, radius = _errors(table, checks, scales)
    stiffness, stiffest = _stiffness(table, checks)
    converged = max(force, volume) <= tolerance
    notes = []
    if not converged:
        said = f"the error is {max(force, volume):.2g} of the largest, not {tolerance:g}"
        notes.append(f"{said}: ask for a smaller range")
    if float(edges.low.max()) > float(asked.low[0]):
        said = f"lengths below {show(float(edges.low.max()), 'm', 4)} are left out, in part"
        notes.append(f"{said}: the muscle is not stable, or not admissible, there (mk.limits says why)")
    if float(edges.high.min()) < float(asked.high[0]):
        said = f"lengths beyond {show(float(edges.high.min()), 'm', 4)} are left out"
        notes.append(f"{said}: no stable state was found there")
    known = int(np.isfinite(checks.numbers["stiffness"]).sum())
    if known < len(checks.length):
        notes.append(
            f"the error of the stiffness is that at {known} of the {len(checks.length)} states; elsewhere unknown"
        )
    if muscle.assumed:
        notes.append(f"assumed, not measured: {', '.join(muscle.assumed)}")
    p = parameters(muscle)
    about = {
        "muscle": to_toml(muscle, allow_custom=True), "assumed": ", ".join(muscle.assumed), "notes": "\n".join(notes),
        "mckibben_version": versions()["mckibben"], "tolerance": float(tolerance), "converged": int(converged),
        "force_error": force * scales.force, "volume_error": volume * scales.volume,
        "radius_error": radius * scales.radius, "stiffness_error": stiffness, "largest_stiffness": stiffest,
        "largest_force": scales.force, "largest_volume": scales.volume,
        "largest_radius": scales.radius, "states": int(making.states.good.sum()),
        "asked_shortest": float(asked.low[0]), "asked_longest": float(asked.high[0]),
        "rubber_inside": 0.0 if p.tube is None else float(p.tube.rubber),
    }  # fmt: skip
    seen = {f"check_{name}": ("check", values, {"units": unit}) for name, values, unit in (
        ("length", checks.length, "m"), ("pressure", checks.pressure, "Pa"), ("force", checks.numbers["force"], "N"),
        ("volume", checks.numbers["volume"], "m^3"), ("radius", checks.numbers["largest_radius"], "m"),
        ("stiffness", checks.numbers["stiffness"], "N/m"))}  # fmt: skip
    variables = variables_of(table)
    number = variables.pop("number")
    return Chart(muscle, xr.Dataset(variables | seen, {"number": number}, about))
