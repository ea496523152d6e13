"""Limits as a feature: the shortest and longest length, the force extremum, the least pressure that holds a length."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.experiments.burst import Burst, burst_pressures
from mckibben.experiments.foresee import refuse_friction
from mckibben.experiments.holding import FIRST, SIZE, TRIALS, holding
from mckibben.measure.caution import MuscleWarning
from mckibben.search.walk import BranchEnd, branch_end
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle, Path, SpecError, Step
from mckibben.spec.text import to_toml
from mckibben.units import show

if TYPE_CHECKING:
    import xarray as xr


class Pressure(float):
    """A pressure [Pa] that was sought, NaN with a `reason` where there is none."""

    reason: str

    def __new__(cls, value: float, reason: str = "") -> Pressure:
        made = super().__new__(cls, value)
        made.reason = reason
        return made


@attrs.frozen
class Limits:
    """What a muscle can do at one pressure. Lengths [m], forces [N], pressures [Pa]; NaN where there is none.

    It is what `limits` gives. Force is positive in tension, so the shortest states usually have a negative one.

    Args:
        pressure: gauge pressure [Pa].
        shortest: length of the shortest stable and admissible state [m].
        shortest_force: force there [N].
        shortest_cause: why no shorter state is admissible, in words.
        stable_down_to: length of the shortest stable state [m], also where its wall is behind its fitting.
        stable_force: force there [N].
        longest: full extension [m]: there is no equilibrium at this length or beyond. NaN where fibres stretch or
            fittings give way, which sets no such limit.
        force_extremum: least force [N], that is the largest push, on the way to the shortest length.
        force_extremum_length: length there [m].
        burst: where a length or a force was given: pressures from which it would burst, a `Burst`.

    >>> found = mk.limits(mk.presets.paper(), pressure="1 bar")
    >>> round(1e3 * found.shortest, 1), round(1e3 * found.longest, 1)  # mm
    (32.1, 128.8)
    >>> round(found.shortest_force, 1)  # N: it pushes
    -75.7
    """

    pressure: float
    shortest: float  #: shortest length of a stable, admissible state
    shortest_force: float  #: force there
    shortest_cause: str  #: why no shorter one is admissible
    stable_down_to: float  #: shortest length of a stable state, wherever its wall lies
    stable_force: float  #: force there
    longest: float  #: full extension: no equilibrium at or beyond it
    force_extremum: float  #: largest compressive force (least force) on the way to the shortest length
    force_extremum_length: float  #: length there
    burst: Burst | None = None  #: pressures from which it would burst, at a length or under a force


@one_thread()
def limits(muscle: Muscle, *, pressure: Any, length: Any = None, contraction: Any = None, force: Any = None) -> Limits:
    """Limits of a muscle at one gauge pressure, on the path from its initial length to shorter ones.

    With a length, a contraction or a force also the pressures from which it would burst there (`burst_pressures`).

    Args:
        muscle: the specification.
        pressure: gauge pressure [Pa], a number or text with a unit.
        length: distance between the fittings [m] at which it would burst, likewise.
        contraction: in place of it: 1 - h/H0, such as "10 %" or 0.1.
        force: in place of either: what it lifts [N].

    Returns:
        A `Limits`: shortest and longest length and the largest push, in SI units; NaN where there is no stable state
        even at the initial length.

    Raises:
        SpecError: for a pressure that is not one value in range.

    >>> found = mk.limits(mk.presets.paper(), pressure="1 bar")
    >>> round(1e3 * found.shortest, 1)  # mm
    32.1
    >>> found.shortest_cause
    'the shape gives way to one side: ...'
    """
    refuse_friction(muscle, "limits")
    P, bench = _value("pressure", pressure), Bench.of(muscle)
    longest = bench.longest if np.isfinite(bench.longest) else np.nan
    held = {"length": length, "contraction": contraction, "force": force}
    burst = burst_pressures(muscle, **held) if any(value is not None for value in held.values()) else None
    nothing = Limits(P, *(np.nan,) * 2, "", *(np.nan,) * 2, longest, *(np.nan,) * 2, burst)
    stable = shorten(bench, P, shapes=False)
    if stable.last is None:
        return attrs.evolve(nothing, shortest_cause=stable.cause.reason)
    end = shorten(bench, P, shapes=True)
    extremum = _force_extremum(bench, P, end)
    return attrs.evolve(
        nothing,
        shortest=end.held.get("length"),
        shortest_force=end.last.state.force if end.last else np.nan,
        shortest_cause=end.cause.reason,
        stable_down_to=stable.held.get("length"),
        stable_force=stable.last.state.force,
        force_extremum=extremum[0],
        force_extremum_length=extremum[1],
    )


def _value(name: str, value: Any) -> float:
    """One controlled quantity from what a user gives."""
    path = getattr(Step(**{name: value, "force": 0.0}), name)
    if path.needs_present or path.varies:
        raise SpecError(f"limits.{name}", str(path), "must be one value")
    return float(path.sample(1)[0])


def shorten(bench: Bench, pressure: float, shapes: bool) -> BranchEnd:
    """Where good states end on the way from the initial length to where the braid has a tenth of its own."""
    H0, dead = float(bench.p.H0), float(bench.p.rest - bench.p.H0)
    start, middle, target = (Held.of(length=share * H0 + dead, pressure=pressure) for share in (1.0, 0.55, 0.1))
    return branch_end(bench.problem(SIZE, bench.placement(middle)), start, target, 1e-10, shapes)


def _force_extremum(bench: Bench, pressure: float, end: BranchEnd) -> tuple[float, float]:
    """Least force between the initial length and the end of the branch, and its length."""
    if end.last is None:
        return np.nan, np.nan
    problem, state = end.last.state.problem, end.last.state
    forces, lengths = [state.force], [state.length]
    for length in np.linspace(state.length, float(bench.p.rest), 41)[1:]:
        state = find(problem, Held.of(length=float(length), pressure=pressure), state, radius=0.3)
        forces.append(state.force)
        lengths.append(state.length)
    k = int(np.argmin(forces))
    if k == 0:
        return forces[0], lengths[0]
    if k == len(forces) - 1:
        return forces[k], lengths[k]
    curve = np.polyfit(lengths[k - 1 : k + 2], forces[k - 1 : k + 2], 2)
    at = float(-0.5 * curve[1] / curve[0])
    found = find(problem, Held.of(length=at, pressure=pressure), end.last.state)
    return found.force, at


def least_pressure(muscle: Muscle, *, length: Any = None, contraction: Any = None, shapes: bool = True) -> float:
    """Least gauge pressure [Pa], zero or above, at which a muscle is stable and admissible at a length.

    Args:
        muscle: the specification.
        length: distance between the fittings [m], a number or text with a unit.
        contraction: in place of the length: 1 - h/H0, such as "10 %" or 0.1.
        shapes: False if only stability counts, and the wall may lie behind its fitting.

    Returns:
        The pressure [Pa]; NaN where none will do, as beyond full extension. Then a `MuscleWarning` says why, and so
        does the number's own `reason`, which is empty otherwise.

    Raises:
        SpecError: for a length that is not one value in range.

    >>> mk.least_pressure(mk.presets.paper(), length="55 mm")  # it holds without pressure
    0.0
    >>> none = mk.least_pressure(mk.presets.paper(), length="130 mm")  # longer than its fibres
    >>> none, none.reason
    (nan, 'no equilibrium: the fibres are straight at 128.7786 mm, the longest possible length')
    """
    (step,) = Step(length=length, contraction=contraction, force=0.0).as_steps(muscle)  # type: ignore[call-arg]
    refuse_friction(muscle, "least_pressure")
    h, bench = _value("length", step.length), Bench.of(muscle)
    found = float("nan") if h >= bench.longest else holding(bench, h, 0.0, shapes=shapes)
    if found == found:
        return Pressure(found)
    highest = show(FIRST * 4.0 ** (TRIALS - 1), "Pa", 2)
    reason = bench.too_long() if h >= bench.longest else f"no pressure up to {highest} holds {show(h, 'm')}"
    warnings.warn(f"no least pressure: {reason}", MuscleWarning, stacklevel=2)
    return Pressure(found, reason)


def working_range(muscle: Muscle, *, pressures: Any) -> xr.Dataset:
    """The admissible region in the length-pressure plane: shortest, longest and force at the shortest, per pressure.

    Args:
        muscle: the specification.
        pressures: gauge pressures [Pa]: a ramp such as "0 to 3 bar" (21 values) or a list.

    Returns:
        A Dataset over pressure with the fields of `Limits`: shortest, stable_down_to and longest [m], shortest_force
        and force_extremum [N], and shortest_cause in words.

    Raises:
        SpecError: for a pressure out of range or without its unit.

    >>> region = mk.working_range(mk.presets.paper(), pressures=["1 bar"])
    >>> (1e3 * region.shortest.values).round(1), (1e3 * region.longest.values).round(1)  # mm
    (array([32.1]), array([128.8]))
    """
    refuse_friction(muscle, "working_range")
    step = Step(pressure=pressures, force=0.0)
    path = Path.parse(pressures, "Pa")
    found = [limits(muscle, pressure=Path((float(P),), unit="Pa")) for P in path.sample(step.points)]
    about = {"muscle": to_toml(muscle, allow_custom=True), "assumed": ", ".join(muscle.assumed)}
    units = {"shortest": "m", "stable_down_to": "m", "longest": "m", "shortest_force": "N", "force_extremum": "N"}
    variables = {
        name: ("pressure", [getattr(one, name) for one in found], {"units": unit}) for name, unit in units.items()
    }
    causes = ("pressure", [one.shortest_cause for one in found])
    pressure = ("pressure", [one.pressure for one in found], {"units": "Pa", "long_name": "gauge pressure"})
    import xarray as xr  # here, because it takes half a second to import

    return xr.Dataset(variables | {"shortest_cause": causes}, {"pressure": pressure}, about)
