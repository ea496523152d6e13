"""Where a path of states ends, and why: stability lost, the wall behind its fitting, or contact with itself."""

import attrs
import numpy as np

from .judge import Judgement, clearance, judge, shape_of
from .solver.direct import find
from .solver.equilibrium import Equilibrium, Held
from .solver.problem import Problem
from .solver.stability import count_modes, stiffness
from .survey import meridian
from .verdict import Modes, Shape, Verdict

STEPS, JUMP = 16, 0.6
"""Steps from one end of a path to the other at first, and the change of psi [rad] that a step may make."""


@attrs.frozen
class Look:
    """A state and what it is worth."""

    state: Equilibrium
    verdict: Judgement
    modes: Modes | None
    stiffness: float  #: least stiffness under the control, over the largest; zero at a limit of stability
    room: float  #: room before the shape becomes inadmissible, over the end radius

    @property
    def good(self) -> bool:
        """Stable, and of a shape that the model can mean."""
        return self.verdict.verdict == Verdict.STABLE


def look(state: Equilibrium, held: Held) -> Look:
    """Judge one state."""
    if not state.converged:
        return Look(state, Judgement.lost(state.message), None, np.nan, np.nan)
    problem = state.problem
    K = stiffness(problem.space, problem.p, problem.b, state.u[None], state.loads[None])
    modes = count_modes(problem.space, K, pressure_held="volume" not in held.names)[0]
    psi, r, z = (line[0] for line in meridian(problem, state.u[None]))
    length_held = "length" in held.names
    verdict = judge(modes, shape_of(psi, r, z), length_held)
    return Look(state, verdict, modes, modes.softest(length_held), clearance(psi, z, float(r[0])))


@attrs.frozen
class BranchEnd:
    """The last good state on a path, how far along it lies (0 to 1), and what ended the path."""

    last: Look | None
    held: Held
    fraction: float
    cause: Judgement

    @property
    def complete(self) -> bool:
        """Whether the path was good to its end."""
        return self.fraction == 1.0


class _Walk:
    """Trials along the straight path between two holdings, each started from a state already known."""

    def __init__(self, problem: Problem, start: Held, target: Held, shapes: bool) -> None:
        self.problem, self.start, self.target, self.shapes = problem, start, target, shapes

    def at(self, fraction: float) -> Held:
        a, b = np.asarray(self.start.values), np.asarray(self.target.values)
        first, second = (a + fraction * (b - a)).tolist()
        return Held(self.start.names, (first, second))

    def trial(self, fraction: float, near: Look | None) -> Look:
        held = self.at(fraction)
        return look(
            find(self.problem, held, None if near is None else near.state, radius=1.0 if near is None else 0.3), held
        )

    def good(self, seen: Look) -> bool:
        return seen.good if self.shapes else seen.stiffness > 0.0

    def margin(self, seen: Look) -> float:
        return min(seen.stiffness, seen.room) if self.shapes else seen.stiffness

    def moved(self, a: Look, b: Look) -> float:
        return float(np.abs(self.problem.slopes[0] @ (a.state.u - b.state.u)).max())


def branch_end(problem: Problem, start: Held, target: Held, tolerance: float = 1e-9, shapes: bool = True) -> BranchEnd:
    """Follow good states from `start` to `target` (both hold the same two names) as far as they go.

    The end is found to `tolerance` of the path. Without `shapes` only stability counts, not where the wall lies.
    """
    walk = _Walk(problem, start, target, shapes)
    here, done = walk.trial(0.0, None), 0.0
    if not walk.good(here):
        return BranchEnd(None, start, 0.0, here.verdict)
    step, cause, first = 1.0 / STEPS, here.verdict, here
    while done < 1.0:
        fraction = min(1.0, done + step)
        seen = walk.trial(fraction, here)
        near = walk.moved(seen, here) < JUMP
        if near and walk.good(seen):
            here, done, step = seen, fraction, min(2.0 * step, 1.0 / STEPS)
            continue
        cause = cause if walk.good(seen) else seen.verdict
        if near and walk.margin(seen) < 0.0:
            return _root(walk, here, done, seen, fraction, tolerance)
        step *= 0.5
        if step < tolerance:
            return BranchEnd(here, walk.at(done), done, _turned(walk, here, first, cause))
    return BranchEnd(here, target, 1.0, here.verdict)


def _turned(walk: _Walk, here: Look, first: Look, cause: Judgement) -> Judgement:
    """What ended a path with nothing near beyond its last state: a branch that turns back, if it has gone soft."""
    if here.stiffness > 1e-2 * first.stiffness:
        return cause
    control = "length" if "length" in walk.start.names else "force"
    return Judgement(
        Verdict.UNSTABLE, f"the shape gives way under {control} control: the branch turns back", here.verdict.shape
    )


def _root(walk: _Walk, here: Look, done: float, bad: Look, beyond: float, tolerance: float) -> BranchEnd:
    """The end between a good state and a bad one on the same branch: the root of the margin, kept on the good side."""
    seen = {done: here, beyond: bad}

    def margin(fraction: float) -> float:
        if fraction not in seen:
            seen[fraction] = walk.trial(fraction, here)
        return walk.margin(seen[fraction])

    from scipy.optimize import brentq  # here, because few searches need what takes a third of a second to import

    brentq(margin, done, beyond, xtol=tolerance, rtol=1e-14)
    good = max(fraction for fraction, one in seen.items() if walk.good(one))
    cause = seen[min(fraction for fraction in seen if fraction > good)]
    verdict = cause.verdict
    if not walk.shapes and cause.modes is not None:
        verdict = judge(cause.modes, Shape.ORDINARY, "length" in walk.start.names)
    return BranchEnd(seen[good], walk.at(good), good, verdict)
