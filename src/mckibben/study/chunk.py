"""Solving the designs of one chunk: a function of the chunk alone, so that it does not matter where or when it runs."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable

import numpy as np

from mckibben.experiment import MuscleWarning, run
from mckibben.fleet import Ask, Curve, ask, solve_together
from mckibben.model.chamber import law_of
from mckibben.model.parameters import parameters
from mckibben.solver.path import INTERRUPTED
from mckibben.solver.problem import Problem, Space
from mckibben.spec import Muscle, SpecError, Test
from mckibben.study.designs import Piece
from mckibben.study.outcome import Columns, Kinds, Status, empty, keep, keep_curve, refuse
from mckibben.survey import survey

__all__ = ["solve"]


def solve(piece: Piece, watch: Callable[[int], None] | None = None) -> Columns:
    """What is kept of each design of `piece`; `watch` is told how many are done.

    All designs that allow it advance together; those that are not followed cleanly are solved one at a time. A design
    whose values do not go together, or on which the program fails, says so in its own `status` and `reason`.
    """
    columns, designs = empty(len(piece), piece.steps), list(piece.designs())
    threads = 1 if os.environ.get("PJRT_NPROC") == "1" else os.cpu_count() or 1  # a worker has one core to itself
    curves = solve_together([_ask(design) for design in designs], piece.tolerance, threads=threads)
    done = sum(curve is not None for curve in curves)
    for k, (design, curve) in enumerate(zip(designs, curves, strict=True)):
        if isinstance(design, SpecError):
            refuse(columns, k, Status.WRONG_INPUT, str(design))
        elif curve is not None:
            keep_curve(columns, k, curve.numbers, _kinds(design[0], curve))
            continue
        else:
            _singly(columns, k, *design, piece.tolerance)
        done += 1
        if watch is not None:
            watch(done)
    if watch is not None:
        watch(done)
    return columns


def _ask(design: tuple[Muscle, Test] | SpecError) -> Ask | None:
    """The design as a batch takes it; the single solver says what is wrong with one that cannot even be asked for."""
    if isinstance(design, SpecError):
        return None
    try:
        return ask(*design)
    except (SpecError, ValueError, ArithmeticError):
        return None


def _kinds(muscle: Muscle, curve: Curve) -> Kinds:
    """Verdicts and modes: plain where a batch has seen that, else as for a single run."""
    n = len(curve.plain)
    zero = np.zeros(n, int)
    kinds = Kinds(["stable"] * n, ["stable"] * n, zero, np.where(curve.stable_loads, 0, 1), zero)
    if curve.plain.all():
        return kinds
    problem = Problem.of(Space(curve.line, law_of(muscle)), parameters(muscle), curve.b)
    u, F, P = curve.w[:, :-2], curve.w[:, -2], curve.w[:, -1]
    loads = np.stack([np.ones(n), F, P, np.zeros(n)], axis=1)
    seen = survey(problem, u, loads, curve.held)
    return Kinds(
        [str(judged.verdict) for judged in seen.verdicts],
        [judged.reason for judged in seen.verdicts],
        np.array([modes.length_control for modes in seen.modes]),
        np.array([modes.force_control for modes in seen.modes]),
        np.array([-1 if modes.antisymmetric is None else modes.antisymmetric for modes in seen.modes]),
    )


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
