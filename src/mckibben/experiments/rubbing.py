"""A test on a muscle whose crossings rub: state by state, each from what the one before left behind.

The muscle starts as it was made, at its own length and without pressure, its crossings free of moment. Where a test
holds the pressure, that comes first, at the length as made; then the other quantity goes to its first value.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.measure.report import Part
from mckibben.measure.rub import Stepped, fresh, rub, rub_along
from mckibben.measure.survey import ROUNDING, Memories, Survey, error_bound, survey
from mckibben.model.friction import Remembered
from mckibben.solver.bench import QUICK, Bench, sizes_for
from mckibben.solver.find import find
from mckibben.solver.held import Held, rows_of, targets_of
from mckibben.solver.path import INTERRUPTED, Watch
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns
from mckibben.solver.threads import one_thread
from mckibben.spec import Along, SpecError, Step

__all__ = ["Going", "rubbed", "step_to"]

LARGEST_TURN = 0.05
"""Largest turn of a crossing [rad] in one step of the path; a longer way is taken in parts."""
LARGEST = 48
"""Unknowns up to which a path is walked anew: the error that the kink of the moment leaves falls slowly."""
SERIES = 0.5
"""Error by how the series end, over that found, up to which it is points that a path lacks, not unknowns."""
NEARBY = 2
"""States before and after one whose differences count as its own."""
SMALLEST = 1.0 / 1024.0
"""Smallest part of the way from state to state."""
SHORTER = 0.9
"""Share of `LARGEST_TURN` that is aimed at where a way is taken in parts: crossings do not turn evenly along it."""
AT_ONCE = 32
"""States that are walked in compiled code before they are looked at."""
LOST = "no state was found on from the one before: the shape gives way, or there is none"


@attrs.frozen
class Going:
    """Where a path has come: the last state, what its points remember from now on, and what it reads."""

    state: Unknowns
    outer: Remembered
    present: dict[str, float]  #: length, volume, force and pressure in SI units
    dissipated: float = 0.0  #: since the muscle was made [J]
    iterations: int = 0
    found: Stepped | None = None  #: the last state with what it was found from
    shares: tuple[float, ...] = ()  #: where on the last way states were found, the last being 1

    @classmethod
    def as_made(cls, problem: Problem) -> "Going":
        """The muscle as made."""
        inner, outer = jax.tree.map(np.asarray, fresh(problem.basis, problem.p))
        start = Unknowns(np.zeros(problem.basis.unknowns), np.zeros(problem.loads), inner)
        present = {"length": problem.unit[1], "volume": problem.unit[2], "force": 0.0, "pressure": 0.0}
        return cls(start, outer, {name: float(value) for name, value in present.items()})


def step_to(
    problem: Problem, here: Going, begin: Held, end: Held, shares: tuple[float, ...] = (), turn: float | None = None
) -> Going | None:  # fmt: skip
    """From a state at which `begin` holds, straight to `end`; in parts where crossings turn far or Newton fails.

    `shares` are those of a way of a muscle that is near: with the same parts, results change smoothly from muscle to
    muscle. `turn` is that of a crossing where the way was tried in one step, infinite where no state was found.
    """
    now, share, left = here, 0.0, list(shares)
    taken: list[float] = []
    parts = 1 if turn is None else _parts(1.0, 1.0, turn)
    while share < 1.0:
        ways = left or [*np.linspace(share, 1.0, parts + 1)[1:-1].tolist(), 1.0]
        if ways[0] - share < SMALLEST:
            return None
        aims = [end if to >= 1.0 else begin.towards(end, to) for to in ways]
        at, most = begin if share == 0.0 else begin.towards(end, share), 2.0 * LARGEST_TURN if left else LARGEST_TURN
        walk = _along(problem, now, at, aims, most)
        for one, to in zip(walk.states, ways, strict=False):
            now, share = attrs.evolve(one, iterations=one.iterations + (now.iterations if taken else 0)), to
            taken.append(to)
        done, left = len(walk.states), left[len(walk.states) :]
        if walk.turn is not None:
            parts, left = _parts(1.0 - share, ways[done] - share, walk.turn), []
        elif not left:
            parts = max(parts - done, 1)
    return attrs.evolve(now, shares=tuple(taken))


def _parts(way: float, tried: float, turn: float) -> int:
    """In how many parts a way is taken of which one was too long: by how far a crossing turned, or half as long."""
    shorter = SHORTER * LARGEST_TURN / turn if np.isfinite(turn) else 0.5
    return int(np.ceil(way / (tried * shorter) - 1e-9))


@attrs.frozen
class _Walk:
    """States in one step each, and why there are no more."""

    states: list[Going]
    turn: float | None  #: by how much crossings turned in a step that was too long, or infinity; None where all is done


def _along(problem: Problem, here: Going, begin: Held, path: Sequence[Held], farthest: float = LARGEST_TURN) -> _Walk:
    """The first states of a path from one at which `begin` holds, each in one step, as far as that goes: at most
    `AT_ONCE`, in compiled code."""
    path = path[:AT_ONCE]
    own, which = rows_of(begin.names, problem.loads)
    targets = targets_of((begin, *path, *([path[-1]] * (AT_ONCE - len(path)))), problem.unit, problem.loads)
    rows = rub_along(
        (problem.basis, own), problem.p, problem.b, here.state, here.outer, which, targets, np.asarray(len(path)),
        np.asarray(farthest),
    )  # fmt: skip
    rows = jax.tree.map(np.asarray, rows)
    states: list[Going] = []
    now = here
    for k in range(len(path)):
        turn = float(rows.largest_turn[k]) if rows.good[k] else np.inf
        if turn > farthest:
            return _Walk(states, turn)
        one: Stepped = jax.tree.map(lambda row, k=k: row[k], rows)
        now = _moved(problem, attrs.evolve(now, iterations=0), one)
        states.append(now)
    return _Walk(states, None)


def _moved(problem: Problem, now: Going, found: Stepped) -> Going:
    """Where a path has come with one more state."""
    unit = problem.load_unit
    read = (*found.totals, found.state.loads[0] * unit[1], found.state.loads[1] * unit[2])
    return Going(
        found.state._replace(memory=found.next_inner), found.next_outer,
        dict(zip(("length", "volume", "force", "pressure"), map(float, read), strict=True)),
        now.dissipated + float(found.dissipated), now.iterations + int(found.iterations), found,
    )  # fmt: skip


@attrs.frozen
class _Leg:
    """One step of a test as far as it was walked."""

    held: tuple[str, ...]
    asked: int
    possible: int  #: states before full extension
    states: list[Going]
    why: str  #: why it ended


@one_thread()
def rubbed(
    bench: Bench, steps: tuple[Step, ...], b: float, tolerance: float, watch: Watch = lambda k, n: None
) -> list[Part]:
    """The states of every step, on as many unknowns as the tolerance needs, their points crowded by b.

    Where slipping crossings border on sticking ones their moment has a kink, of which a series knows nothing: the error
    is told by how much force and length differ from those on half as many unknowns.
    """
    for step in steps:
        if step.gas is not None or step.along == Along.BRANCH:
            what = "a sealed gas" if step.gas is not None else 'along="branch"'
            raise SpecError("friction", allowed=f"does not go with {what}", advice="hold values, or leave friction out")
    problem = bench.problem(QUICK, b)
    legs = _walked(bench, problem, steps, watch)
    errors: list[np.ndarray] = []
    for size in (size for size in sizes_for("spectral", tolerance) if QUICK < size <= LARGEST):
        if _interrupted(legs) or (errors and all((error <= tolerance).all() for error in errors)):
            break
        finer = _finer(bench, problem, size, legs, errors)
        again = _walked(bench, finer, steps, watch)
        if _reached(again) < _reached(legs) and not _interrupted(again):
            break  # short waves may lose the way: what was reached is kept
        errors = [_differences(bench, *pair) for pair in zip(again, legs, strict=True)]
        if getattr(finer.basis, "dense", False):  # the same series on more points: the difference knows it not
            errors = [np.maximum(*pair) for pair in zip(errors, map(partial(_by_tail, finer), again), strict=True)]
        problem, legs = finer, again
    errors = errors or [np.full(len(leg.states), np.nan) for leg in legs]
    return [_part(problem, *pair) for pair in zip(legs, errors, strict=True)]


def _finer(bench: Bench, problem: Problem, size: int, legs: list[_Leg], errors: list[np.ndarray]) -> Problem:
    """What a path is walked on next: the same series on twice the points, where they are what is amiss, or `size`.

    Where slipping crossings border on sticking ones, the sum over the points misses what lies between two of them; by
    more unknowns alone that does not become less. A chamber that slides has a stress that jumps, which takes unknowns.
    """
    smooth = problem.p.friction.chamber is None
    if smooth and errors and _largest([_by_tail(problem, leg) for leg in legs]) <= SERIES * _largest(errors):
        basis = attrs.evolve(problem.basis, dense=True)  # type: ignore[arg-type, unused-ignore]
        return Problem.of(basis, bench.p, problem.b)
    return bench.problem(size, problem.b)


def _by_tail(problem: Problem, leg: _Leg) -> np.ndarray:
    """Relative error of force and length by how the series end (n)."""
    if not leg.states:
        return np.zeros(0)
    tail = problem.basis.tail(np.stack([one.state.u for one in leg.states]))
    return error_bound(np.full(len(tail), np.nan), tail, True)


def _largest(errors: list[np.ndarray]) -> float:
    """The largest number that is one; 0 where there is none."""
    every = np.concatenate(errors)
    return float(np.nanmax(every, initial=0.0)) if np.isfinite(every).any() else 0.0


def _interrupted(legs: list[_Leg]) -> bool:
    return any(leg.why == INTERRUPTED for leg in legs)


def _reached(legs: list[_Leg]) -> int:
    """States of all steps together."""
    return sum(len(leg.states) for leg in legs)


def _differences(bench: Bench, leg: _Leg, coarse: _Leg) -> np.ndarray:
    """Of length and force from those of a coarser space, over the length and the axial load of mesh and chamber.

    What a kink between two points leaves vanishes where it happens to lie well, so that the states nearby count too.
    """
    area, found = float(np.pi * bench.p.R0**2), []
    for one, other in zip(leg.states, coarse.states, strict=False):
        now, then = one.present, other.present
        load = max(abs(now["force"]), abs(area * now["pressure"]), 1e-300)
        by_load = max(abs(now["force"] - then["force"]), area * abs(now["pressure"] - then["pressure"])) / load
        found.append(max(by_load, abs(now["length"] - then["length"]) / now["length"]))
    found = [max(found[max(k - NEARBY, 0) : k + NEARBY + 1]) for k in range(len(found))]
    return np.array(found + [np.nan] * (len(leg.states) - len(found)))


def _walked(bench: Bench, problem: Problem, steps: tuple[Step, ...], watch: Watch) -> list[_Leg]:
    """Every step in turn; after one that was not finished none is tried."""
    here: Going | None = Going.as_made(problem)
    legs: list[_Leg] = []
    total, done = sum(step.points for step in steps), 0
    for step in steps:
        n, held = step.points, tuple(str(name) for name in step.controls)
        if here is None:
            legs.append(_Leg(held, n, n, [], "the step before was not finished"))
            continue
        wanted = np.stack([getattr(step, name).sample(n, here.present[name]) for name in held], axis=1)
        beyond = np.flatnonzero(wanted[:, 0] >= bench.longest) if held[0] == "length" else np.zeros(0, int)
        possible = int(beyond[0]) if len(beyond) else n
        path = [Held(held, tuple(row)) for row in wanted[:possible].tolist()]
        states, why = _states(problem, here, path, lambda k, _, done=done: watch(done + k, total), first=not legs)
        why = bench.too_long() if len(states) == possible < n and why != INTERRUPTED else why
        legs.append(_Leg(held, n, possible, states, why))
        here = states[-1] if len(states) == n else None
        done += n
    return legs


def _states(problem: Problem, here: Going, path: Sequence[Held], watch: Any, first: bool) -> tuple[list[Going], str]:
    """The states of a path as far as they were reached, and why it ended."""
    states: list[Going] = []
    try:
        now = _pressurised(problem, here, path[0]) if first and path else here
        if now is None:
            return states, LOST
        while len(states) < len(path):
            k, held = len(states), path[len(states)]
            begin = Held(held.names, tuple(now.present[name] for name in held.names)) if not k else path[k - 1]
            walk = _along(problem, now, begin, path[k:])
            found = walk.states
            if not found:  # the next is too far for one step
                parts = step_to(problem, now, begin, held, turn=walk.turn)
                if parts is None:
                    return states, LOST
                found = [parts]
            now = found[-1]
            for one in found:
                states.append(one)
                watch(len(states), len(path))
    except KeyboardInterrupt:  # the part reached is worth keeping
        return states, INTERRUPTED
    return states, "converged"


def _pressurised(problem: Problem, here: Going, held: Held) -> Going | None:
    """The muscle at its length as made and the pressure that is held at first, if one is."""
    pressure = held.get("pressure")
    if pressure is None:
        return here
    legs = [Held.of(length=here.present["length"], pressure=value) for value in (0.0, pressure)]
    found = step_to(problem, here, legs[0], legs[1])
    if found is None and (mounted := _mounted(problem, here, legs[0])) is not None:
        found = step_to(problem, mounted, legs[0], legs[1])
    return found


def _mounted(problem: Problem, here: Going, held: Held) -> Going | None:
    """The muscle at its length as made without pressure, where it leaves the cylinder as made by so much that Newton
    does not find there: a tube that is smaller than the braid pulls slack fibres in. It is sought from the state
    without friction."""
    if problem.p.friction.chamber is not None:
        return None  # without friction it is a space of other unknowns
    free = find(attrs.evolve(problem, p=problem.p._replace(friction=None)), held)
    own, which = rows_of(held.names, problem.loads)
    start = here.state._replace(u=free.u, loads=free.loads)
    to = targets_of((held,), problem.unit, problem.loads)[0]
    found = rub((problem.basis, own), problem.p, problem.b, start, here.outer, which, to, np.asarray(False))
    found = jax.tree.map(np.asarray, found)
    return _moved(problem, here, found) if free.converged and found.good else None


def _part(problem: Problem, leg: _Leg, error: np.ndarray) -> Part:
    """A step of the test with everything read off its states."""
    states = leg.states
    look = _seen(problem, states, leg.held, error) if states else None
    return Part(leg.held, leg.asked, leg.possible, look, np.array([one.iterations for one in states], int), leg.why)


def _seen(problem: Problem, states: list[Going], held: tuple[str, ...], error: np.ndarray) -> Survey:
    """A survey of the states of a path."""
    found = [one.found for one in states if one.found is not None]
    u, loads = (np.stack([getattr(one.state, name) for one in found]) for name in ("u", "loads"))
    memories = [Memories(one.state.memory, one.kept) for one in found]
    kept: Memories = jax.tree.map(lambda *rows: np.stack(rows), *memories)
    look = survey(problem, u, loads, held, kept)
    dissipated = np.array([one.dissipated for one in states])
    error = np.where(np.isnan(error), look.error, np.maximum(error, ROUNDING))
    return attrs.evolve(look, numbers=look.numbers | {"dissipated": dissipated, "error_estimate": error})
