"""Other ways to the same target, to judge whether it can be reached at all: two long paths and random starts."""

from typing import Any

import attrs
import numpy as np

from mckibben.discretise.placement import crowding
from mckibben.measure.judge import ADMISSIBLE
from mckibben.search.elsewhere import way_there
from mckibben.search.walk import look
from mckibben.solver.arclength import branch
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import embedded, equilibrium, find, refine
from mckibben.solver.held import Held
from mckibben.solver.path import trace
from mckibben.solver.problem import Problem

SIZE, FINE, STEPS, STARTS, RESOLVED = 48, 96, 24, 6, 1e-2
"""Half-length unknowns to search with and to judge with, states on each leg of a path, random starts, and the
coefficient tail a state must have."""
TOLERANCE, BEFORE, ALONG, FOLD = 1e-6, 0.99, 60, 1e-4
"""Of the way whose end is followed by arclength: its error, how far of it the walk sets in, states at most, and by how
much of the way the branch must have gone back to have turned."""


def judge_target(bench: Bench, held: Held, seed: int) -> dict[str, Any]:
    """What each method makes of a target; `reached` names those that found a good state there."""
    b = placement(bench, held)
    problem, fine = bench.problem(SIZE, b), bench.problem(FINE, b)
    found = {
        "pressure first": along(problem, held, float(bench.p.rest), pressure_first=True),
        "pressure last": along(problem, held, float(bench.p.rest), pressure_first=False),
    }
    for k, state in enumerate(starts(problem, seed)):
        found[f"random start {k}"] = find(problem, held, state)
    worth = {
        name: worth_of(state and state.converged and refine(state, fine, held), held) for name, state in found.items()
    }
    return {"reached": [name for name, one in worth.items() if one["good"]], "worth": worth}


def placement(bench: Bench, held: Held) -> float:
    """Crowding of points for one state, from the cylinder formula."""
    force = held.get("force", np.nan)
    length = held.get("length", np.nan if np.isfinite(force) else float(bench.p.H0))
    return crowding(bench.p, np.array([length]), np.array([force]), np.array([held.get("pressure", 0.0)]))


def along(problem: Problem, held: Held, rest_length: float, pressure_first: bool) -> Equilibrium | None:
    """The end of a path of two legs from rest; None where it is not reached."""
    axial = held.names[0] if held.names[1] == "pressure" else held.names[1]
    rest, target, pressure = (rest_length if axial == "length" else 0.0), held.get(axial), held.get("pressure")
    share = np.linspace(0.0, 1.0, STEPS)
    still, moving = np.zeros(STEPS), rest + share * (target - rest)
    if pressure_first:
        legs = [(np.full(STEPS, rest), share * pressure), (moving, np.full(STEPS, pressure))]
    else:
        legs = [(moving, still), (np.full(STEPS, target), share * pressure)]
    here = None
    for a, P in legs:
        path = [Held.of(**{axial: float(x), "pressure": float(y)}) for x, y in zip(a, P, strict=True)]
        track = trace(problem, path, here)
        if track.reached < STEPS:
            return None
        here = track.state(STEPS - 1)
    return find(problem, held, here, radius=0.1)


def starts(problem: Problem, seed: int) -> list[Equilibrium]:
    """Random smooth shapes: the first modes with random amplitudes, slopes up to 0.2 .. 1.5 rad."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(STARTS):
        u = np.zeros(problem.basis.unknowns)
        modes = int(rng.integers(2, 13))
        u[:modes] = rng.normal(size=modes) / (1.0 + np.arange(modes))
        u *= rng.uniform(0.2, 1.5) / problem.moved(u)
        state = equilibrium(problem, u, np.zeros(problem.loads))
        found.append(attrs.evolve(state, converged=True))
    return found


def worth_of(state: Equilibrium | None, held: Held) -> dict[str, Any]:
    """Whether a state is converged, resolved, of an admissible shape and stable in its symmetric modes (`good`) and in
    its antisymmetric ones too (`stable`)."""
    if not state or not state.converged:
        return {"good": False, "stable": False, "why": "not converged"}
    seen = look(state, held)
    assert seen.modes is not None
    count = seen.modes.length_control if "length" in held.names else seen.modes.force_control
    good = count == 0 and seen.verdict.shape in ADMISSIBLE and state.tail < RESOLVED
    why = f"{seen.verdict.reason}; tail {state.tail:.1e}" + (f"; {count} symmetric modes" if count else "")
    stable = good and not seen.modes.antisymmetric
    return {"good": good, "stable": stable, "why": why, "force": state.force, "length": state.length}


def turns_back(bench: Bench, held: Held) -> dict[str, Any]:
    """Whether the branch on which good states end turns back before the target, followed by arclength past its end.

    `furthest` is the share of the way that it comes to. On `SIZE` unknowns, whatever the shapes.
    """
    problem = bench.problem(SIZE, placement(bench, held))
    way = way_there(bench, held, problem.b, TOLERANCE, roughly=True)
    if way is None or way.end.last is None or not way.end.fraction:
        return {"turned": False, "furthest": 0.0, "why": "no good state on the way"}
    first, end = (np.array(one.values) for one in (way.first, way.end.held))
    target = Held(held.names, tuple((first + (end - first) / way.end.fraction).tolist()))
    start = way.first.towards(target, BEFORE * way.end.fraction)
    here = find(problem, start, embedded(way.end.last.state, problem), 0.3)
    if not here.converged:
        return {"turned": False, "furthest": way.end.fraction, "why": "no state shortly before its end"}
    track = branch(problem, here, [start.towards(target, k / ALONG) for k in range(ALONG + 1)])
    varied = int(np.argmax(np.abs(end - first)))
    gone = []
    for state in map(track.state, range(track.reached)):
        at = (state.length if held.names[varied] == "length" else state.force, state.pressure)[varied]
        gone.append(float((at - first[varied]) / (np.array(target.values) - first)[varied]))
    most = max(gone)
    return {"turned": most < 1.0 and gone[-1] < most - FOLD, "furthest": most, "why": track.message}
