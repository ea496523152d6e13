"""A state on as many unknowns as the tolerance needs."""

from mckibben.discretise.spectral import Line
from mckibben.measure.survey import errors
from mckibben.results.verdict import Verdict
from mckibben.search.walk import Look, look
from mckibben.solver.bench import LADDER, Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find, refine
from mckibben.solver.held import Held

FULL = LADDER[1:]
"""Unknowns of asymmetric shapes, tried in turn."""

LOST = 48
"""Unknowns beyond which an inadmissible shape is not looked at again."""


def estimated_error(state: Equilibrium, held: Held) -> float:
    """Estimated relative error of force and length, of a state with `held` held."""
    return float(errors(state.problem, state.u[None], state.loads[None], held.names)[0])


def sharpened(bench: Bench, state: Equilibrium, held: Held, tolerance: float, again: bool = False) -> Look:
    """The same state, judged, on more unknowns until its error estimate is below the tolerance.

    Where it is lost on more unknowns it is sought there afresh with `again`; where that fails the coarser one stands.
    """
    seen = look(state, held)
    basis = state.problem.basis
    if not isinstance(basis, Line):
        return seen
    for size in LADDER if basis.half else FULL:
        if size <= basis.size:
            continue
        lost = seen.verdict.verdict in (Verdict.INADMISSIBLE, Verdict.NOT_CONVERGED)
        if (lost and size > LOST) or (seen.state.converged and estimated_error(seen.state, held) <= tolerance):
            break
        problem = bench.problem(size, state.problem.b, modes=basis.modes)
        finer = refine(seen.state, problem, held) if seen.state.converged else find(problem, held)
        if again and not finer.converged:
            finer = find(problem, held)
        if not finer.converged and seen.state.converged:
            break
        seen = look(finer, held)
    return seen
