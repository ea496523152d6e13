"""Straight to one state: the robust search, in physical terms."""

from functools import partial
from typing import Any

import attrs
import numpy as np

from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.follow import follow_to
from mckibben.solver.held import ROWS, Held, targets_of
from mckibben.solver.problem import CLOSURE, LENGTH, VOLUME, Problem
from mckibben.solver.trust_region import Minimum, Task, imbalance, minimise

__all__ = ["along", "at_rest", "embedded", "equilibrium", "find", "looked_at", "refine"]

LEGS = 31
"""States on the way to what is held, where that is no minimum: with the first one a length that is compiled anyway."""


def find(
    problem: Problem, held: Held, start: Equilibrium | None = None, radius: float = 1.0, leash: float = np.inf
) -> Equilibrium:
    """State with two things held, sought from `start` (same space) or from the initial cylinder.

    A search whose slopes change by more than `leash` [rad] is given up: what it would find is not near its start.
    A state that is no minimum of the energy under what is held (length and force, volume and pressure, gas, a spring)
    is reached along the straight way there from the start; so is one without a pressure held of a chamber that may
    leave the braid, whose energy depends on it.
    """
    if not held.is_minimum or (problem.leaves and "pressure" not in held.names):
        return along(problem, held, start)
    u = np.zeros(problem.basis.unknowns) if start is None else start.u
    loads = np.zeros(problem.loads) if start is None else start.loads
    return _minimum(problem, held, u, loads, radius, leash)


def _minimum(
    problem: Problem, held: Held, u: np.ndarray, guess: np.ndarray, radius: float, leash: float
) -> Equilibrium:
    loads = np.concatenate([[1.0], guess, np.zeros(3 - len(guess))])
    targets = dict(zip(held.names, targets_of((held,), problem.unit, 2)[0], strict=True))
    for name, k in (("force", LENGTH), ("pressure", VOLUME)):
        if name in targets:
            loads[k] = targets[name]
    constraints = [(k, targets[name]) for name, k in (("length", LENGTH), ("volume", VOLUME)) if name in targets]
    if problem.basis.closes:
        constraints.append((CLOSURE, 0.0))
    task = Task(
        evaluate=partial(problem.balance, pressure=float(loads[VOLUME])),
        curvature=problem.curvature,
        loads=loads,
        held=tuple(k for k, _ in constraints),
        targets=np.array([target for _, target in constraints]),
        metric=problem.setting.metric,
        largest_change=problem.moved,
        admissible=inside,
        leash=leash,
    )
    return _as_equilibrium(problem, minimise(task, u, radius))


def inside(theta: Any) -> bool:
    """Whether the braid angle is a number between 0 and 90 deg everywhere."""
    return bool(np.isfinite(theta).all() and theta.min() > 0.0 and theta.max() < np.pi / 2)


def _as_equilibrium(problem: Problem, solved: Minimum) -> Equilibrium:
    return Equilibrium(
        problem,
        solved.u,
        solved.loads[1 : 1 + problem.loads],
        np.asarray(solved.totals),
        solved.converged,
        solved.residual,
        solved.iterations,
        solved.message,
    )


def equilibrium(problem: Problem, u: np.ndarray, loads: np.ndarray, iterations: int = 0) -> Equilibrium:
    """A state from its unknowns and loads, with the residual that it really has."""
    return looked_at(problem, u, loads, iterations)[0]


def looked_at(problem: Problem, u: np.ndarray, loads: np.ndarray, iterations: int = 0) -> tuple[Equilibrium, Any]:
    """A state, and its braid angles."""
    a = problem.balance(u, float(loads[1]))
    signs = np.concatenate([[1.0], -loads, np.zeros(3 - len(loads))])
    residual = imbalance(signs, a.gradients)
    return Equilibrium(problem, u, loads, a.totals, residual < 1e-8, residual, iterations), a.theta


def at_rest(problem: Problem) -> Equilibrium:
    """The undeformed muscle without loads, whose length and volume are the units.

    Where the fittings have a radius of their own, the cylinder of that of the first one: with the loads that hold it,
    which no others do on clamped ends of one radius, and nearly so on others.
    """
    nothing = np.zeros(problem.basis.unknowns), np.zeros(problem.loads)
    if problem.p.end_radii is not None:
        cylinder = problem.balance(nothing[0])
        held = [LENGTH, *([CLOSURE] if problem.basis.closes else [])]
        loads = np.linalg.lstsq(cylinder.gradients[held].T, cylinder.gradients[0], rcond=None)[0]
        loads = np.insert(loads, 1, 0.0)
        return Equilibrium(problem, nothing[0], loads, cylinder.totals, True, 0.0, 0)
    totals = problem.balance(nothing[0]).totals if problem.leaves else np.array([0.0, 1.0, 1.0, 0.0])
    return Equilibrium(problem, *nothing, totals, True, 0.0, 0)


def along(
    problem: Problem, held: Held, start: Equilibrium | None = None, legs: int = LEGS, tolerance: float = 1e-7
) -> Equilibrium:
    """From what is held at the start, or at rest, on the straight way, to the target; quick where nothing is in it.

    From rest the last end gets its radius on the way, where it has another than the first.
    """
    here = at_rest(problem) if start is None else start
    if start is None and problem.p.end_radii is not None and problem.basis.closes:
        held = Held((*held.names, "closure"), (*held.values, 0.0))
    first = attrs.evolve(held, values=readings(here, held.names))
    path = [first.towards(held, k / legs) for k in range(legs + 1)]
    states = follow_to(problem, path, here, tolerance)
    if len(states) == len(path):
        last = states[-1]
        found, theta = looked_at(problem, last.u, last.loads, sum(one.iterations for one in states[1:]))
        if found.converged and inside(theta):
            return found
    names = " and ".join(str(name) for name in held.names if name != "closure")
    advice = f"no state with this {names} was found on the straight way from the start"
    return attrs.evolve(here, converged=False, residual=np.inf, message=advice)


def readings(state: Equilibrium, names: tuple[Any, ...]) -> tuple[float, ...]:
    """The targets at which rows hold at a state; a row is linear in its target."""
    rows = [name if callable(name) else ROWS[name] for name in names]
    found = [(float(row(state.now, 0.0)), float(row(state.now, 1.0))) for row in rows]
    return tuple(at_zero / (at_zero - at_one) for at_zero, at_one in found)


def refine(coarse: Equilibrium, problem: Problem, held: Held) -> Equilibrium:
    """The same state on a larger space of the same kind and placement."""
    fine = find(problem, held, embedded(coarse, problem), radius=0.1)
    return attrs.evolve(fine, iterations=fine.iterations + coarse.iterations)


def embedded(coarse: Equilibrium, problem: Problem) -> Equilibrium:
    """A state as a start on another space of the same placement: the series are nested."""
    loads = np.zeros(problem.loads)
    shared = min(len(loads), len(coarse.loads))
    loads[:shared] = coarse.loads[:shared]
    return attrs.evolve(coarse, problem=problem, u=problem.basis.embedded(coarse.problem.basis, coarse.u), loads=loads)
