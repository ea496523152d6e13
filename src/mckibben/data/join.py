"""The data of several files as one dataset."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from mckibben.data.thin import ARRAYS
from mckibben.data.values import Data
from mckibben.spec.errors import SpecError

__all__ = ["joined"]


def _numbered(names: Sequence[str]) -> list[str]:
    """Names of which those that come again have a number."""
    return [f"{name} ({names[:k].count(name) + 1})" if name in names[:k] else name for k, name in enumerate(names)]


def joined(parts: Sequence[Data]) -> Data:
    """The data of several files as one; equal names of tests are told apart by their files."""
    first = parts[0]
    if len(parts) == 1:
        return first
    kinds = {part.measured: part.source for part in parts}
    if len(kinds) > 1:
        listed = ", ".join(f"{kind} in {source}" for kind, source in kinds.items())
        raise SpecError("read_data", allowed=f"the files measured different things: {listed}", advice="read each alone")
    names = [name for part in parts for name in part.tests]
    if len(set(names)) < len(names):
        parts = [attrs.evolve(p, tests=tuple(f"{Path(p.source).stem}, {name}" for name in p.tests)) for p in parts]
        names = _numbered([name for part in parts for name in part.tests])
    starts = np.cumsum([0, *(len(part.tests) for part in parts)])

    def whole(name: str) -> Any:
        arrays = [getattr(part, name) for part in parts]
        if all(array is None for array in arrays):
            return None
        missing = [np.full(len(part), np.nan) if a is None else a for part, a in zip(parts, arrays, strict=True)]
        return np.concatenate(missing)

    arrays = {name: whole(name) for name in ARRAYS if name != "which"}
    return Data(
        source=", ".join(part.source for part in parts), tests=tuple(names), measured=first.measured,
        which=np.concatenate([part.which + start for part, start in zip(parts, starts, strict=False)]),
        assumptions=tuple(dict.fromkeys(note for part in parts for note in part.assumptions)), **arrays,
    )  # fmt: skip
