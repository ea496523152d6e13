"""`run()`: a test as a lab runs it, on a muscle."""

import warnings
from collections.abc import Callable

import numpy as np

from mckibben.discretise.placement import crowding
from mckibben.experiments.again import sought_again
from mckibben.experiments.rubbing import rubbed
from mckibben.measure import survey as surveying
from mckibben.measure.caution import MuscleWarning, thick_wall
from mckibben.measure.report import Part, report
from mckibben.measure.survey import survey
from mckibben.model.parameters import Parameters
from mckibben.results.result import Result
from mckibben.solver import follow
from mckibben.solver.arclength import branch
from mckibben.solver.bench import NEARLY, Bench, sizes_for
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import at_rest, find, readings
from mckibben.solver.held import NAMES, Held
from mckibben.solver.path import INTERRUPTED, LOOSE, Trace, Watch, trace
from mckibben.solver.problem import Basis, Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Along, Muscle, SpecError, Step, Test

__all__ = ["MuscleWarning", "corners", "crowding_for", "run", "solved"]


def run(
    muscle: Muscle,
    test: Test,
    *,
    tolerance: float = 1e-6,
    discretisation: str = "spectral",
    watch: Watch | None = None,
) -> Result:
    """Run a test on a muscle: every state of it, in order, with forces, shapes, stability and error estimates.

    Each state minimises the paper's potential energy (Eq. 28) with the quantities of the test held; docs/theory.md has
    the equations.

    Args:
        muscle: the specification.
        test: `Isometric`, `Isobaric`, `Isotonic`, `BlockedForce`, `FreeContraction`, `Step` or `Protocol`.
        tolerance: relative error aimed at in force and length; each state reports its estimate.
        discretisation: "spectral" (default) or "paper" (43 cubic B-splines in theta, for comparison).
        watch: called with (states done, states in all).

    Returns:
        A `Result`. States that were not reached hold NaN and say why in `verdict` and `reason`. Ctrl-C ends the test:
        the part reached comes back, with `status` "interrupted".

    Raises:
        SpecError: for a tolerance or discretisation out of range; never for a test that cannot be finished.

    >>> test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    >>> curve = mk.run(mk.presets.paper(), test)
    >>> curve.force.round(2)  # N, one per state
    array([  3.29,  52.36, 101.22])
    """
    bench = Bench.of(muscle)
    steps, tell = test.as_steps(muscle), watch or (lambda k, n: None)
    b = crowding_for(bench, steps)
    if muscle.friction is not None:
        if discretisation != "spectral":
            raise SpecError("discretisation", discretisation, "is the paper's own mesh, whose crossings turn freely")
        parts = rubbed(bench, steps, b, tolerance, tell)
    else:
        parts = solved(bench, steps, b, tolerance, discretisation, tell)
    if discretisation == "spectral" and muscle.friction is None:
        for k, part in enumerate(parts):
            if not any(one.why == INTERRUPTED for one in parts):
                parts[k] = sought_again(bench, part, b, tolerance, tell)
    result, notes = report(muscle, test, parts, float(bench.p.H0), thick_wall(muscle))
    for note in notes:
        warnings.warn(note, MuscleWarning, stacklevel=2)
    return result


@one_thread()
def solved(
    bench: Bench,
    steps: tuple[Step, ...],
    b: float,
    tolerance: float = 1e-6,
    discretisation: str = "spectral",
    watch: Watch = lambda k, n: None,
) -> list[Part]:
    """The states of every step, on as many unknowns as the tolerance needs, their points crowded by b."""
    sizes = sizes_for(discretisation, tolerance)
    _prepare(bench.basis(sizes[0], discretisation), bench.p, steps)
    for size in sizes:
        parts = _follow(bench, bench.problem(size, b, discretisation), steps, tolerance, watch)
        errors = [float(part.survey.error.max()) for part in parts if part.survey is not None]
        if max(errors, default=0.0) <= tolerance or any(part.why == INTERRUPTED for part in parts):
            break
    return parts


def _prepare(basis: Basis, p: Parameters, steps: tuple[Step, ...]) -> None:
    """Have what the test will call compiled in the background, where compiled functions are kept; the longest first."""
    for count in dict.fromkeys(step.points for step in steps):
        surveying.prepare(basis, p, 0.0, count)
        follow.prepare(basis, p, 0.0, count)


def crowding_for(bench: Bench, steps: tuple[Step, ...]) -> float:
    """Point placement that serves the whole test."""
    rows = [row for step in steps for row in corners(step, float(bench.p.rest), NEARLY * bench.longest)]
    return crowding(bench.p, *np.array(rows).T)


def corners(step: Step, rest: float, longest: float) -> list[tuple[float, float, float]]:
    """(length, force, pressure) at the ends of what a step holds; NaN for a length or force that is not held."""
    known = {name: np.asarray(getattr(step, name).waypoints, float) for name in step.controls}
    known = {name: values for name, values in known.items() if len(values)}
    lengths = np.minimum(known.get("length", np.full(1, np.nan)), longest)
    forces, pressures = known.get("force", np.full(1, np.nan)), known.get("pressure", np.zeros(1))
    if np.isnan(lengths).all() and np.isnan(forces).all():
        lengths = np.array([rest])
    return [(h, F, P) for h in lengths for F in forces for P in pressures]


def _follow(
    bench: Bench, problem: Problem, steps: tuple[Step, ...], tolerance: float, watch: Callable[[int, int], None]
) -> list[Part]:
    """Every step in turn, each from where the one before ended; after one that was not finished none is tried."""
    rest = _as_mounted(problem, steps[0])
    present: dict[str, float] = {name: getattr(rest, name) for name in NAMES}
    parts: list[Part] = []
    here: Equilibrium | None = None
    total, done = sum(step.points for step in steps), 0
    for step in steps:
        n, held = step.points, tuple(str(name) for name in step.controls)
        if parts and here is None:
            parts.append(Part(held, n, n, None, np.zeros(0, int), "the step before was not finished"))
            continue
        wanted = np.stack([getattr(step, name).sample(n, present[name]) for name in held], axis=1)
        beyond = np.flatnonzero(wanted[:, 0] >= bench.longest) if held[0] == "length" else np.zeros(0, int)
        possible = int(beyond[0]) if len(beyond) else n
        tell = _later(watch, done, total)
        track = _walk(problem, step, wanted[:possible], here, tolerance, tell) if possible else None
        if track is None:
            parts.append(Part(held, n, 0, None, np.zeros(0, int), bench.too_long()))
            continue
        k = track.reached
        gas = () if step.gas is None else (str(step.gas),)
        look = survey(problem, track.u[:k], track.loads[:k], (*held, *gas)) if k else None
        beyond_reach = k == possible < n and track.message != INTERRUPTED
        why = bench.too_long() if beyond_reach else track.message
        asked = max(k, 1) if step.along == Along.BRANCH and track.message != INTERRUPTED else n
        alone = step.gas is None and step.along != Along.BRANCH and why != INTERRUPTED
        path = tuple(Held(held, tuple(row)) for row in wanted[:possible].tolist()) if alone else ()
        parts.append(Part(held, asked, min(possible, asked), look, track.iterations[:k], why, path))
        here = track.state(k - 1) if k == asked and len(parts) < len(steps) else None
        if here is not None:
            present = {name: getattr(here, name) for name in NAMES}
        done += n
    return parts


def _as_mounted(problem: Problem, first: Step) -> Equilibrium:
    """Where a test begins: the muscle at its own length without pressure, which is the undeformed one unless fittings
    of another radius strain it; then it is sought where the first step asks for it."""
    if problem.p.end_radii is None or not any(getattr(first, name).needs_present for name in first.controls):
        return at_rest(problem)
    return find(problem, Held.of(length=float(problem.p.rest), pressure=0.0))


def _walk(
    problem: Problem, step: Step, wanted: np.ndarray, here: Equilibrium | None, tolerance: float, tell: Watch
) -> Trace:
    """The states of one step, by the way it asks for."""
    names: tuple[str, ...] = tuple(str(name) for name in step.controls)
    if step.gas is not None:  # what is in the muscle as the step begins stays in it
        start = find(problem, Held.of(length=float(problem.p.rest), pressure=0.0)) if here is None else here
        names, here = (*names, str(step.gas)), start
        amount = readings(start, (step.gas,))[0]
        wanted = np.concatenate([wanted, np.full((len(wanted), 1), amount)], axis=1)
    states = [Held(names, tuple(row)) for row in wanted.tolist()]
    if step.along == Along.BRANCH:
        first = find(problem, states[0], here)
        if first.converged:
            return branch(problem, first, states, tell)
    return trace(problem, states, here, min(LOOSE, tolerance), tell)


def _later(watch: Watch, before: int, total: int) -> Watch:
    """Progress of one step as progress of the whole test."""
    return lambda done, _: watch(before + done, total)
