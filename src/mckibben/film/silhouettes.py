"""The silhouettes of a muscle at the lengths and pressures of frames, each solved."""

from __future__ import annotations

import os

import attrs
import jax
import numpy as np

from mckibben.experiments.solve import solve
from mckibben.measure.survey import survey
from mckibben.results.verdict import Verdict
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import Isobaric, Muscle, SpecError
from mckibben.spec.declared import evolved
from mckibben.spec.plausible import trusted
from mckibben.sweeps.batches import Solved, solve_together
from mckibben.sweeps.groups import grouped
from mckibben.sweeps.lines import lines_of

__all__ = ["Silhouette", "silhouettes"]

TOLERANCE = 1e-4
"""Of the solver: far below what a picture shows."""
SINGLY = 24
"""States that batches leave, up to which each is sought on its own, which takes long."""


@attrs.frozen(eq=False)
class Silhouette:
    """A silhouette: the meridian of the braid, from one fitting to the other."""

    z: np.ndarray  #: height from the first fitting [m]
    r: np.ndarray  #: radius [m]


@one_thread()
def silhouettes(
    muscle: Muscle, lengths: np.ndarray, pressures: np.ndarray, wanted: np.ndarray
) -> tuple[Silhouette | None, ...]:
    """One for each length [m] and gauge pressure [Pa] that is wanted; None where there is no stable state.

    Friction at the crossings is left out: with it the shape depends on the path.
    """
    frictionless = evolved(muscle, friction=None)
    states, where = np.unique(np.stack([lengths, pressures], axis=1)[wanted], axis=0, return_inverse=True)
    found: list[Silhouette | None] = [None] * len(states)
    if len(states):
        left = _together(frictionless, states, found)
        for k in left if len(left) <= SINGLY else []:
            found[k] = _alone(frictionless, *states[k].tolist())
    answer: list[Silhouette | None] = [None] * len(lengths)
    for frame, k in zip(np.flatnonzero(wanted).tolist(), where.ravel().tolist(), strict=True):
        answer[frame] = found[k]
    return tuple(answer)


def _together(muscle: Muscle, states: np.ndarray, found: list[Silhouette | None]) -> list[int]:
    """States by batches, put into `found`; those that are left."""
    with trusted():
        test = Isobaric(pressure=float(states[0, 1]), length=[float(states[0, 0])])
    values = {"test.length": states[:, :1], "test.pressure": states[:, 1:]}
    left = set(range(len(states)))
    group = grouped(muscle, test, values, np.arange(len(states)))
    if group is None:
        return sorted(left)
    threads = 1 if os.environ.get("PJRT_NPROC") == "1" else os.cpu_count() or 1
    for solved in solve_together(group, TOLERANCE, threads=threads):
        lines = lines_of(solved)
        for d, k in enumerate(solved.group.index.tolist()):
            left.discard(k)
            if _stable(solved, d):
                found[k] = Silhouette(lines["z"][d, 0] - lines["z"][d, 0, 0], lines["r"][d, 0])
    return sorted(left)


def _stable(solved: Solved, d: int) -> bool:
    """Whether a state is stable and admissible, judged as for a single run where that is in doubt."""
    if solved.plain[d].all():
        return True
    p = jax.tree.map(lambda values: np.asarray(values[d]), solved.group.p)
    seen = survey(
        Problem.of(solved.line, p, float(solved.b[d])), solved.state.u[d], solved.state.loads[d], solved.group.held
    )
    return all(judged.verdict == Verdict.STABLE for judged in seen.verdicts)


def _alone(muscle: Muscle, length: float, pressure: float) -> Silhouette | None:
    try:
        with trusted():
            state = solve(muscle, length=length, pressure=pressure, tolerance=TOLERANCE)
    except SpecError:  # beyond full extension, say: there is no such state
        return None
    if state.verdict != Verdict.STABLE:
        return None
    z, r = (np.asarray(state.result.column(name)[0]) for name in ("z", "r"))
    return Silhouette(z - z[0], r)
