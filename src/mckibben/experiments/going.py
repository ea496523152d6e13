"""Along a path of a muscle whose crossings rub: from a state and what its points remember to the next ones."""

from collections.abc import Sequence

import attrs
import jax
import numpy as np

from mckibben.measure.rub import Stepped, fresh, rub, rub_along
from mckibben.model.friction import Remembered
from mckibben.solver.find import find
from mckibben.solver.held import Held, rows_of, targets_of
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns

__all__ = ["LARGEST_TURN", "Going", "Walk", "mounted", "step_to", "steps_along"]

LARGEST_TURN = 0.05
"""Largest turn of a crossing [rad] in one step of the path; a longer way is taken in parts."""
SMALLEST = 1.0 / 1024.0
"""Smallest part of the way from state to state."""
SHORTER = 0.9
"""Share of the largest turn that is aimed at where a way is taken in parts: crossings do not turn evenly along it."""
AT_ONCE = 32
"""States that are walked in compiled code before they are looked at."""


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
    problem: Problem, here: Going, begin: Held, end: Held, shares: tuple[float, ...] = (), turn: float | None = None,
    farthest: float = LARGEST_TURN,
) -> Going | None:  # fmt: skip
    """From a state at which `begin` holds, straight to `end`; in parts where crossings turn far or Newton fails.

    `shares` are those of a way of a muscle that is near: with the same parts, results change smoothly from muscle to
    muscle. `turn` is that of a crossing where the way was tried in one step, infinite where no state was found. No part
    turns one by more than `farthest`.
    """
    now, share, left = here, 0.0, list(shares)
    taken: list[float] = []
    parts = 1 if turn is None else _parts(1.0, 1.0, turn, farthest)
    while share < 1.0:
        ways = left or [*np.linspace(share, 1.0, parts + 1)[1:-1].tolist(), 1.0]
        if ways[0] - share < SMALLEST:
            return None
        aims = [end if to >= 1.0 else begin.towards(end, to) for to in ways]
        at, most = begin if share == 0.0 else begin.towards(end, share), 2.0 * farthest if left else farthest
        walk = steps_along(problem, now, at, aims, most)
        for one, to in zip(walk.states, ways, strict=False):
            now, share = attrs.evolve(one, iterations=one.iterations + (now.iterations if taken else 0)), to
            taken.append(to)
        done, left = len(walk.states), left[len(walk.states) :]
        if walk.turn is not None:
            parts, left = _parts(1.0 - share, ways[done] - share, walk.turn, farthest), []
        elif not left:
            parts = max(parts - done, 1)
    return attrs.evolve(now, shares=tuple(taken))


def _parts(way: float, tried: float, turn: float, farthest: float) -> int:
    """In how many parts a way is taken of which one was too long: by how far a crossing turned, or half as long."""
    shorter = SHORTER * farthest / turn if np.isfinite(turn) else 0.5
    return int(np.ceil(way / (tried * shorter) - 1e-9))


@attrs.frozen
class Walk:
    """States in one step each, and why there are no more."""

    states: list[Going]
    turn: float | None  #: by how much crossings turned in a step that was too long, or infinity; None where all is done


def steps_along(
    problem: Problem, here: Going, begin: Held, path: Sequence[Held], farthest: float = LARGEST_TURN
) -> Walk:
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
            return Walk(states, turn)
        one: Stepped = jax.tree.map(lambda row, k=k: row[k], rows)
        now = _moved(problem, attrs.evolve(now, iterations=0), one)
        states.append(now)
    return Walk(states, None)


def _moved(problem: Problem, now: Going, found: Stepped) -> Going:
    """Where a path has come with one more state."""
    unit = problem.load_unit
    read = (*found.totals, found.state.loads[0] * unit[1], found.state.loads[1] * unit[2])
    return Going(
        found.state._replace(memory=found.next_inner), found.next_outer,
        dict(zip(("length", "volume", "force", "pressure"), map(float, read), strict=True)),
        now.dissipated + float(found.dissipated), now.iterations + int(found.iterations), found,
    )  # fmt: skip


def mounted(problem: Problem, here: Going, held: Held, farthest: float = np.inf) -> Going | None:
    """The muscle as it is mounted, in one step from as made, in which no crossing turns by more than `farthest`.

    Where it leaves the cylinder as made by so much that Newton does not find there (a tube that is smaller than the
    braid pulls slack fibres in), it is sought from the state without friction.
    """
    basis = attrs.evolve(problem.basis, slide=False)  # type: ignore[arg-type, unused-ignore]
    free = find(Problem.of(basis, problem.p._replace(friction=None), problem.b), held)
    own, which = rows_of(held.names, problem.loads)
    start = here.state._replace(u=problem.basis.embedded(basis, free.u), loads=free.loads)
    to = targets_of((held,), problem.unit, problem.loads)[0]
    found = rub((problem.basis, own), problem.p, problem.b, start, here.outer, which, to, np.asarray(False))
    found = jax.tree.map(np.asarray, found)
    near = free.converged and found.good and found.largest_turn <= farthest
    return _moved(problem, here, found) if near else None
