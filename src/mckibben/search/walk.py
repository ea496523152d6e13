"""Where a path of states ends, and why: stability lost, the wall behind its fitting, contact with itself, no bore."""

import math

import attrs
import numpy as np

from mckibben.measure.bore import narrowest_bore
from mckibben.measure.judge import Judgement, clearance, judge, shape_of
from mckibben.measure.meridian import meridian
from mckibben.model.extension import longest_of
from mckibben.model.parameters import Parameters
from mckibben.model.profile import fibre_length
from mckibben.results.verdict import Modes, Shape, Verdict
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import embedded, find
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem
from mckibben.solver.stability import count_modes, of_states

FAR = 1.5
"""Length of a muscle over that of a fibre as made beyond which no force is looked for."""
STEPS = 16
"""Steps from one end of a path to the other at first."""
JUMP = 0.6
"""Change of psi [rad] that a step may make and be trusted to stay on the branch."""

CLOSED = 0.05
"""Bore over the outer face at the end of a path, below which that is where it closes: it does so as a square root."""
FULL = "the bore of the tube closes, and the rubber lets the braid narrow no further"

FOLD = 1e-4
"""How far before a maximum of the force its last good state lies, over the path: at the maximum itself the length is
no function of the force."""

BACK = (1e-4, 1e-3, 1e-2, 1e-1)
"""How far before an end found on fewer unknowns a walk on more sets in, over the path; tried in turn."""


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
    return _look(state, "volume" not in held.names, "length" in held.names)


def _look(state: Equilibrium, pressure_held: bool, length_held: bool) -> Look:
    if not state.converged:
        return Look(state, Judgement.lost(state.message), None, np.nan, np.nan)
    problem = state.problem
    modes = count_modes(problem, of_states(problem, state.u[None], state.loads[None]), pressure_held=pressure_held)[0]
    psi, r, z = (line[0] for line in meridian(problem, state.u[None]))
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


@attrs.frozen
class _Walk:
    """Trials along the straight path between two holdings, each started from a state already known.

    With a force sought, the path is one of lengths, which has no fold where the force is greatest; its states are
    judged as if the force were held.
    """

    problem: Problem
    start: Held
    target: Held
    shapes: bool
    force: float | None = None

    def at(self, fraction: float) -> Held:
        return self.start.towards(self.target, fraction)

    def trial(self, fraction: float, near: Equilibrium | None, leash: float = 2.0 * JUMP) -> Look:
        radius, leash = (1.0, np.inf) if near is None else (0.3, leash)
        return self.look(find(self.problem, self.at(fraction), near, radius, leash))

    def look(self, state: Equilibrium) -> Look:
        return _look(state, "volume" not in self.start.names, self.force is None and "length" in self.start.names)

    def good(self, seen: Look) -> bool:
        return seen.good if self.shapes else seen.stiffness > 0.0

    def margin(self, seen: Look) -> float:
        return min(seen.stiffness, seen.room) if self.shapes else seen.stiffness

    def moved(self, a: Look, b: Look) -> float:
        return self.problem.moved(a.state.u - b.state.u)

    def past(self, seen: Look) -> bool:
        """Whether a state lies beyond the force that is sought."""
        if self.force is None:
            return False
        shortens = self.target.get("length") < self.start.get("length")
        return seen.state.force <= self.force if shortens else seen.state.force >= self.force

    def end(self, last: Look, fraction: float, cause: Judgement) -> BranchEnd:
        """The end, said in what the path was asked for."""
        held = self.at(fraction)
        if self.force is not None:
            held = Held.of(force=last.state.force, pressure=last.state.pressure)
        return BranchEnd(last, held, fraction, cause)

    def arrived(self, near: Look) -> Look:
        """The state at the force that is sought, from one just beyond it."""
        held = Held.of(force=self.force, pressure=self.target.get("pressure"))
        return self.look(find(self.problem, held, near.state, 0.3, JUMP))


def branch_end(
    problem: Problem,
    start: Held,
    target: Held,
    tolerance: float = 1e-9,
    shapes: bool = True,
    *,
    coarse: BranchEnd | None = None,
    begin: Equilibrium | None = None,
) -> BranchEnd:
    """Follow good states from `start` to `target` (both hold the same two names) as far as they go.

    The end is found to `tolerance` of the path. Without `shapes` only stability counts, not where the wall lies. With
    the end of the same path on fewer unknowns, `coarse`, the walk sets in shortly before it. `begin` is a state near
    the start; the initial cylinder serves otherwise.
    """
    walk = _Walk(problem, start, target, shapes)
    first = walk.look(find(problem, start) if begin is None else find(problem, start, begin, 0.3, 2.0 * JUMP))
    if not walk.good(first):
        return BranchEnd(None, start, 0.0, first.verdict)
    if start.names == ("force", "pressure") and start.get("pressure") == target.get("pressure"):
        walk = _by_length(walk, first.state)
    here, done, step = first, 0.0, 1.0 / STEPS
    if coarse is not None and coarse.last is not None:
        near = embedded(coarse.last.state, problem)
        for back in BACK:
            seen = walk.trial(max(coarse.fraction - back, 0.0), near)
            if walk.good(seen) and not walk.past(seen):
                here, done, step = seen, max(coarse.fraction - back, 0.0), back
                break
    return _advance(walk, first, here, done, step, tolerance, target)


def _fibre(p: Parameters) -> float:
    """Length of a fibre as made [m]."""
    return float(p.H0) / math.sin(float(p.theta0)) if p.profile is None else float(fibre_length(p))


def _by_length(walk: _Walk, first: Equilibrium) -> _Walk:
    """The walk to a force as one to a length: stable under force control, a muscle is shorter the more it is pushed."""
    p, force = walk.problem.p, walk.target.get("force")
    dead, H0 = float(p.rest - p.H0), float(p.H0)
    longest = min(longest_of(p, walk.problem.basis.ends), FAR * _fibre(p) + dead)
    far = 0.1 * H0 + dead if force < first.force else first.length + (1.0 - 1e-6) * (longest - first.length)
    pressure = walk.target.get("pressure")
    lengths = [Held.of(length=length, pressure=pressure) for length in (first.length, far)]
    return attrs.evolve(walk, start=lengths[0], target=lengths[1], force=force)


def _advance(
    walk: _Walk, first: Look, here: Look, done: float, step: float, tolerance: float, target: Held
) -> BranchEnd:
    """On from a good state, as far as good states go."""
    while done < 1.0:
        fraction = min(1.0, done + step)
        seen = walk.trial(fraction, here.state)
        near = seen.state.converged and walk.moved(seen, here) < JUMP
        if near and walk.good(seen) and not walk.past(seen):
            here, done, step = seen, fraction, min(2.0 * step, 1.0 / STEPS)
            continue
        if near and walk.margin(seen) < 0.0:
            end = _root(walk, here, done, seen, fraction, tolerance)
            if end.last is None or not walk.past(end.last):
                return end
            seen = end.last
        if near and walk.past(seen):
            arrived = walk.arrived(seen)
            if walk.good(arrived):
                return BranchEnd(arrived, target, 1.0, arrived.verdict)
        step *= 0.5
        if step < tolerance:
            return walk.end(here, done, _beyond(walk, first, here, done))
    if walk.force is not None:  # every length was good, and the force was at none of them
        return walk.end(here, float(np.nextafter(1.0, 0.0)), _beyond(walk, first, here, done))
    return BranchEnd(here, target, 1.0, here.verdict)


def _beyond(walk: _Walk, first: Look, here: Look, done: float) -> Judgement:
    """What ended a path with nothing near beyond its last state.

    A tube without a bore lets the braid narrow no further; a branch that has gone soft turns back; otherwise the
    verdict on what the search finds a little further on.
    """
    state = here.state
    if narrowest_bore(walk.problem, state.u, state.loads) < CLOSED:
        return Judgement(Verdict.INADMISSIBLE, FULL, here.verdict.shape)
    if here.stiffness > 1e-2 * first.stiffness:
        seen = walk.trial(min(1.0, done + 1e-2 / STEPS), here.state, np.inf)
        if not walk.good(seen):
            return seen.verdict
    control = "force" if walk.force is not None or "length" not in walk.start.names else "length"
    return Judgement(
        Verdict.UNSTABLE, f"the shape gives way under {control} control: the branch turns back", here.verdict.shape
    )


def _root(walk: _Walk, here: Look, done: float, bad: Look, beyond: float, tolerance: float) -> BranchEnd:
    """The end between a good state and a bad one on the same branch: the root of the margin, kept on the good side."""
    seen = {done: here, beyond: bad}

    def margin(fraction: float) -> float:
        if fraction not in seen:
            seen[fraction] = walk.trial(fraction, here.state)
        if not seen[fraction].state.converged:  # too far from there: on from the nearest one that is known
            known = [one for one in seen if seen[one].state.converged]
            seen[fraction] = walk.trial(fraction, seen[min(known, key=lambda one: abs(one - fraction))].state)
        found = walk.margin(seen[fraction])
        return found if np.isfinite(found) else walk.margin(bad)  # what is not found is not good

    from scipy.optimize import brentq  # here, because few searches need what takes a third of a second to import

    brentq(margin, done, beyond, xtol=tolerance, rtol=1e-14)
    good = max(fraction for fraction, one in seen.items() if walk.good(one))
    cause = seen[min(fraction for fraction in seen if fraction > good)]
    verdict = cause.verdict
    if not walk.shapes and cause.modes is not None:
        verdict = judge(cause.modes, Shape.ORDINARY, walk.force is None and "length" in walk.start.names)
    if walk.force is not None and cause.modes is not None and cause.modes.force_control:
        before = max(done, good - FOLD)
        margin(before)
        good = before if walk.good(seen[before]) else good
    return walk.end(seen[good], good, verdict)
