"""What must be known of a fit before its numbers are used, a sentence each."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from mckibben.fitting.free import Free
from mckibben.fitting.search import Least
from mckibben.fitting.together import AnyMisfit
from mckibben.fitting.uncertain import Spread, members

__all__ = ["notes_of", "notes_on"]

CLOSE = 0.98
"""Correlation from which on it is told."""
AT = 1e-3
"""Distance from a bound, over the range, at which a number counts as being there."""


def notes_of(free: tuple[Free, ...], best: Least, spread: Spread) -> list[str]:
    """Sentences on the numbers: what is open, what goes together, what is at a bound."""
    names = [one.name for one in free]
    notes = [] if best.converged else [f"the search was ended before it had settled: {best.message}"]
    for direction in spread.directions:
        own = [name for name, belongs in zip(names, members(direction).tolist(), strict=True) if belongs]
        if len(own) == 1:
            notes.append(f"the data say nothing of {own[0]} within its bounds: leave it out, or give a prior")
        else:
            together = " and ".join([", ".join(own[:-1]), own[-1]])
            notes.append(f"the data determine only a combination of {together}: free fewer of them, or give a prior")
    lost = spread.undetermined
    for (i, first), (j, second) in combinations(enumerate(names), 2):
        by = spread.correlation[i, j]
        if abs(by) > CLOSE and not (lost[i] or lost[j]):
            notes.append(
                f"{first} and {second} correlate at {by:.3f}: what the data say is a combination; "
                "free one of them, or give a prior"
            )
    for one, x in zip(free, best.x.tolist(), strict=True):
        if min(x, 1.0 - x) < AT:
            side, bound = ("lower", one.low) if x < 0.5 else ("upper", one.high)
            notes.append(f"{one.name} is at its {side} bound, {one.text(bound)}: its interval says little")
    return notes


def notes_on(misfit: AnyMisfit, best: Least, spread: Spread) -> list[str]:
    """The same, and what is assumed, not fitted, or odd in the forces."""
    names, notes = [one.name for one in misfit.free], notes_of(misfit.free, best, spread)
    taken = dict.fromkeys(name for muscle in misfit.muscles for name in muscle.assumed)
    assumed = [name for name in taken if not any(_covers(name, one) for one in names)]
    if assumed:
        notes.append("assumed, not fitted: " + ", ".join(assumed))
    signs = np.sign(misfit.measured.force)
    if (signs < 0.0).all():
        notes.append("all forces are negative: the muscle pushes, or the sign is the other way round")
    return notes


def _covers(field: str, name: str) -> bool:
    return name == field or name.startswith(f"{field}.")
