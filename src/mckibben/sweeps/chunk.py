"""Solving the designs of one chunk: a function of the chunk alone, so that it does not matter where or when it runs."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable

import jax
import numpy as np

from mckibben.experiments.run import MuscleWarning, run
from mckibben.measure.survey import survey
from mckibben.solver.path import INTERRUPTED
from mckibben.solver.problem import Problem
from mckibben.solver.threads import one_thread
from mckibben.spec import SpecError
from mckibben.sweeps.batches import Solved, solve_together
from mckibben.sweeps.groups import groups
from mckibben.sweeps.outcome import Columns, Kinds, Status, empty, keep, keep_plain, keep_states, refuse
from mckibben.sweeps.plan import Design, Piece

__all__ = ["solve_piece"]


@one_thread()
def solve_piece(piece: Piece, watch: Callable[[int], None] | None = None) -> Columns:
    """What is kept of each design of `piece`; `watch` is told how many are done.

    All designs that allow it advance together; those that are not followed cleanly are solved one at a time. A design
    whose values do not go together, or on which the program fails, says so in its own `status` and `reason`.
    """
    columns, left = empty(len(piece), piece.steps), np.ones(len(piece), bool)
    threads = 1 if os.environ.get("PJRT_NPROC") == "1" else os.cpu_count() or 1  # a worker has one core to itself
    tell = watch or (lambda done: None)
    for group in groups(piece):
        for solved in solve_together(group, piece.tolerance, threads=threads):
            _keep(columns, solved)
            left[solved.group.index] = False
    done = int((~left).sum())
    for k in np.flatnonzero(left).tolist():
        design = piece.design(k)
        if isinstance(design, SpecError):
            refuse(columns, k, Status.WRONG_INPUT, str(design))
        else:
            _singly(columns, k, design, piece.tolerance)
        done += 1
        tell(done)
    tell(done)
    return columns


def _keep(columns: Columns, solved: Solved) -> None:
    """Designs that a batch did: as they are where all is plain, else with verdicts as for a single run."""
    plain = solved.plain.all(axis=1)
    keep_plain(columns, solved.group.index, solved.numbers, solved.stable_loads, not solved.line.half)
    for d in np.flatnonzero(~plain).tolist():
        p = jax.tree.map(lambda values, d=d: np.asarray(values[d]), solved.group.p)
        problem = Problem.of(solved.line, p, float(solved.b[d]))
        seen = survey(problem, solved.state.u[d], solved.state.loads[d], solved.group.held)
        kinds = Kinds(
            [str(judged.verdict) for judged in seen.verdicts],
            [judged.reason for judged in seen.verdicts],
            np.array([modes.length_control for modes in seen.modes]),
            np.array([modes.force_control for modes in seen.modes]),
            np.array([-1 if modes.antisymmetric is None else modes.antisymmetric for modes in seen.modes]),
        )
        numbers = {name: values[d] for name, values in solved.numbers.items()}
        keep_states(columns, int(solved.group.index[d]), numbers, kinds)


def _singly(columns: Columns, k: int, design: Design, tolerance: float) -> None:
    """One design by the robust solver."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MuscleWarning)
            result = run(*design, tolerance=tolerance)
    except SpecError as error:
        refuse(columns, k, Status.WRONG_INPUT, str(error))
    except Exception as error:  # one design never spoils another
        refuse(columns, k, Status.FAILED, f"{type(error).__name__}: {error}")
    else:
        if result.status == INTERRUPTED:
            raise KeyboardInterrupt
        keep(columns, k, result)
