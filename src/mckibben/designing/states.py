"""The states of many designs that differ in numbers, at some places: through the batches of sweeps alone."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.designing.places import By, Place
from mckibben.measure.meridian import LINE
from mckibben.measure.read import NODES
from mckibben.measure.survey import survey
from mckibben.results.verdict import Verdict
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Isobaric, Isometric, Isotonic, Muscle, Test
from mckibben.sweeps.batches import Solved, solve_together
from mckibben.sweeps.groups import grouped, with_arrays
from mckibben.sweeps.lines import lines_of

__all__ = ["KEPT", "AtPlaces", "states_at"]

LEFT_OUT = 0.25
"""Share of designs that may be lost: the second way of batches takes long, and where few need it others are as good."""
SECANTS = 3
"""Steps towards the pressure at which a force is pulled."""
SETTLED = 1e-3
"""Part of that force by which the last one may be off."""
KEPT = ("length", "force", "pressure", "contraction", "volume", "largest_radius", "peak_fibre_tension")
"""What is read off every state."""

Columns = dict[str, np.ndarray]


@attrs.frozen
class AtPlaces:
    """Designs of one kind, and what their states are: every number an array (designs), NaN where there is no state.

    A state whose meridian was asked for has its `LINE` too, arrays (designs, points).
    """

    muscle: Muscle  #: what varies is an array
    count: int
    states: dict[Place, Columns]

    def at(self, place: Place, name: str = "force") -> np.ndarray:
        """A number of every design at a place."""
        return self.states[place][name]

    def over(self, places: Iterable[Place], name: str = "force") -> np.ndarray:
        """A number of every design at some places (designs, places)."""
        return np.stack([self.at(place, name) for place in places], axis=1)

    def all(self, number: Any) -> np.ndarray:
        """A number of the muscle, for every design."""
        return np.broadcast_to(np.asarray(number, float), (self.count,))


@one_thread()
def states_at(
    muscle: Muscle, values: Columns, count: int, places: Iterable[Place], tolerance: float,
    lined: Collection[Place] = (),
) -> AtPlaces | None:  # fmt: skip
    """What `count` designs are at the places; None where the fields cannot vary in a batch.

    Args:
        muscle: what the designs have in common.
        values: by field, the numbers (designs, 1) in which they differ.
        count: number of designs.
        places: where they are looked at.
        tolerance: relative error aimed at.
        lined: of which of the places the meridian is asked for.
    """
    several = with_arrays(muscle, values)
    if several is None:
        return None
    wanted = dict.fromkeys(places)
    seen = AtPlaces(several, count, {})
    free = {Place(place.pressure, By.FORCE, 0.0): None for place in wanted if place.by == By.SHARE}
    wanted |= free
    for force in dict.fromkeys(place.at for place in wanted if place.by == By.FORCE):
        own = [place for place in wanted if place.by == By.FORCE and place.at == force]
        own.sort(key=lambda place: place.pressure)
        test = Isotonic(force=force, pressure=[place.pressure for place in own])
        line = any(place in lined for place in own)
        _keep(seen, own, _solved(muscle, test, values, np.arange(count), tolerance, line), None)
    lengths = {place: _length(seen, place) for place in wanted if place.by != By.FORCE}
    for place in [place for place in lengths if place.by == By.SHARE and place.at == 1.0]:
        seen.states[place] = seen.states[Place(place.pressure, By.FORCE, 0.0)]
        del lengths[place]
    _over_length(seen, muscle, values, lengths, tolerance, lined)
    _pulling(seen, muscle, values, lengths, tolerance)
    return seen


def _length(seen: AtPlaces, place: Place) -> np.ndarray:
    """The length [m] of every design at a place."""
    rest = seen.all(seen.muscle.rest_length)
    if place.by == By.LENGTH:
        return seen.all(place.at)
    if place.by == By.CONTRACTION:
        return (1.0 - place.at) * rest
    free = seen.at(Place(place.pressure, By.FORCE, 0.0), "length")
    return rest + place.at * (free - rest)


def _over_length(
    seen: AtPlaces, muscle: Muscle, values: Columns, lengths: dict[Place, np.ndarray], tolerance: float,
    lined: Collection[Place],
) -> None:  # fmt: skip
    """States of one pressure each, from the longest to the shortest of every design."""
    for pressure in dict.fromkeys(place.pressure for place in lengths if place.pull is None):
        own = [place for place in lengths if place.pressure == pressure and place.pull is None]
        columns = np.stack([lengths[place] for place in own], axis=1)
        order = np.argsort(-columns, axis=1, kind="stable")
        some = np.flatnonzero(np.isfinite(columns).all(axis=1))
        held = np.take_along_axis(columns, order, axis=1)[some]
        line = any(place in lined for place in own)
        found: Columns = _nothing(seen.count, len(own), line)
        if len(some):
            test = Isobaric(pressure=pressure, length=held[0].tolist())
            of_some = {name: numbers[some] for name, numbers in values.items()} | {"test.length": held}
            found = _put(found, some, _solved(muscle, test, of_some, np.arange(len(some)), tolerance, line))
        _keep(seen, own, found, np.argsort(order, axis=1))


def _pulling(
    seen: AtPlaces, muscle: Muscle, values: Columns, lengths: dict[Place, np.ndarray], tolerance: float
) -> None:
    """States of a length at which a force is pulled: the pressure is sought by secants, since they are nearly in line.

    The two states to begin with are at the highest pressure and at half of it, because a soft muscle may have none
    without pressure. NaN where the highest one is not enough.
    """
    everything = np.arange(seen.count)
    for place, length in lengths.items():
        if place.pull is None:
            continue
        ends = [place.pressure, 0.5 * place.pressure]
        of = values | {"test.length": length[:, None]}
        test = Isometric(length=float(length[0]), pressure=ends)
        found = _solved(muscle, test, of, everything, tolerance)
        P0, P1 = (np.full(seen.count, end) for end in ends)
        F0, F1 = found["force"].T
        enough = place.pull <= F0
        for _ in range(SECANTS):
            with np.errstate(invalid="ignore", divide="ignore"):
                step = P1 + (place.pull - F1) * (P0 - P1) / (F0 - F1)
            step = np.clip(step, 0.0, place.pressure)
            some = np.flatnonzero(np.isfinite(step) & enough)
            state = _nothing(seen.count, 1)
            if len(some):
                of_some = {name: numbers[some] for name, numbers in of.items()} | {"test.pressure": step[some, None]}
                test = Isometric(length=float(length[some[0]]), pressure=float(step[some[0]]))
                state = _put(state, some, _solved(muscle, test, of_some, np.arange(len(some)), tolerance))
            P0, F0, P1, F1 = P1, F1, step, state["force"][:, 0]
        off = np.abs(F1 - place.pull) > SETTLED * abs(place.pull)
        off &= ~((P1 == 0.0) & (place.pull <= F1))
        seen.states[place] = {name: np.where(off, np.nan, state[name][:, 0]) for name in KEPT}


def _nothing(count: int, states: int, line: bool = False) -> Columns:
    lines = {name: np.full((count, states, NODES), np.nan) for name in LINE if line}
    return {name: np.full((count, states), np.nan) for name in KEPT} | lines


def _put(into: Columns, some: np.ndarray, found: Columns) -> Columns:
    for name, values in into.items():
        values[some] = found[name]
    return into


def _keep(seen: AtPlaces, places: list[Place], found: Columns, order: np.ndarray | None) -> None:
    """Put what was found (designs, states) at its places; `order` says which state of each design is at which."""
    for k, place in enumerate(places):
        column = np.full(seen.count, k) if order is None else order[:, k]
        seen.states[place] = {name: values[np.arange(seen.count), column] for name, values in found.items()}


def _solved(
    muscle: Muscle, test: Test, values: Columns, index: np.ndarray, tolerance: float, line: bool = False
) -> Columns:
    """The states of a test on every design; NaN where a batch does not find them, or they are not stable."""
    found = _nothing(len(index), sum(step.points for step in test.as_steps(muscle)), line)
    group = grouped(muscle, test, values, index)
    if group is None:
        return found
    threads = 1 if os.environ.get("PJRT_NPROC") == "1" else os.cpu_count() or 1
    for solved in solve_together(group, tolerance, threads=threads, left_out=LEFT_OUT):
        good = np.ones(solved.plain.shape, bool)
        for d in np.flatnonzero(~solved.plain.all(axis=1)).tolist():
            good[d] = _stable(solved, d)
        for name in KEPT:
            found[name][solved.group.index] = np.where(good, solved.numbers[name], np.nan)
        for name, rows in (lines_of(solved) if line else {}).items():
            found[name][solved.group.index] = np.where(good[..., None], rows, np.nan)
    return found


def _stable(solved: Solved, d: int) -> np.ndarray:
    """Which states of one design are stable and admissible, judged as for a single run."""
    p = jax.tree.map(lambda values: np.asarray(values[d]), solved.group.p)
    problem = Problem.of(solved.line, p, float(solved.b[d]))
    seen = survey(problem, solved.state.u[d], solved.state.loads[d], solved.group.held)
    return np.array([judged.verdict == Verdict.STABLE for judged in seen.verdicts])
