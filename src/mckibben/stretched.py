"""Near full extension, where the length hardly changes and the force is the better unknown."""

import attrs
import numpy as np

from .experiment import Bench
from .solver.direct import find
from .solver.equilibrium import Equilibrium, Held

NEAR, EASY = 0.98, 0.97
"""Fraction of full extension beyond which the force is sought, and where the search sets out."""

CLOSE, TRIALS = 1e-10, 60
"""Relative miss of the gap to full extension at which the force is found, and the most trials."""


def near_extension(bench: Bench, held: Held) -> bool:
    """Whether a target is a length close to full extension, at a pressure."""
    return "pressure" in held.names and held.get("length", 0.0) >= NEAR * bench.longest


def stretched(bench: Bench, failed: Equilibrium, held: Held) -> Equilibrium:
    """Secant in log F against log(h_max - h), every trial at held force; `failed` where that fails too.

    Points are crowded anew for the force that is found: the end layers are far thinner than at rest.
    """
    size, state = failed.problem.space.basis.size, failed
    b, force = failed.problem.b, None
    for _ in range(2):
        found = _by_force(bench, size, b, held, force)
        if found is None:
            return state
        state, force = found, found.force
        b = bench.placement(Held.of(force=force, pressure=held.get("pressure")))
        if b <= state.problem.b:
            break
    return state


def _by_force(bench: Bench, size: int, b: float, held: Held, force: float | None) -> Equilibrium | None:
    problem, length, pressure = bench.problem(size, b), held.get("length"), held.get("pressure")
    gap = np.log(bench.longest - length)
    state = find(problem, Held.of(length=EASY * bench.longest, pressure=pressure))
    if not state.converged or state.force <= 0.0:
        return None
    points = [(np.log(state.force), np.log(bench.longest - state.length))]
    guess, count = points[0][0] + 1.0 if force is None else float(np.log(force)), state.iterations
    for _ in range(TRIALS):
        state = find(problem, Held.of(force=float(np.exp(guess)), pressure=pressure), state)
        count += state.iterations
        if not state.converged or state.length >= bench.longest:
            return None
        points.append((guess, np.log(bench.longest - state.length)))
        (x0, y0), (x1, y1) = points[-2:]
        if abs(y1 - gap) < CLOSE or y1 == y0:
            return attrs.evolve(state, iterations=count) if abs(y1 - gap) < 1e-6 else None
        guess = x1 + float(np.clip((gap - y1) * (x1 - x0) / (y1 - y0), -2.0, 2.0))
    return None
