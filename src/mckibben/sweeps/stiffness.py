"""How stiff muscles are at states that were solved in batches: dF/dh at constant pressure, by the equations."""

from __future__ import annotations

import numpy as np

from mckibben.measure.many import stiffnesses
from mckibben.solver.held import rows_of
from mckibben.solver.newton import batch_size
from mckibben.solver.system import Unknowns
from mckibben.sweeps.batches import Solved
from mckibben.sweeps.paths import on_line

__all__ = ["stiffness_of"]


def stiffness_of(solved: Solved, some: np.ndarray) -> np.ndarray:
    """dF/dh [N/m] at the states of some of the designs (some, states), whose length and pressure are held."""
    n, size = solved.state.u.shape[1], batch_size(solved.line.unknowns)
    which = np.repeat(np.asarray(some), n)
    u, loads = (part[some].reshape(len(which), -1) for part in solved.state[:2])
    _, rows = rows_of(solved.group.held, loads.shape[1])
    found = []
    for at in range(0, len(which), size):
        here = which[at : at + size]
        short = size - len(here)
        state = Unknowns(
            *(np.concatenate([x[at : at + size], np.repeat(x[at : at + 1], short, axis=0)]) for x in (u, loads))
        )
        on = on_line(solved.group.take(here), solved.b[here], solved.line)
        found.append(np.asarray(stiffnesses(solved.line, on, state, rows))[: len(here)])
    return np.concatenate([*found, np.zeros(0)]).reshape(len(some), n)
