"""What is said above and below the pictures of a result."""

from __future__ import annotations

from typing import Any

import numpy as np

from mckibben.results.result import Result
from mckibben.spec import BlockedForce, FreeContraction, Muscle, Path, Protocol
from mckibben.units import show

__all__ = ["headline", "lost", "sentence", "title"]


def title(muscle: Muscle) -> str:
    """The muscle by its name."""
    return f'Muscle "{muscle.name}"' if muscle.name else "Muscle without a name"


def headline(result: Result) -> str:
    """A line that names the muscle, the test and what is held."""
    test = result.test
    held = _held(test)
    if isinstance(test, Protocol):
        steps = (", ".join(f"{name} {path}" for name, path in _paths(step).items()) for step in test.steps)
        held = "; ".join(f"{k} {said}" for k, said in enumerate(steps, 1))
    if isinstance(test, BlockedForce) and test.length is None:
        held = f"length {show(result.muscle.rest_length, 'm')}"
    if isinstance(test, FreeContraction):
        held = "force 0 N"
    return f"{title(result.muscle)}: {test.kind} test" + (f", {held}" if held else "")


def lost(result: Result) -> str:
    """Which states have no values and why, in a sentence; empty where all have."""
    missing = np.flatnonzero(~np.isfinite(result.column("length")))
    if not len(missing):
        return ""
    reason = str(result.column("reason")[missing[0]])
    return f"{len(missing)} of {len(result)} states have no values, from state {missing[0]} on: {reason}."


def sentence(line: str) -> str:
    """A note of a result as a sentence."""
    return f"{line[:1].upper()}{line[1:]}."


def _paths(test: Any) -> dict[str, Path]:
    """What a test controls, by name."""
    paths = ((name, getattr(test, name, None)) for name in ("length", "force", "pressure", "volume"))
    return {path.called(name): path for name, path in paths if path is not None}


def _held(test: Any) -> str:
    return ", ".join(f"{name} {path}" for name, path in _paths(test).items() if not path.varies)
