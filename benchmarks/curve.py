"""One curve of 21 states, everything compiled: case a of the paper, 115 mm and 0 to 1 bar.

`follow` is the compiled part alone, from a given first state; a path seeks that state too; `run` and `solve` are what a
user calls, with shapes, modes, fibre tension, error estimates and verdicts. The paper's discretisation goes through the
same solver, but by equations that are not made for speed.
"""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np
from timing import in_turns, timed

import mckibben as mk
from mckibben.discretise.bspline import Spline
from mckibben.discretise.placement import crowding
from mckibben.discretise.spectral import Line
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.parameters import parameters
from mckibben.model.textbook import virtual_work_force
from mckibben.solver.find import find
from mckibben.solver.follow import follow, padded
from mckibben.solver.held import Held, rows_of, targets_of
from mckibben.solver.path import trace
from mckibben.solver.problem import Problem

LONG, PRESSURES = 0.115, np.linspace(0.0, 1e5, 21)
MUSCLE = mk.presets.paper()
P = parameters(MUSCLE)
PATH = [Held.of(length=LONG, pressure=float(pressure)) for pressure in PRESSURES]
EXACT = 96


def problem(basis: Line | Spline) -> Problem:
    """The muscle on a discretisation, with points crowded as `run` does."""
    b = crowding(P, np.full(1, LONG), np.full(1, np.nan), np.full(1, PRESSURES[-1]))
    return Problem.of(basis, P, b)


def reference() -> np.ndarray:
    """Forces [N] on the finest line."""
    on = problem(Line(EXACT))
    track = trace(on, PATH, tolerance=1e-10)
    assert track.reached == len(PATH)
    return track.loads[:, 0] * on.load_unit[1]


def error(force: np.ndarray, exact: np.ndarray) -> float:
    """Largest error of a curve over its largest force."""
    return float(np.abs(force - exact).max() / np.abs(exact).max())


def follower(basis: Line | Spline, tolerance: float) -> tuple[Problem, Callable[[], Any]]:
    """The compiled following alone, as a call."""
    on = problem(basis)
    first = find(on, PATH[0])
    own, which = rows_of(PATH[0].names, on.loads)
    targets = padded(targets_of(PATH, on.unit, on.loads))
    count, close = np.asarray(len(PATH)), np.asarray(tolerance)

    def call() -> Any:
        return jax.block_until_ready(follow((on.basis, own), on.p, on.b, first.state, which, targets, count, close))

    return on, call


def following(basis: Line | Spline, tolerance: float, exact: np.ndarray, name: str) -> dict[str, Any]:
    """The compiled following alone."""
    on, call = follower(basis, tolerance)
    times = timed(call, 15)
    track = call()
    assert int(track.good) == len(PATH)
    forces = np.asarray(track.state.loads[: len(PATH), 0]) * on.load_unit[1]
    return {"name": name, "states": len(PATH), "error": error(forces, exact), **times}


def searching(basis: Line | Spline, tolerance: float, exact: np.ndarray, name: str) -> dict[str, Any]:
    """The whole path: the first state sought, then following, and the robust search where that stops."""
    on = problem(basis)
    times = timed(lambda: trace(on, PATH, tolerance=tolerance), 5)
    track = trace(on, PATH, tolerance=tolerance)
    assert track.reached == len(PATH)
    return {"name": name, "states": len(PATH), "error": error(track.loads[:, 0] * on.load_unit[1], exact), **times}


def measure(exact: np.ndarray) -> list[dict[str, Any]]:
    """Following, `run` and `solve`."""
    test = mk.Isometric(length=LONG, pressure="0 to 1 bar", points=len(PATH))
    curve = mk.run(MUSCLE, test)
    state = mk.solve(MUSCLE, length=LONG, pressure="1 bar")
    turns = in_turns(follower(Line(24), 1e-6)[1], lambda: mk.run(MUSCLE, test))
    return [
        following(Line(12), 1e-4, exact, "following alone, 12 unknowns, 1e-4"),
        following(Line(24), 1e-6, exact, "following alone, 24 unknowns, 1e-6"),
        searching(Line(24), 1e-6, exact, "path, 24 unknowns, 1e-6"),
        {
            "name": f"mk.run in full; in turns with following, 24 unknowns, {turns:.1f} times as long (asked 4)",
            "states": len(PATH),
            "error": error(curve.force, exact),
            **timed(lambda: mk.run(MUSCLE, test), 5),
        },
        {
            "name": "mk.solve in full, 1 bar",
            "states": 1,
            "error": abs(state.force / exact[-1] - 1.0),
            **timed(lambda: mk.solve(MUSCLE, length=LONG, pressure="1 bar"), 5),
        },
    ]


def measure_others(exact: np.ndarray) -> list[dict[str, Any]]:
    """The paper's discretisation through the same solver, and the closed forms."""
    scalar = jax.vmap(lambda theta, pressure: cylinder_force(theta, pressure, P))
    forms = {
        "cylinder with stored energy": scalar,
        "cylinder formula, Eq. (31)": lambda theta, pressure: virtual_work_force(theta, pressure, P),
    }
    rows = [searching(Spline(43), 1e-6, exact, "43 B-splines (the paper's), path, 1e-6")]
    lengths = np.full(len(PATH), LONG)
    for name, form in forms.items():
        compiled = jax.jit(lambda h, pressure, form=form: form(cylinder_angle(h, P), pressure))

        def call(compiled: Any = compiled) -> Any:
            return jax.block_until_ready(compiled(lengths, PRESSURES))

        rows.append({"name": name, "states": len(PATH), "error": error(np.asarray(call()), exact), **timed(call, 15)})
    return rows
