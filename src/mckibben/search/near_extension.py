"""Near full extension, where the length hardly changes and the force is the better unknown."""

import attrs
import numpy as np

from mckibben.search.finer import estimated_error
from mckibben.solver.bench import LADDER, Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held

NEAR = 0.98
"""Share of full extension beyond which the force is sought."""
EASY = 0.97
"""Share of full extension where that search sets out."""
ROUGH = 0.1
"""Relative miss of the gap to full extension below which points stay where they are."""
CLOSE = 1e-10
"""Relative miss at which the search ends."""
GOOD = 1e-7
"""Relative miss that the state may have where rounding ends the search."""
TRIALS = 60
"""Most trials of the secant; a dozen is usual."""


def near_extension(bench: Bench, held: Held) -> bool:
    """Whether a target is a length close to full extension, at a pressure."""
    return "pressure" in held.names and held.get("length", 0.0) >= NEAR * bench.longest


def stretched(bench: Bench, failed: Equilibrium, held: Held, tolerance: float) -> Equilibrium:
    """The state at a length where the direct search failed, on as many unknowns as the tolerance needs.

    `failed` comes back where this fails too.
    """
    state = failed
    for size in LADDER:
        finer = _by_force(bench, size, failed, held)
        if finer is None:
            break
        state = finer
        if estimated_error(state, held) <= tolerance:
            break
    return state


def _by_force(bench: Bench, size: int, failed: Equilibrium, held: Held) -> Equilibrium | None:
    """Secant in log F against log(h_max - h), every trial at held force; None where it fails.

    Points are crowded for the force of each trial: the end layers get far thinner than the length lets foresee.
    """
    length, pressure = held.get("length"), held.get("pressure")
    gap = np.log(bench.longest - length)
    state = find(failed.problem, Held.of(length=EASY * bench.longest, pressure=pressure))
    if not state.converged or state.force <= 0.0:
        return None
    points = [(float(np.log(state.force)), float(np.log(bench.longest - state.length)))]
    guess, count = points[0][0] + 1.0, state.iterations
    for _ in range(TRIALS):
        trial = Held.of(force=float(np.exp(guess)), pressure=pressure)
        if abs(points[-1][1] - gap) > ROUGH:
            state = find(bench.problem(size, bench.placement(trial)), trial)
        else:
            state = find(state.problem, trial, state)
        count += state.iterations
        if not state.converged or state.length >= bench.longest:
            return None
        points.append((guess, float(np.log(bench.longest - state.length))))
        (x0, y0), (x1, y1) = points[-2:]
        if abs(y1 - gap) < CLOSE or y1 == y0:
            break
        guess = x1 + float(np.clip((gap - y1) * (x1 - x0) / (y1 - y0), -2.0, 2.0))
    return attrs.evolve(state, iterations=count) if abs(points[-1][1] - gap) < GOOD else None
