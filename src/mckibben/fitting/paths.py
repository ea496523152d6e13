"""Forces less the measured ones where crossings rub: along the path of every test, in the order of its points.

A test begins with the muscle as made, as in `run`: the first pressure comes at the rest length, then the first point.
Derivatives are central differences of whole paths. Exact ones would have to carry those of what every crossing
remembers from state to state; a path takes some hundredth of a second for each of its states, so a few numbers cost
little. Between muscles that are near, states are sought in the same parts of the way, so that differences are smooth.
"""

from __future__ import annotations

from itertools import pairwise

import attrs
import numpy as np

from mckibben.data.branches import UNKNOWN
from mckibben.discretise.placement import crowding
from mckibben.experiments.going import Going, step_to
from mckibben.experiments.rubbing import LARGEST
from mckibben.fitting.differences import by_differences
from mckibben.fitting.free import Free, put_in
from mckibben.fitting.misfit import OfOneMuscle, Points, Seen
from mckibben.model.parameters import parameters
from mckibben.solver.bench import NEARLY, Bench
from mckibben.solver.held import Held
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle, SpecError

__all__ = ["PathMisfit"]

Shares = dict[int, list[tuple[float, ...]]]


@attrs.define(eq=False)
class PathMisfit(OfOneMuscle):
    """As `Misfit`, of a muscle with friction; points of no weight are on the path and are not compared."""

    muscle: Muscle
    free: tuple[Free, ...]
    path: Points  #: all points of the tests of which some are compared, in order
    size: int
    measured: Points = attrs.field(init=False)
    shares: Shares = attrs.field(init=False, factory=dict)  #: of the ways between points, by path
    placement: float | None = attrs.field(init=False, default=None)
    reached: bool = attrs.field(init=False, default=False)  #: whether every point had a state as they were last placed
    last: tuple[bytes, Seen] | None = attrs.field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        used = self.path.weights > 0.0
        self.path = self.path.some(np.isin(self.path.paths, self.path.paths[used]))
        self.measured = self.path.some(self.path.weights > 0.0)
        lost = self.path.branches == UNKNOWN
        if lost.any():
            said = f"of test {self.path.tests[lost][0]} come in no order, and with friction forces depend on the path"
            raise SpecError(
                "data", allowed=said, advice='give points as they were measured, or muscle.replace("friction", None)'
            )

    def place_anew(self, x: np.ndarray, size: int | None = None) -> None:
        """Place the points for the muscle at x, on more unknowns if a size is given, and seek its states anew."""
        self.size = min(size or self.size, LARGEST)
        muscle, points, _ = self._at(x)
        self.placement = _placed(muscle, points)
        self.last, self.shares = None, {}
        self.reached = bool(self(x).found.all())

    def error(self, x: np.ndarray) -> float:
        """Largest difference of the forces at x from those on half as many unknowns, over the axial load."""
        muscle, points, _ = self._at(x)
        fine, coarse = self._forces(x, self.size), self._forces(x, self.size // 2)
        area = np.pi * float(muscle.braid.radius) ** 2
        load = np.maximum(np.maximum(np.abs(fine), area * np.abs(points[:, 1])), 1e-300)
        difference = np.abs(fine - coarse) / load
        return float(np.nanmax(difference)) if np.isfinite(difference).any() else 0.0

    def __call__(self, x: np.ndarray) -> Seen:
        """Forces at x, and derivatives where they are asked for."""
        x = np.asarray(x, float)
        key = x.tobytes()
        if self.last is None or self.last[0] != key:
            force = self._measured_forces(x)
            self.last = key, Seen(force, lambda: by_differences(self._measured_forces, self.free, x, force))
        return self.last[1]

    def _at(self, x: np.ndarray) -> tuple[Muscle, np.ndarray, float]:
        """The muscle, where its points are as the instruments have it, and what the load cell shows without load."""
        values = self.values(x)
        points = self.path.points + self.shift(values)
        return put_in(self.muscle, self.free, values), points, self.offset(values, "force")

    def _measured_forces(self, x: np.ndarray) -> np.ndarray:
        try:
            return self._forces(x, self.size)[self.path.weights > 0.0]
        except SpecError:  # numbers that do not go together
            return np.full(len(self.measured.force), np.nan)

    @one_thread()
    def _forces(self, x: np.ndarray, size: int) -> np.ndarray:
        """Forces at all points of the path, as an instrument shows them; NaN from where the way is lost."""
        muscle, points, zero = self._at(x)
        if self.placement is None:
            self.placement = _placed(muscle, points)
        bench = Bench.of(muscle)
        problem = bench.problem(size, self.placement)
        found = np.full(len(points), np.nan)
        for which in dict.fromkeys(self.path.paths.tolist()):
            rows = np.flatnonzero(self.path.paths == which)
            found[rows] = self._walked(problem, bench.longest, which, points[rows])
        return found + zero

    def _walked(self, problem: Problem, longest: float, which: int, points: np.ndarray) -> np.ndarray:
        rest = float(problem.p.rest)
        path = [Held(("length", "pressure"), row) for row in ((rest, 0.0), (rest, float(points[0, 1])))]
        path += [Held(("length", "pressure"), (h, P)) for h, P in points.tolist()]
        known = self.shares.get(which)
        now = Going.as_made(problem)
        found, shares = np.full(len(points), np.nan), []
        for k, (begin, end) in enumerate(pairwise(path)):
            then = step_to(problem, now, begin, end, known[k] if known else ()) if end.values[0] < longest else None
            if then is None:
                return found
            now = then
            shares.append(now.shares)
            if k:
                found[k - 1] = now.present["force"]
        self.shares.setdefault(which, shares)
        return found


def _placed(muscle: Muscle, points: np.ndarray) -> float:
    bench = Bench.of(muscle)
    nothing = np.full(len(points), np.nan)
    return crowding(parameters(muscle), np.minimum(points[:, 0], NEARLY * bench.longest), nothing, points[:, 1])
