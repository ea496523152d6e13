"""`solve()`: one state, sought directly, with a verdict; and where it is not stable, the nearest one that is."""

from typing import Any

import attrs
import numpy as np

from mckibben.experiments.answer import Answer, answer
from mckibben.experiments.sliding import sliding_forces
from mckibben.measure.caution import before
from mckibben.measure.report import Part, report
from mckibben.measure.survey import survey
from mckibben.results.result import State
from mckibben.results.verdict import Verdict
from mckibben.search.elsewhere import Way
from mckibben.search.walk import Look
from mckibben.solver.bench import Bench
from mckibben.solver.held import Held
from mckibben.spec import Muscle, SpecError, Step
from mckibben.spec.declared import evolved
from mckibben.spec.plausible import trusted
from mckibben.units import show

__all__ = ["solve"]


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
        symmetric state tips to one side, `asymmetric` is the stable state it goes to. What a muscle with friction does
        depends on its path, which only `run` knows: it is solved without friction, and `force_interval` holds the
        forces [N] at that length and pressure with all crossings slipping, as it shortens and as it lengthens.

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
    if muscle.friction is not None:
        return _without_path(muscle, step, held, tolerance)
    bench = Bench.of(muscle)
    return _state(bench, muscle, step, held, answer(bench, held, tolerance))


def _without_path(muscle: Muscle, step: Step, held: Held, tolerance: float) -> State:
    """The state of a muscle whose crossings rub, if they did not; and between which forces they leave it."""
    bench = Bench.of(evolved(muscle, friction=None))
    found = answer(bench, held, tolerance)
    state = _state(bench, muscle, step, held, found)
    forces = None if found.given is None else sliding_forces(Bench.of(muscle), found.given.state)
    slides = muscle.friction is not None and muscle.friction.chamber_coefficient is not None
    chamber = ", the chamber held to the mesh" if slides else ""
    said = f"without friction{chamber}, since what it does depends on the path (run)"
    if forces is not None:
        low, high = (show(force, "N", 5) for force in forces)
        said += f"; with it the force is from {low}, as the muscle shortens, to {high}, as it lengthens"
    return attrs.evolve(state, reason=f"{state.reason}; {said}", force_interval=forces)


def _state(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Answer) -> State:
    more: dict[str, Any] = {"last_good": None if found.way is None else _last_good(bench, muscle, found.way)}
    if found.asymmetric is not None:
        more["asymmetric"] = _made(bench, muscle, step, held, found.asymmetric)
    if found.given is not None:
        return _made(bench, muscle, step, held, found.given, verdict=found.verdict, reason=found.reason, **more)
    part = Part(
        held.names, 1, 0 if found.verdict == Verdict.NO_EQUILIBRIUM else 1, None, np.zeros(0, int), found.reason
    )
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    return State(result, found.verdict, found.reason, None, **more)


def _made(bench: Bench, muscle: Muscle, step: Step, held: Held, found: Look, **more: Any) -> State:
    state = found.state
    view = survey(state.problem, state.u[None], state.loads[None], held.names)
    part = Part(held.names, 1, 1, view, np.array([state.iterations]), "")
    result, _ = report(muscle, step, [part], float(bench.p.H0), _before(muscle, held))
    verdict = more.pop("verdict", found.verdict.verdict)
    reason = more.pop("reason", found.verdict.reason)
    return State(result, verdict, reason, found.modes, **more)


def _last_good(bench: Bench, muscle: Muscle, way: Way) -> State | None:
    if way.end.last is None:
        return None
    held = way.end.held
    with trusted():
        step = Step(**dict(zip(held.names, held.values, strict=True)))
    return _made(bench, muscle, step, held, way.end.last)


def _before(muscle: Muscle, held: Held) -> list[str]:
    return before(muscle, held.get("length"), held.get("pressure", 0.0))
