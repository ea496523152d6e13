"""Where a symmetric state gives way to one side: the asymmetric state that it goes to, on the full length."""

import attrs

from mckibben.discretise.spectral import Line
from mckibben.results.verdict import Verdict
from mckibben.search.finer import FULL, sharpened
from mckibben.search.walk import BranchEnd, Look, branch_end, look
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import embedded, find
from mckibben.solver.held import Held
from mckibben.solver.stability import of_states, weakest

KICK = 0.1
"""Slope [rad] by which a shape is pushed to one side."""

ONWARD = (0.02, 0.1, 0.3)
"""Where beyond the end of the symmetric branch the asymmetric one is picked up, over the rest of the path."""


def tip(bench: Bench, found: Look, held: Held, tolerance: float) -> Look | None:
    """The state that an antisymmetrically unstable one goes to; None if it has no such mode."""
    tipped = None
    for size in FULL[:1] if found.verdict.verdict == Verdict.INADMISSIBLE else FULL[:2]:
        start = kicked(bench, found.state, size)
        if start is None:
            return None
        tipped = sharpened(bench, find(start.problem, held, start, radius=0.3), held, tolerance)
        if tipped.good:
            break
    return tipped


def tip_on(bench: Bench, end: BranchEnd, held: Held, tolerance: float) -> Look | None:
    """From where a symmetric branch ends, over to an asymmetric state at the target, straight or step by step.

    None where it does not end by tipping.
    """
    start = kicked(bench, end.last.state, FULL[0], soft=True) if end.last is not None and _tips(end.last) else None
    if start is None:
        return None
    straight = look(find(start.problem, held, start, radius=0.3), held)
    if straight.good:
        return sharpened(bench, straight.state, held, tolerance)
    for share in ONWARD:
        onward = branch_end(start.problem, end.held.towards(held, share), held, 1e-3, begin=start)
        if onward.complete and onward.last is not None:
            return sharpened(bench, onward.last.state, held, tolerance)
        if onward.last is not None:
            break
    return straight


def _tips(last: Look) -> bool:
    """Whether the last good state of a branch is softest to one side, and about to give way."""
    return last.modes is not None and last.stiffness == last.modes.softest_antisymmetric and last.stiffness < last.room


def kicked(bench: Bench, state: Equilibrium, size: int, soft: bool = False) -> Equilibrium | None:
    """A state pushed along its softest antisymmetric mode, as a start on `size` unknowns of the full length.

    None for shapes that have no such mode, or whose mode is stable (unless `soft`).
    """
    basis, b = state.problem.basis, state.problem.b
    if not isinstance(basis, Line) or not basis.half or bench.ends == "free":
        return None
    mode, value = weakest(of_states(state.problem, state.u[None], state.loads[None]))
    if value >= 0.0 and not soft:
        return None
    problem = bench.problem(size, b, modes="all")
    kick = problem.basis.embedded(basis.even(), mode)
    pushed = embedded(state, problem)
    return attrs.evolve(pushed, u=pushed.u + KICK * kick / problem.moved(kick))
