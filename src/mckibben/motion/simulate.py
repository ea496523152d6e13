"""`simulate()`: a rig in motion over time; `simulate_many()`: many of them."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import Any

import attrs
import numpy as np

from mckibben.motion.commands import Commands
from mckibben.motion.drive import METHODS, drive
from mckibben.motion.maps import maps_of
from mckibben.motion.plant import Plant
from mckibben.motion.record import recorded
from mckibben.motion.start import at_rest
from mckibben.processes import main_left_out
from mckibben.results.motion import Motion
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.rig import Rig
from mckibben.units import UnitError, to_si

__all__ = ["check_simulation", "read_time", "simulate", "simulate_many"]

TOLERANCES = (1e-12, 1e-2)
Watch = Callable[[int, int], None]


def simulate(
    rig: Rig,
    until: Any,
    *,
    chart: Any = None,
    points: int = 501,
    tolerance: float = 1e-6,
    method: str = "LSODA",
    watch: Watch | None = None,
) -> Motion:
    """A rig in motion: muscle, load, air, valve and command, from rest at time 0 on.

    The muscle is the map that `chart` gives: force and volume as functions of length and gauge pressure, quasi-static.
    One with friction at its crossings moves between the branches of its map, by the path of its length.
    Its air is an ideal gas, the valve follows ISO 6358. Jumps of commands, samples of controllers, end stops, friction
    that holds and cables that go slack end a stretch of time, and the next begins: none is stepped over.

    Args:
        rig: what moves, `Rig`.
        until: how long [s], such as "2 s".
        chart: the map of the muscle, as `mk.chart` gives it (of two different muscles a pair of them), to use it again;
            it is made where it is left out, and kept while the program runs.
        points: times in the answer, evenly spread.
        tolerance: relative error of a step.
        method: SciPy's solver: "LSODA", "Radau", "BDF", "RK45" or "DOP853".
        watch: called with (times done, times in all).

    Returns:
        A `Motion`: `motion.data` is an xarray Dataset over time. Where a simulation stops early, it holds what was
        reached, and `motion.reason` says why.

    Raises:
        SpecError: for a rig that cannot begin (outside of its map, no equilibrium), signals that end too early, a
            controller that gives no number, an unknown method.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> motion = mk.simulate(rig, until="1 s")
    >>> float(motion.pressure[-1].round(-3))  # Pa
    200000.0
    """
    _check(rig)
    end = read_time(until)
    check_simulation(points, tolerance, method)
    charts = maps_of(rig, chart)
    return _one(rig, charts, end, points, tolerance, method, watch)


def simulate_many(
    rigs: Iterable[Rig],
    until: Any,
    *,
    chart: Any = None,
    points: int = 101,
    tolerance: float = 1e-6,
    method: str = "LSODA",
    workers: int | None = None,
    watch: Watch | None = None,
) -> list[Motion]:
    """Many rigs in motion, on all cores; each as `simulate` has it. Muscles that are equal share one map.

    Args:
        rigs: the rigs.
        until: how long [s].
        chart: the map of all muscles; made where it is left out, one for each muscle.
        points: times in each answer.
        tolerance: relative error of a step.
        method: SciPy's solver.
        workers: processes; as many as there are cores where it is left out, 1 for this process alone. Where a rig has a
            Python function that cannot be sent to another process, all go in this one.
        watch: called with (rigs done, rigs in all).

    Returns:
        A list with a `Motion` for each rig.

    Raises:
        SpecError: as `simulate`, with the number of the rig.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> motions = mk.simulate_many([rig, rig], until="0.1 s", workers=1)
    >>> len(motions), motions[0] == motions[1]
    (2, True)
    """
    given = list(rigs)
    end = read_time(until)
    check_simulation(points, tolerance, method)
    for k, rig in enumerate(given):
        _numbered(k, _check, rig)
    maps = [_numbered(k, maps_of, rig, chart) for k, rig in enumerate(given)]
    run = partial(_one, end=end, points=points, tolerance=tolerance, method=method, watch=None)
    count = min(workers or os.cpu_count() or 1, max(1, len(given) // 8)) if workers is None else workers
    tell = watch or (lambda done, total: None)
    sent = None if min(count, len(given)) <= 1 else _packed(given, maps, 8 * count)
    if sent is not None:
        return _spread(run, sent, count, lambda done: tell(done, len(given)))
    found = []
    for k, (rig, charts) in enumerate(zip(given, maps, strict=True)):
        found.append(_numbered(k, run, rig, charts))
        tell(k + 1, len(given))
    return found


def _spread(run: Callable[..., Motion], pieces: list[bytes], workers: int, tell: Callable[[int], None]) -> list[Motion]:
    """Pieces on several processes."""
    found: list[Motion] = []
    # No fork: JAX has threads by now, which a forked process would wait for.
    with main_left_out(), ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for one in [pool.submit(_piece, run, piece) for piece in pieces]:
            found += one.result()
            tell(len(found))
    return found


def _packed(rigs: list[Rig], maps: list[tuple[Any, ...]], count: int) -> list[bytes] | None:
    """The rigs in pieces as they travel, with the functions in them and the maps they share; None where one cannot."""
    import cloudpickle

    fresh = {id(one): _fresh(one) for charts in maps for one in charts}
    pairs = [(k, rig, tuple(fresh[id(one)] for one in maps[k])) for k, rig in enumerate(rigs)]
    pieces = np.array_split(np.arange(len(rigs)), min(len(rigs), count))
    try:
        return [cloudpickle.dumps([pairs[k] for k in piece]) for piece in pieces]
    except (pickle.PicklingError, AttributeError, TypeError):
        return None


def _fresh(chart: Any) -> Any:
    """A map without what it has compiled for itself, which does not travel."""
    return attrs.evolve(chart) if attrs.has(type(chart)) else chart


def _piece(run: Callable[..., Motion], piece: bytes) -> list[Motion]:
    return [_numbered(k, run, rig, charts) for k, rig, charts in pickle.loads(piece)]


def _numbered(k: int, do: Callable[..., Any], *given: Any) -> Any:
    """Something done for one rig of many, whose errors say of which."""
    try:
        return do(*given)
    except SpecError as error:
        raise error.renamed(f"rigs[{k}]: {error.field}") from error


def _one(
    rig: Rig, charts: Sequence[Any], end: float, points: int, tolerance: float, method: str, watch: Watch | None
) -> Motion:
    begun = at_rest(Plant.of(rig, charts))
    commands = Commands(rig, end)
    times = np.linspace(0.0, end, points)
    done = drive(begun, commands, times, method, tolerance, watch or (lambda done, total: None))
    return recorded(begun.plant, done, method, tolerance)


def _check(rig: Any) -> None:
    if not isinstance(rig, Rig):
        raise SpecError(
            "simulate.rig", rig, "must be a Rig", "such as mk.Rig(muscle=..., load=..., supply=..., valve=...)"
        )


def check_simulation(points: int, tolerance: float, method: str, who: str = "simulate") -> None:
    """SpecError for options out of range."""
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= 1_000_000:
        raise SpecError(f"{who}.points", points, "must be a whole number from 2 to 1000000")
    if not isinstance(tolerance, (int, float)) or not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
        raise SpecError(f"{who}.tolerance", tolerance, f"must be from {TOLERANCES[0]:g} to {TOLERANCES[1]:g}")
    if method not in METHODS:
        raise SpecError(f"{who}.method", method, "is unknown", nearest(str(method), METHODS))


def read_time(until: Any, field: str = "simulate.until") -> float:
    """A time [s] above 0."""
    try:
        end = float(to_si(until, "s"))
    except UnitError as error:
        raise SpecError(field, until, str(error), error.advice) from error
    if not 0.0 < end <= 1e6:
        raise SpecError(field, until, "must be above 0 s and at most 1e+06 s")
    return end
