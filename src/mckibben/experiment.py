"""Tests as a lab runs them: `run()`. Here the layers are joined."""

import warnings
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from . import survey as surveying
from .caution import thick_wall
from .discretise.bspline import Spline
from .discretise.line import Line
from .model.chamber import law_of
from .model.extension import full_extension
from .model.parameters import Law, Parameters, parameters
from .report import Part, report
from .result import Result
from .solver import path
from .solver.arclength import branch
from .solver.direct import find
from .solver.equilibrium import NAMES, Equilibrium, Held
from .solver.gas import sealed
from .solver.path import INTERRUPTED, Trace, Watch, trace
from .solver.placement import crowding
from .solver.problem import VOLUME, Problem, Space
from .spec import Along, Muscle, SpecError, Step, Test
from .survey import survey

SIZES = {"spectral": (24, 48, 96), "paper": (43,)}
"""Sizes of the two discretisations, tried in turn until the error estimate is below the tolerance."""
QUICK = 12
"""Half-length unknowns to start with where 1e-4 will do."""


class MuscleWarning(UserWarning):
    """The result stands, but a real muscle may not follow the model there."""


@attrs.frozen
class Bench:
    """A muscle on the bench: its numbers, its law and what limits its length."""

    p: Parameters
    law: Law
    ends: str
    longest: float  #: full extension [m]

    @classmethod
    def of(cls, muscle: Muscle) -> "Bench":
        """From the specification."""
        p, ends = parameters(muscle), str(muscle.ends)
        return cls(p, law_of(muscle), ends, full_extension(float(p.R0), float(p.H0), float(p.theta0), ends))

    def problem(self, size: int, b: float, discretisation: str = "spectral", modes: Any = "odd") -> Problem:
        """The muscle on a discretisation."""
        return Problem.of(self.space(size, discretisation, modes), self.p, b)

    def space(self, size: int, discretisation: str = "spectral", modes: Any = "odd") -> Space:
        """The static part of it."""
        basis = Spline(size, self.ends) if discretisation == "paper" else Line(size, self.ends, modes)
        return Space(basis, self.law)

    def placement(self, held: Held) -> float:
        """Crowding of points for one state."""
        force, pressure = held.get("force", np.nan), held.get("pressure", 0.0)
        length = min(held.get("length", float(self.p.H0) if np.isnan(force) else np.nan), 0.999 * self.longest)
        return crowding(self.law, self.p, np.array([length]), np.array([force]), np.array([pressure]))

    def too_long(self) -> str:
        """Why no equilibrium exists beyond full extension."""
        return f"no equilibrium: the fibres are straight at {1e3 * self.longest:.4f} mm, the longest possible length"


def sizes_for(discretisation: str, tolerance: float) -> tuple[int, ...]:
    """Sizes to try in turn."""
    if discretisation not in SIZES:
        raise SpecError("discretisation", discretisation, "must be one of " + ", ".join(SIZES))
    if not 1e-10 <= tolerance <= 1e-2:
        raise SpecError("tolerance", tolerance, "must be from 1e-10 to 1e-2", "1e-6 is the default")
    sizes = SIZES[discretisation]
    return (QUICK, *sizes) if discretisation == "spectral" and tolerance >= 1e-4 else sizes


def run(
    muscle: Muscle,
    test: Test,
    *,
    tolerance: float = 1e-6,
    discretisation: str = "spectral",
    watch: Watch | None = None,
) -> Result:
    """Run a test on a muscle.

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
    """
    bench = Bench.of(muscle)
    parts = solved(bench, test.as_steps(muscle), tolerance, discretisation, watch or (lambda k, n: None))
    result, notes = report(muscle, test, parts, float(bench.p.H0), thick_wall(muscle))
    for note in notes:
        warnings.warn(note, MuscleWarning, stacklevel=2)
    return result


def solved(
    bench: Bench,
    steps: tuple[Step, ...],
    tolerance: float = 1e-6,
    discretisation: str = "spectral",
    watch: Watch = lambda k, n: None,
) -> list[Part]:
    """The states of every step, on as many unknowns as the tolerance needs."""
    sizes = sizes_for(discretisation, tolerance)
    _prepare(bench.space(sizes[0], discretisation), bench.p, steps)
    b = _crowding(bench, steps)
    for size in sizes:
        parts = _follow(bench, bench.problem(size, b, discretisation), steps, tolerance, watch)
        errors = [float(part.survey.error.max()) for part in parts if part.survey is not None]
        if max(errors, default=0.0) <= tolerance or any(part.why == INTERRUPTED for part in parts):
            break
    return parts


def _prepare(space: Space, p: Parameters, steps: tuple[Step, ...]) -> None:
    """Have what the test will call compiled in the background, where compiled functions are kept."""
    for count in dict.fromkeys(step.points for step in steps):
        path.prepare(space, p, 0.0, count)
        surveying.prepare(space, p, 0.0, count)


def _crowding(bench: Bench, steps: tuple[Step, ...]) -> float:
    """Point placement that serves the whole test."""
    rows = [row for step in steps for row in corners(step, float(bench.p.H0), 0.999 * bench.longest)]
    return crowding(bench.law, bench.p, *np.array(rows).T)


def corners(step: Step, H0: float, longest: float) -> list[tuple[float, float, float]]:
    """(length, force, pressure) at the ends of what a step holds; NaN for a length or force that is not held."""
    known = {name: np.asarray(getattr(step, name).waypoints, float) for name in step.controls}
    known = {name: values for name, values in known.items() if len(values)}
    lengths = np.minimum(known.get("length", np.full(1, np.nan)), longest)
    forces, pressures = known.get("force", np.full(1, np.nan)), known.get("pressure", np.zeros(1))
    if np.isnan(lengths).all() and np.isnan(forces).all():
        lengths = np.array([H0])
    return [(h, F, P) for h in lengths for F in forces for P in pressures]


def _follow(
    bench: Bench, problem: Problem, steps: tuple[Step, ...], tolerance: float, watch: Callable[[int, int], None]
) -> list[Part]:
    """Every step in turn, each from where the one before ended; after one that was not finished none is tried."""
    start = (float(bench.p.H0), float(problem.unit[VOLUME]), 0.0, 0.0)
    present: dict[str, float] = dict(zip(NAMES, start, strict=True))
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
        look = survey(problem, track.u[:k], track.loads[:k], held) if k else None
        beyond_reach = k == possible < n and track.message != INTERRUPTED
        why = bench.too_long() if beyond_reach else track.message
        asked = max(k, 1) if step.along == Along.BRANCH and track.message != INTERRUPTED else n
        parts.append(Part(held, asked, min(possible, asked), look, track.iterations[:k], why))
        here = track.state(k - 1) if k == asked else None
        if here is not None:
            present = {name: getattr(here, name) for name in NAMES}
        done += n
    return parts


def _walk(
    problem: Problem, step: Step, wanted: np.ndarray, here: Equilibrium | None, tolerance: float, tell: Watch
) -> Trace:
    """The states of one step, by the way it asks for."""
    held = tuple(str(name) for name in step.controls)
    if step.gas is not None:
        rest = Held.of(length=float(problem.p.H0), pressure=0.0)
        start = find(problem, rest) if here is None else here
        return sealed(problem, held[0], wanted[:, 0].tolist(), start, str(step.gas), tell)
    states = [Held.of(**dict(zip(held, row, strict=True))) for row in wanted.tolist()]
    if step.along == Along.BRANCH:
        first = find(problem, states[0], here)
        if first.converged:
            return branch(problem, first, states, tell)
    return trace(problem, states, here, min(1e-4, tolerance), tell)


def _later(watch: Watch, before: int, total: int) -> Watch:
    """Progress of one step as progress of the whole test."""
    return lambda done, _: watch(before + done, total)
