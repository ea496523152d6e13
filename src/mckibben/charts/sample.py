"""States of one muscle at lengths and pressures of its map, by the batches of sweeps; what these leave singly."""

from __future__ import annotations

import os
from collections.abc import Callable

import attrs
import jax
import numpy as np

from mckibben.experiments.run import run
from mckibben.measure.survey import survey
from mckibben.results.verdict import Verdict
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Isobaric, Muscle
from mckibben.spec.plausible import trusted
from mckibben.sweeps.batches import Solved, solve_together
from mckibben.sweeps.groups import grouped
from mckibben.sweeps.stiffness import stiffness_of

__all__ = ["KEPT", "Samples", "sample"]

KEPT = ("force", "volume", "energy", "largest_radius", "stiffness")
"""What is read off states; the stiffness of those alone for which it is asked."""

LOST = 0.2
"""Share of paths that may be left out."""


@attrs.frozen
class Samples:
    """States (paths, n), one pressure a path, each from its longest to its shortest length; SI units."""

    length: np.ndarray
    pressure: np.ndarray
    numbers: dict[str, np.ndarray]  #: by name; NaN where there is no stable state
    good: np.ndarray  #: whether a state is stable and admissible

    def __add__(self, other: Samples) -> Samples:
        """Both, as points in a row."""
        joined = [np.concatenate([one.ravel(), two.ravel()]) for one, two in zip(self.rows, other.rows, strict=True)]
        return Samples(joined[0], joined[1], dict(zip(KEPT, joined[3:], strict=True)), joined[2])

    @property
    def rows(self) -> list[np.ndarray]:
        """All of its arrays."""
        return [self.length, self.pressure, self.good, *(self.numbers[name] for name in KEPT)]

    @property
    def bad(self) -> int:
        """How many points have no stable state."""
        return int((~self.good).sum())

    def take(self, some: np.ndarray) -> Samples:
        """Some of the paths, or points."""
        numbers = {name: values[some] for name, values in self.numbers.items()}
        return Samples(self.length[some], self.pressure[some], numbers, self.good[some])


@one_thread()
def sample(
    muscle: Muscle,
    lengths: np.ndarray,
    pressures: np.ndarray,
    tolerance: float,
    singly: bool = True,
    watch: Callable[[int], None] = lambda done: None,
    stiff: int | None = None,
) -> Samples:
    """States at `lengths` (paths, n), the longest of each path first, and at its pressure.

    From path `stiff` on they have their stiffness too, where batches find them; elsewhere it is NaN.
    Paths that a batch does not follow are sought state by state, and left out (NaN for their lengths) where they are
    few; without `singly` they are left without states.
    """
    count, n = lengths.shape
    found = {name: np.full((count, n), np.nan) for name in KEPT}
    good, left = np.zeros((count, n), bool), np.ones(count, bool)
    with trusted():
        test = Isobaric(pressure=float(pressures[0]), length=lengths[0].tolist())
    group = grouped(muscle, test, {"test.pressure": pressures[:, None], "test.length": lengths}, np.arange(count))
    threads = 1 if os.environ.get("PJRT_NPROC") == "1" else os.cpu_count() or 1
    for left_out in (1.0, 0.0) if singly else (1.0,):  # the second way takes long
        if group is None or left.sum() <= (LOST * count if singly else 0.0):
            break
        for solved in solve_together(group.take(np.flatnonzero(left)), tolerance, threads=threads, left_out=left_out):
            fine = np.array([_stable(solved, d) for d in range(len(solved.group))])
            rows = solved.group.index
            good[rows], left[rows] = fine, False
            numbers = solved.numbers | {"stiffness": _stiffness(solved, count if stiff is None else stiff)}
            for name in KEPT:
                found[name][rows] = np.where(fine, numbers[name], np.nan)
    watch(int((~left).sum()))
    if singly and left.sum() <= LOST * count:
        lengths = np.where(left[:, None], np.nan, lengths)
        left[:] = False
    for k in np.flatnonzero(left).tolist() if singly else []:
        with trusted():
            one = run(muscle, Isobaric(pressure=float(pressures[k]), length=lengths[k].tolist()), tolerance=tolerance)
        good[k] = [verdict == Verdict.STABLE for verdict in one.verdict]
        for name in KEPT[:3]:
            found[name][k] = np.where(good[k], one.data[name].values, np.nan)
        found["largest_radius"][k] = np.where(good[k], one.data["r"].max("v").values, np.nan)
        left[k] = False
        watch(int((~left).sum()))
    return Samples(lengths, np.broadcast_to(pressures[:, None], lengths.shape), found, good)


def _stiffness(solved: Solved, first: int) -> np.ndarray:
    """dF/dh [N/m] at the states of the paths from one on (paths, n); NaN at those before."""
    found = np.full(solved.plain.shape, np.nan)
    some = np.flatnonzero(solved.group.index >= first)
    if len(some):
        found[some] = stiffness_of(solved, some)
    return found


def _stable(solved: Solved, d: int) -> np.ndarray:
    """Which states of one path are stable and admissible, judged as for a single run where that is in doubt."""
    if solved.plain[d].all():
        return np.ones(solved.plain.shape[1], bool)
    p = jax.tree.map(lambda values: np.asarray(values[d]), solved.group.p)
    problem = Problem.of(solved.line, p, float(solved.b[d]))
    seen = survey(problem, solved.state.u[d], solved.state.loads[d], solved.group.held)
    return np.array([judged.verdict == Verdict.STABLE for judged in seen.verdicts])
