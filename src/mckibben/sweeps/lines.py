"""The meridians of states that were solved in batches, for those who ask: sweeps keep none."""

from __future__ import annotations

import numpy as np

from mckibben.measure.meridian import LINE, meridians_of, mirrored
from mckibben.solver.newton import batch_size
from mckibben.sweeps.batches import Solved
from mckibben.sweeps.paths import on_line

__all__ = ["lines_of"]


def lines_of(solved: Solved) -> dict[str, np.ndarray]:
    """Slope [rad], radius and height [m] of every state over the full length (designs, states, points), by `LINE`."""
    (count, n), size = solved.state.u.shape[:2], batch_size(solved.line.unknowns)
    which, u = np.repeat(np.arange(count), n), solved.state.u.reshape(count * n, -1)
    parts = []
    for at in range(0, count * n, size):
        some = which[at : at + size]
        rows = np.concatenate([u[at : at + size], np.repeat(u[at : at + 1], size - len(some), axis=0)])
        found = meridians_of(solved.line, on_line(solved.group.take(some), solved.b[some], solved.line), rows)
        parts.append([np.asarray(values)[: len(some)] for values in found])
    psi, r, z = (np.concatenate(columns).reshape(count, n, -1) for columns in zip(*parts, strict=True))
    return dict(zip(LINE, mirrored(psi, r, z) if solved.line.half else (psi, r, z), strict=True))
