"""A state on as many unknowns as the tolerance needs."""

from .branch import Look, look
from .discretise.line import Line
from .experiment import Bench
from .recover import recover
from .solver.direct import find, refine
from .solver.equilibrium import Equilibrium, Held
from .survey import error_estimate
from .verdict import Verdict

HALF, FULL = (24, 48, 96, 192), (48, 96, 192)
"""Unknowns of symmetric and of other shapes, tried in turn; the largest serve the few states that need them."""

LOST = 48
"""Unknowns on which a shape that is inadmissible is inadmissible enough."""


def error_of(state: Equilibrium) -> float:
    """Estimated relative error of force and length."""
    return float(error_estimate(recover(state.problem, state.u[None], state.loads[None]))[0])


def sharpened(bench: Bench, state: Equilibrium, held: Held, tolerance: float, again: bool = False) -> Look:
    """The same state, judged, on more unknowns until its error estimate is below the tolerance.

    Where it is lost on more unknowns it is sought there afresh with `again`; where that fails the coarser one stands.
    """
    seen = look(state, held)
    basis = state.problem.space.basis
    if not isinstance(basis, Line):
        return seen
    for size in HALF if basis.half else FULL:
        if size <= basis.size:
            continue
        lost = seen.verdict.verdict in (Verdict.INADMISSIBLE, Verdict.NOT_CONVERGED)
        if (lost and size > LOST) or (seen.state.converged and error_of(seen.state) <= tolerance):
            break
        problem = bench.problem(size, state.problem.b, modes=basis.modes)
        finer = refine(seen.state, problem, held) if seen.state.converged else find(problem, held)
        if again and not finer.converged:
            finer = find(problem, held)
        if not finer.converged and seen.state.converged:
            break
        seen = look(finer, held)
    return seen
