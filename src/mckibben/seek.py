"""`solve()`: one state, sought directly, with a verdict; and what there is instead where it is no good."""

from typing import Any

import attrs
import numpy as np

from .branch import Look, branch_end, look
from .caution import before
from .discretise.line import Line
from .experiment import Bench, sizes_for
from .reach import holding
from .recover import recover
from .report import Part, report
from .result import State
from .solver.direct import find, refine
from .solver.equilibrium import Equilibrium, Held
from .solver.stability import stiffness, weakest
from .spec import Muscle, SpecError, Step
from .survey import error_estimate, survey
from .units import show
from .verdict import Verdict

NEAR_EXTENSION = 0.98
"""Fraction of full extension beyond which the force is the better unknown."""


FULL_LENGTH = 96
"""Unknowns of asymmetric states, odd and even modes together; twice as many where the tolerance needs them."""


def solve(
    muscle: Muscle,
    *,
    length: Any = None,
    force: Any = None,
    pressure: Any = None,
    volume: Any = None,
    tolerance: float = 1e-6,
) -> State:
    """The state of a muscle with two of length, force, pressure and volume held.

    Args:
        muscle: the specification.
        length: distance between the fittings, text with a unit or a number in m.
        force: axial force (N), positive in tension.
        pressure: gauge pressure (Pa).
        volume: volume inside the braid (m^3).
        tolerance: relative error aimed at in force and length.

    Returns:
        A `State` with its `verdict` and `reason`. Where no admissible state exists its numbers are NaN and `last_good`
        is the last admissible state on the way there; where the symmetric state tips to one side, `asymmetric` is the
        stable state it goes to.

    Raises:
        SpecError: for wrong input only.
    """
    step = Step(length=length, force=force, pressure=pressure, volume=volume, points=1)
    for name in step.controls:
        if getattr(step, name).needs_present:
            raise SpecError(f"solve.{name}", str(getattr(step, name)), "must be one value", "a path needs run()")
    held = Held.of(**{name: float(getattr(step, name).sample(1)[0]) for name in step.controls})
    return _state(Bench.of(muscle), muscle, step, held, tolerance)


def _state(bench: Bench, muscle: Muscle, step: Step, held: Held, tolerance: float) -> State:
    if held.get("length", 0.0) >= bench.longest:
        return _nothing(bench, muscle, step, held, Verdict.NO_EQUILIBRIUM, bench.too_long())
    found = seek(bench, held, tolerance)
    if found.verdict.verdict == Verdict.STABLE:
        return _made(bench, muscle, step, held, found)
    if found.verdict.verdict == Verdict.UNSTABLE:
        return _unstable(bench, muscle, step, held, found, tolerance)
    return _instead(bench, muscle, step, held, found)


def seek(bench: Bench, held: Held, tolerance: float) -> Look:
    """Straight to a state, on as many unknowns as the tolerance needs."""
    b = bench.placement(held)
    sizes = sizes_for("spectral", tolerance)
    state = _direct(bench, held, sizes[0], b)
    for size in sizes[1:]:
        if not state.converged or _error(state) <= tolerance:
            break
        finer = refine(state, bench.problem(size, b), held)
        state = finer if finer.converged else _direct(bench, held, size, b)
    if not state.converged:  # a coarse space may lack the state
        state = _direct(bench, held, sizes[-1], b)
    return look(state, held)


def _error(state: Equilibrium) -> float:
    return float(error_estimate(recover(state.problem, state.u[None], state.loads[None]))[0])


def _direct(bench: Bench, held: Held, size: int, b: float) -> Equilibrium:
    problem = bench.problem(size, b)
    length = held.get("length")
    if length is None or length < NEAR_EXTENSION * bench.longest or "pressure" not in held.names:
        return find(problem, held)
    state = find(problem, held)
    return state if state.converged else _stretched(bench, state, held)


def _stretched(bench: Bench, failed: Equilibrium, held: Held) -> Equilibrium:
    """Near full extension: secant in log F against log(h_max - h), every trial at held force."""
    problem, length, pressure = failed.problem, held.get("length"), held.get("pressure")
    gap = np.log(bench.longest - length)
    near = find(problem, Held.of(length=0.97 * bench.longest, pressure=pressure))
    if not near.converged or near.force <= 0.0:
        return failed
    points: list[tuple[float, float]] = [(np.log(near.force), np.log(bench.longest - near.length))]
    guess, state = points[0][0] + 1.0, near
    for _ in range(60):
        trial = find(problem, Held.of(force=float(np.exp(guess)), pressure=pressure), state)
        if not trial.converged or trial.length >= bench.longest:
            return failed
        points.append((guess, np.log(bench.longest - trial.length)))
        state = trial
        if abs(points[-1][1] - gap) < 1e-8:
            return find(problem, held, state)
        (x0, y0), (x1, y1) = points[-2:]
        guess = x1 + np.clip((gap - y1) * (x1 - x0) / (y1 - y0), -2.0, 2.0)
    return failed


def _made(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look, **more: Any) -> State:
    state = found.state
    view = survey(state.problem, state.u[None], state.loads[None], held.names)
    part = Part(held.names, 1, 1, view, np.array([state.iterations]), "")
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    verdict = more.pop("verdict", found.verdict.verdict)
    reason = more.pop("reason", found.verdict.reason)
    return State(result, verdict, reason, view.modes[0], **more)


def _nothing(bench: Bench, muscle: Muscle, step: Step, held: Held, verdict: Verdict, reason: str, **more: Any) -> State:
    part = Part(held.names, 1, 0 if verdict == Verdict.NO_EQUILIBRIUM else 1, None, np.zeros(0, int), reason)
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    return State(result, verdict, reason, None, **more)


def _unstable(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look, tolerance: float) -> State:
    """A symmetric state that tips to one side: also the asymmetric state that it goes to."""
    reason, other = found.verdict.reason, None
    tipped = tip(bench, found, held, tolerance)
    if tipped is not None and tipped.good:
        other = _made(bench, muscle, step, held, tipped)
        reason += f"; the stable asymmetric state carries {show(tipped.state.force, 'N', 6)}"
    elif tipped is not None:
        reason += f"; no admissible asymmetric state was found either ({tipped.verdict.reason})"
    return _made(bench, muscle, step, held, found, reason=reason, asymmetric=other)


def tip(bench: Bench, found: Look, held: Held, tolerance: float) -> Look | None:
    """The state that an antisymmetrically unstable one goes to, on the full length; None if it has no such mode."""
    state = found.state
    basis = state.problem.space.basis
    if not isinstance(basis, Line) or not basis.half or bench.ends == "free":
        return None
    space, b = state.problem.space, state.problem.b
    mode, value = weakest(stiffness(space, bench.p, b, state.u[None], state.loads[None]))
    if value >= 0.0:
        return None
    problem = bench.problem(FULL_LENGTH, b, modes="all")
    u, kick, half = np.zeros(FULL_LENGTH), np.zeros(FULL_LENGTH), FULL_LENGTH // 2
    shared = min(half, basis.size)
    u[1::2][:shared], kick[0::2][:shared] = state.u[:shared], mode[:shared]
    slope = float(np.abs(problem.slopes[0] @ kick).max())
    start = attrs.evolve(state, problem=problem, u=u + 0.1 * kick / slope)
    tipped = find(problem, held, start, radius=0.3)
    if tipped.converged and _error(tipped) > tolerance:
        finer = refine(tipped, bench.problem(2 * FULL_LENGTH, b, modes="all"), held)
        tipped = finer if finer.converged else tipped
    return look(tipped, held)


def _instead(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look) -> State:
    """No admissible state: the last good one on the pressure-first path, where it ends and why."""
    axial = "length" if "length" in held.names else "force"
    verdict = found.verdict.verdict
    if "pressure" not in held.names or axial not in held.names:
        return _nothing(bench, muscle, step, held, verdict, found.verdict.reason)
    pressure = held.get("pressure")
    first = Held.of(**{axial: float(bench.p.H0) if axial == "length" else 0.0, "pressure": pressure})
    end = branch_end(bench.problem(48, found.state.problem.b), first, held, 1e-8)
    if end.complete and end.last is not None:
        return _made(bench, muscle, step, held, end.last)
    if end.last is None:
        return _nothing(bench, muscle, step, held, verdict, f"no good state at {_said(first)}: {end.cause.reason}")
    reason = (
        f"no admissible state at {_said(held)}: from {_said(first)} good states end at "
        f"{show(end.held.get(axial), 'm' if axial == 'length' else 'N', 5)}, where {end.cause.reason}"
    )
    if axial == "length":
        enough = holding(bench, held.get("length"), pressure, 1e-4)
        if np.isfinite(enough):
            reason += f"; {show(enough, 'Pa', 3)} or more holds {show(held.get('length'), 'm', 5)}"
    last_step = Step(**dict(zip(end.held.names, end.held.values, strict=True)))
    last = _made(bench, muscle, last_step, end.held, end.last)
    verdict = Verdict.INADMISSIBLE if verdict == Verdict.INADMISSIBLE else Verdict.NOT_CONVERGED
    return _nothing(bench, muscle, step, held, verdict, reason, last_good=last)


def _before(muscle: Muscle, held: Held) -> list[str]:
    return before(muscle, held.get("length"), held.get("pressure", 0.0))


def _said(held: Held) -> str:
    units = {"length": "m", "volume": "m^3", "force": "N", "pressure": "Pa"}
    return " and ".join(show(value, units[name], 5) for name, value in zip(held.names, held.values, strict=True))
