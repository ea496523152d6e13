"""Solving the designs of one chunk: a function of the chunk alone, so that it does not matter where or when it runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable

from mckibben.experiment import MuscleWarning, run
from mckibben.solver.path import INTERRUPTED
from mckibben.spec import Muscle, SpecError, Test
from mckibben.study.designs import Piece
from mckibben.study.outcome import Columns, Status, empty, keep, refuse

__all__ = ["solve"]


def solve(piece: Piece, watch: Callable[[int], None] | None = None) -> Columns:
    """What is kept of each design of `piece`; `watch` is told how many are done.

    A design whose values do not go together, or on which the program fails, says so in its own `status` and `reason`.
    """
    columns = empty(len(piece), piece.steps)
    for k, design in enumerate(piece.designs()):
        if isinstance(design, SpecError):
            refuse(columns, k, Status.WRONG_INPUT, str(design))
        else:
            _singly(columns, k, *design, piece.tolerance)
        if watch is not None:
            watch(k + 1)
    return columns


def _singly(columns: Columns, k: int, muscle: Muscle, test: Test, tolerance: float) -> None:
    """One design by the robust solver."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MuscleWarning)
            result = run(muscle, test, tolerance=tolerance)
    except SpecError as error:
        refuse(columns, k, Status.WRONG_INPUT, str(error))
    except Exception as error:  # whatever it is, it is the affair of this design alone
        refuse(columns, k, Status.FAILED, f"{type(error).__name__}: {error}")
    else:
        if result.status == INTERRUPTED:
            raise KeyboardInterrupt
        keep(columns, k, result)
