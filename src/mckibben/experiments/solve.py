"""`solve()`: one state, sought directly, with a verdict; and where it is not stable, the nearest one that is."""

from typing import Any

import numpy as np

from mckibben.experiments.limits import holding
from mckibben.measure.caution import before
from mckibben.measure.report import Part, report
from mckibben.measure.survey import survey
from mckibben.results.result import State
from mckibben.results.verdict import Verdict
from mckibben.search.elsewhere import Else, Way, look_elsewhere, way_there
from mckibben.search.finer import sharpened
from mckibben.search.near_extension import near_extension, stretched
from mckibben.search.walk import Look, look
from mckibben.solver.bench import Bench, sizes_for
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.spec import Muscle, SpecError, Step
from mckibben.spec.plausible import trusted
from mckibben.units import show

COARSE = 24
"""Unknowns with which the pressure that would hold a length is looked for: it is told to three digits."""

UNSTABLE = "an unstable state of another shape"
"""In a reason: a symmetric state that tips to one side, found from another start than rest."""


def solve(
    muscle: Muscle,
    *,
    length: Any = None,
    contraction: Any = None,
    force: Any = None,
    pressure: Any = None,
    volume: Any = None,
    tolerance: float = 1e-6,
) -> State:
    """The state of a muscle with two of length, force, pressure and volume held.

    The potential energy that is made stationary is the paper's Eq. 28. Give exactly two of the four, each as text with
    its unit or as a number in SI units.

    Args:
        muscle: the specification.
        length: distance between the fittings [m].
        contraction: in place of the length: 1 - h/H0, such as "10 %" or 0.1.
        force: axial force [N], positive in tension.
        pressure: gauge pressure [Pa].
        volume: volume inside the braid [m^3].
        tolerance: relative error aimed at in force and length, from 1e-10 to 1e-2.

    Returns:
        A `State` with its `verdict` and `reason`. A state that is not stable on the direct way is sought in others
        too, and a stable one is given where any of them finds it. Where no admissible state is found the numbers are
        NaN, the reason says what was tried, and `last_good` is the last admissible state on the way there; where the
        symmetric state tips to one side, `asymmetric` is the stable state it goes to.

    Raises:
        SpecError: for wrong input only.

    >>> state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> round(state.force, 2), state.reason
    (101.22, 'stable under length control')
    >>> mk.solve(mk.presets.paper(), length="130 mm", pressure="1 bar").reason
    'no equilibrium: the fibres are straight at 128.7786 mm, the longest possible length'
    """
    given = Step(length=length, contraction=contraction, force=force, pressure=pressure, volume=volume, points=1)  # type: ignore[call-arg]
    (step,) = given.as_steps(muscle)
    for name in step.controls:
        if getattr(step, name).needs_present:
            raise SpecError(f"solve.{name}", str(getattr(step, name)), "must be one value", "a path needs run()")
    held = Held.of(**{name: float(getattr(step, name).sample(1)[0]) for name in step.controls})
    return _state(Bench.of(muscle), muscle, step, held, tolerance)


def _state(bench: Bench, muscle: Muscle, step: Step, held: Held, tolerance: float) -> State:
    if held.get("length", 0.0) >= bench.longest:
        return _nothing(bench, muscle, step, held, Verdict.NO_EQUILIBRIUM, bench.too_long())
    found = seek(bench, held, tolerance)
    if found.good:
        return _made(bench, muscle, step, held, found)
    way = way_there(bench, held, found.state.problem.b, tolerance)
    if way is not None and way.end.complete and way.end.last is not None:
        return _made(bench, muscle, step, held, way.end.last)
    instead = look_elsewhere(bench, held, found, way, tolerance)
    return _instead(bench, muscle, step, held, found, way, instead)


def seek(bench: Bench, held: Held, tolerance: float) -> Look:
    """Straight to a state, on as many unknowns as the tolerance needs."""
    problem = bench.problem(sizes_for("spectral", tolerance)[0], bench.placement(held))
    state = find(problem, held)
    if not state.converged and near_extension(bench, held):
        near = stretched(bench, state, held, tolerance)
        if near.converged:
            return look(near, held)
    return sharpened(bench, state, held, tolerance, again=True)


def _made(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look, **more: Any) -> State:
    state = found.state
    view = survey(state.problem, state.u[None], state.loads[None], held.names)
    part = Part(held.names, 1, 1, view, np.array([state.iterations]), "")
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    verdict = more.pop("verdict", found.verdict.verdict)
    reason = more.pop("reason", found.verdict.reason)
    return State(result, verdict, reason, found.modes, **more)


def _nothing(bench: Bench, muscle: Muscle, step: Step, held: Held, verdict: Verdict, reason: str, **more: Any) -> State:
    part = Part(held.names, 1, 0 if verdict == Verdict.NO_EQUILIBRIUM else 1, None, np.zeros(0, int), reason)
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    return State(result, verdict, reason, None, **more)


def _instead(
    bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look, way: Way | None, instead: Else
) -> State:
    """The best of what was found where the direct search gave nothing stable, and what was tried."""
    symmetric, asymmetric = instead.symmetric, instead.asymmetric
    other = None if asymmetric is None else _made(bench, muscle, step, held, asymmetric)
    if symmetric is not None and symmetric.good:
        reason = symmetric.verdict.reason + "; found from another shape than rest"
        if way is not None:
            reason += f": on the way there {_ending(way)}"
        return _made(bench, muscle, step, held, symmetric, reason=reason)
    if symmetric is not None and (symmetric is found or other is not None):
        return _unstable(bench, muscle, step, held, found, way, instead, other)
    if asymmetric is not None:
        reason = asymmetric.verdict.reason + "; an asymmetric state"
        if way is not None:
            reason += f": on the way there {_ending(way)}"
        return _made(bench, muscle, step, held, asymmetric, reason=reason)
    verdict = found.verdict.verdict
    if way is None:
        return _nothing(bench, muscle, step, held, verdict, found.verdict.reason)
    verdict = Verdict.INADMISSIBLE if verdict == Verdict.INADMISSIBLE else Verdict.NOT_CONVERGED
    lacks = f"no {'stable' if symmetric else 'admissible'} state was found at {_said(held)}"
    reason = f"{lacks}: {_ending(way)}{_tried(instead)}{_holds(bench, held)}"
    return _nothing(bench, muscle, step, held, verdict, reason, last_good=_last_good(bench, muscle, way))


def _unstable(
    bench: Bench,
    muscle: Muscle,
    step: Step,
    held: Held,
    found: Look,
    way: Way | None,
    instead: Else,
    other: State | None,
) -> State:
    """A symmetric state that tips to one side, and the asymmetric state that it goes to."""
    symmetric, tipped = instead.symmetric, instead.tipped
    assert symmetric is not None
    reason = symmetric.verdict.reason
    if other is not None:
        reason += f"; the stable asymmetric state carries {show(other.force, 'N', 6)}"
    elif tipped is not None:
        reason += f"; no admissible asymmetric state was found either ({tipped.verdict.reason})"
    if symmetric is not found and way is not None:
        reason += f"; found from another shape than rest: on the way there {_ending(way)}"
    last = None if other is not None else _last_good(bench, muscle, way)
    return _made(bench, muscle, step, held, symmetric, reason=reason, asymmetric=other, last_good=last)


def _ending(way: Way) -> str:
    """Where the good states on the way to a target end, and why."""
    axial, unit = ("length", "m") if "length" in way.first.names else ("force", "N")
    if way.end.last is None:
        return f"there is no good state at {_said(way.first)}, where {way.end.cause.reason}"
    at = show(way.end.held.get(axial), unit, 5)
    return f"from {_said(way.first)} good states end at {at}, where {way.end.cause.reason}"


def _tried(instead: Else) -> str:
    """What other starts gave: nothing, or a state that no muscle holds because it tips to nothing admissible."""
    if instead.symmetric is not None:
        force = show(instead.symmetric.state.force, "N", 5)
        return f"; {UNSTABLE} carries {force}, but gives way to one side, to no admissible shape that was found"
    return f"; {instead.tried} searches from other starts found none either" if instead.tried else ""


def _holds(bench: Bench, held: Held) -> str:
    """What pressure holds a length that this one does not."""
    if "length" not in held.names:
        return ""
    enough = holding(bench, held.get("length"), held.get("pressure"), 1e-4, size=COARSE)
    return f"; {show(enough, 'Pa', 3)} or more holds {show(held.get('length'), 'm', 5)}" if np.isfinite(enough) else ""


def _last_good(bench: Bench, muscle: Muscle, way: Way | None) -> State | None:
    if way is None or way.end.last is None:
        return None
    held = way.end.held
    with trusted():
        step = Step(**dict(zip(held.names, held.values, strict=True)))
    return _made(bench, muscle, step, held, way.end.last)


def _before(muscle: Muscle, held: Held) -> list[str]:
    return before(muscle, held.get("length"), held.get("pressure", 0.0))


def _said(held: Held) -> str:
    units = {"length": "m", "volume": "m^3", "force": "N", "pressure": "Pa"}
    return " and ".join(show(value, units[name], 5) for name, value in zip(held.names, held.values, strict=True))
