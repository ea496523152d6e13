"""Straight to one state: the robust search, in physical terms."""

from typing import Any

import attrs
import numpy as np

from .equilibrium import Equilibrium, Held
from .problem import CLOSURE, LENGTH, VOLUME, Problem
from .trust import Solved, Task, minimise


def find(
    problem: Problem, held: Held, start: Equilibrium | None = None, radius: float = 1.0, leash: float = np.inf
) -> Equilibrium:
    """State with two quantities held, sought from `start` (same space) or from the initial cylinder.

    A search whose slopes change by more than `leash` [rad] is given up: what it would find is not near its start.
    Where length and force are both held, or volume and pressure, the state is no constrained minimum; it is found as
    the root of the one-parameter family of minima.
    """
    if set(held.names) in ({"length", "force"}, {"volume", "pressure"}):
        return _find_root(problem, held, start)
    u = np.zeros(problem.space.basis.unknowns) if start is None else start.u
    return _minimum(problem, held, u, np.zeros(4) if start is None else start.loads, radius, leash)


def _minimum(
    problem: Problem, held: Held, u: np.ndarray, guess: np.ndarray, radius: float, leash: float
) -> Equilibrium:
    targets = dict(zip(held.names, held.targets(problem), strict=True))
    loads = np.concatenate([[1.0], guess[1:]])
    for name, k in (("force", LENGTH), ("pressure", VOLUME)):
        if name in targets:
            loads[k] = targets[name]
    constraints = [(k, targets[name]) for name, k in (("length", LENGTH), ("volume", VOLUME)) if name in targets]
    if problem.space.basis.closes:
        constraints.append((CLOSURE, 0.0))
    else:
        loads[CLOSURE] = 0.0
    slope = problem.slopes[0]
    task = Task(
        evaluate=lambda u: problem.evaluate(np.asarray(u)),
        loads=loads,
        held=tuple(k for k, _ in constraints),
        targets=np.array([target for _, target in constraints]),
        metric=problem.metric(),
        largest_change=lambda du: float(np.abs(slope @ du).max()),
        admissible=inside,
        leash=leash,
    )
    return equilibrium(problem, minimise(task, u, radius))


def inside(state: Any) -> bool:
    """Whether the braid angle stays between 0 and 90 deg and every field is a number."""
    theta = np.asarray(state)[:, 0]
    return bool(np.isfinite(np.asarray(state)).all() and theta.min() > 0.0 and theta.max() < np.pi / 2)


def equilibrium(problem: Problem, solved: Solved) -> Equilibrium:
    """The search's end as a state."""
    totals = np.asarray(problem.evaluate(solved.u).totals)
    return Equilibrium(
        problem, solved.u, solved.loads, totals, solved.converged, solved.residual, solved.iterations, solved.message
    )


def _find_root(problem: Problem, held: Held, start: Equilibrium | None) -> Equilibrium:
    """Secant in the load that is sought (pressure, or force), each trial a constrained minimum."""
    length_force = "length" in held.names
    kept, wanted, free = ("length", "force", "pressure") if length_force else ("volume", "pressure", "force")

    def trial(value: float, near: Equilibrium | None) -> Equilibrium:
        return find(problem, Held.of(**{kept: held.get(kept), free: value}), near)

    unit = problem.load_unit[VOLUME if length_force else LENGTH]
    size = abs(held.get(wanted)) + abs(problem.load_unit[LENGTH if length_force else VOLUME])
    a = trial(0.0 if start is None else float(getattr(start, free)), start)
    b = trial(float(getattr(a, free)) + 0.1 * unit, a)
    count = a.iterations + b.iterations
    for _ in range(40):
        if not (a.converged and b.converged):
            break
        miss, slope = getattr(b, wanted) - held.get(wanted), getattr(b, wanted) - getattr(a, wanted)
        if abs(miss) < 1e-11 * size or slope == 0.0:
            break
        step = -miss * (getattr(b, free) - getattr(a, free)) / slope
        a, b = b, trial(getattr(b, free) + step, b)
        count += b.iterations
    miss = abs(getattr(b, wanted) - held.get(wanted)) / size
    if b.converged and miss < 1e-9:
        return attrs.evolve(b, iterations=count)
    advice = f"no {free} was found at which the {wanted} is as asked at this {kept}"
    return attrs.evolve(b, iterations=count, converged=False, residual=max(miss, b.residual), message=advice)


def refine(coarse: Equilibrium, problem: Problem, held: Held) -> Equilibrium:
    """The same state on a larger space of the same kind and placement."""
    fine = find(problem, held, embedded(coarse, problem), radius=0.1)
    return attrs.evolve(fine, iterations=fine.iterations + coarse.iterations)


def embedded(coarse: Equilibrium, problem: Problem) -> Equilibrium:
    """A state as a start on a larger (or smaller) space of the same kind and placement: the series are nested."""
    size = min(coarse.problem.space.basis.size, problem.space.basis.size)
    u = np.zeros(problem.space.basis.unknowns)
    u[:size] = coarse.u[:size]
    if problem.space.basis.unknowns > problem.space.basis.size:
        u[-1] = coarse.u[-1]
    return attrs.evolve(coarse, problem=problem, u=u)
