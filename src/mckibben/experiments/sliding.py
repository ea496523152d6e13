"""What a muscle whose crossings rub does without a path: all of them slip, one way or the other, or all stick."""

from typing import Any

import attrs
import numpy as np

from mckibben.experiments.going import Going
from mckibben.measure.rub import Stepped, rub
from mckibben.model.friction import Remembered
from mckibben.model.parameters import Rubbing
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.held import Held, rows_of, targets_of
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns
from mckibben.solver.threads import one_thread

__all__ = ["sliding_forces", "sticking"]

FAR = 10.0
"""Turn [rad] since crossings were free of moment, from which all of them slip: more than they can ever turn."""
LEGS = 8
"""Parts in which friction is brought up where it is too much at once."""
NUDGE = 1e-5
"""Part of the length by which a muscle is lengthened to see how stiff its crossings are."""
HELD = 1e3
"""Moment [N m] at which no crossing slips in such a step."""


@one_thread()
def sliding_forces(bench: Bench, free: Equilibrium) -> tuple[float, float] | None:
    """Forces [N] at the length and pressure of a state without friction, as the muscle shortens and as it lengthens.

    None where there is no state in which all crossings slip.
    """
    forces = [_sliding(bench, free, way) for way in (-1.0, 1.0)]
    return None if any(force is None for force in forces) else (forces[0], forces[1])  # type: ignore[return-value]


def _sliding(bench: Bench, free: Equilibrium, way: float) -> float | None:
    for legs in (1, LEGS):
        state: Any = free
        for share in np.arange(1, legs + 1) / legs:
            state = _found(bench, free, state, way, float(share))
            if state is None:
                break
        else:
            return float(state.loads[0] * free.problem.load_unit[1])
    return None


@one_thread()
def sticking(bench: Bench, free: Equilibrium) -> float | None:
    """What crossings that all stick, free of moment in a state without friction, add to its stiffness dF/dh [N/m]."""
    law = _at_crossings(bench)
    loose, stiff = (
        attrs.evolve(free.problem, p=bench.p._replace(friction=law._replace(arm=0.0, moment=moment)))
        for moment in (0.0, HELD)
    )
    made, held, step = Going.as_made(loose), Held.of(length=free.length, pressure=free.pressure), NUDGE * free.length
    there = _rubbed(loose, Unknowns(free.u, free.loads, made.state.memory), made.outer, held)
    if not there.good:
        return None
    memories = [Remembered(np.asarray(one.alpha), np.full(len(one.alpha), HELD))
                for one in (there.next_inner, there.next_outer)]  # fmt: skip
    further = Held.of(length=free.length + step, pressure=free.pressure)
    slack = _rubbed(loose, there.state._replace(memory=made.state.memory), made.outer, further)
    tight = _rubbed(stiff, there.state._replace(memory=memories[0]), memories[1], further)
    if not (slack.good and tight.good):
        return None
    return float((tight.state.loads[0] - slack.state.loads[0]) * free.problem.load_unit[1] / step)


def _at_crossings(bench: Bench) -> Rubbing:
    """Friction at the crossings alone: which way a chamber slides is a matter of the path, so it is held here."""
    law: Rubbing = bench.p.friction._replace(chamber=None, grip=None)
    return law


def _found(bench: Bench, free: Equilibrium, start: Any, way: float, share: float) -> Unknowns | None:
    """The state in which all crossings slip with a share of the friction, from one with less."""
    friction = _at_crossings(bench)
    less = friction._replace(arm=share * friction.arm, moment=share * friction.moment)
    problem = attrs.evolve(free.problem, p=bench.p._replace(friction=less))
    made = Going.as_made(problem)
    inner, outer = (Remembered(one.alpha - way * FAR, one.moment) for one in (made.state.memory, made.outer))
    held = Held.of(length=free.length, pressure=free.pressure)
    found = _rubbed(problem, Unknowns(np.asarray(start.u), np.asarray(start.loads), inner), outer, held)
    return found.state if found.good else None


def _rubbed(problem: Problem, state: Unknowns, outer: Remembered, held: Held) -> Stepped:
    """One step from a state with its memory to what is held."""
    own, which = rows_of(held.names, problem.loads)
    targets = targets_of((held,), problem.unit, problem.loads)[0]
    return rub((problem.basis, own), problem.p, problem.b, state, outer, which, targets, np.asarray(False))
