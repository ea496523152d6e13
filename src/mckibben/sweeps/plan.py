"""`Plan`: a base muscle and test, the fields varied, and design k of them; `Piece`: the designs of one chunk."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from typing import Any

import attrs
import numpy as np

from mckibben.spec import Muscle, SpecError, Test
from mckibben.spec.text import to_mapping
from mckibben.spec.vary import changed
from mckibben.sweeps.outcome import STATES
from mckibben.sweeps.varied import Varied, from_lists, from_table

__all__ = ["CHUNK", "Design", "Piece", "Plan", "plan", "versions"]

MOST = 100_000_000
"""Most designs of a sweep."""
RATE = 1_000
"""Designs a second and core, about, where all goes well: for a guess of the time."""
DESIGN_BYTES = 100
"""Bytes of a design beside its states, about."""
CHUNK = 512
"""Designs in a chunk by default."""
MADE_BY = ("mckibben", "jax", "jaxlib", "numpy")
"""Packages whose version may change the last bits of a number."""

Design = tuple[Muscle, Test]


@attrs.frozen
class Piece:
    """The designs of one chunk, complete in itself: this is what travels to a worker."""

    muscle: Muscle
    test: Test
    fields: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]  #: the value of each field, per design
    steps: int  #: states of every design
    tolerance: float

    def __len__(self) -> int:
        return len(self.rows)

    def design(self, k: int) -> Design | SpecError:
        """Design k; the error that says why where its values do not go together."""
        try:
            return changed(self.muscle, self.test, dict(zip(self.fields, self.rows[k], strict=True)))
        except SpecError as error:
            return error


@attrs.frozen
class Plan:
    """All designs of a sweep, made when they are asked for.

    In a grid the last field varies fastest. In a table the fields vary together, row by row.
    """

    muscle: Muscle
    test: Test
    varied: tuple[Varied, ...]
    table: bool
    tolerance: float
    chunk: int  #: designs in a chunk

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each field of a grid; of a table, the number of designs."""
        return (len(self.varied[0].values),) if self.table else tuple(len(varied.values) for varied in self.varied)

    def __len__(self) -> int:
        return math.prod(self.shape)

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-len(self) // self.chunk)

    @property
    def steps(self) -> int:
        """States of every design."""
        return sum(step.points for step in self.test.as_steps(self.muscle))

    @property
    def bytes(self) -> int:
        """Size of the results, in memory or on the disk."""
        each = sum(np.dtype(kept.dtype).itemsize for kept in STATES.values())
        return len(self) * (each * self.steps + DESIGN_BYTES)

    @property
    def said(self) -> str:
        """How many designs these are, and a rough guess of the time and the space they take."""
        days = len(self) / RATE / 86400.0
        time = (
            f"{days / 365.25:,.0f} years" if days > 730 else f"{days:,.0f} days" if days > 3 else f"{24 * days:.2g} h"
        )
        count = f"{len(self):,} designs of {self.steps} states"
        return f"{count}, some {time} at {RATE:,} designs a second and {self.bytes / 1e9:,.3g} GB"

    def within(self, index: int) -> slice:
        """The designs of a chunk."""
        return slice(index * self.chunk, min((index + 1) * self.chunk, len(self)))

    def size(self, index: int) -> int:
        """Number of designs in a chunk; the last may be smaller."""
        return len(range(*self.within(index).indices(len(self))))

    def row(self, k: int) -> tuple[Any, ...]:
        """What each field is in design k."""
        if self.table:
            return tuple(varied.values[k] for varied in self.varied)
        places = []
        for size in reversed(self.shape):
            k, place = divmod(k, size)
            places.append(place)
        return tuple(varied.values[at] for varied, at in zip(self.varied, reversed(places), strict=True))

    def design(self, k: int) -> Design:
        """Design k. SpecError if its values do not go together."""
        fields = (varied.field for varied in self.varied)
        return changed(self.muscle, self.test, dict(zip(fields, self.row(k), strict=True)))

    def piece(self, index: int) -> Piece:
        """The designs of a chunk."""
        rows = tuple(self.row(k) for k in range(*self.within(index).indices(len(self))))
        fields = tuple(varied.field for varied in self.varied)
        return Piece(self.muscle, self.test, fields, rows, self.steps, self.tolerance)

    def identity(self) -> dict[str, Any]:
        """All that the numbers depend on, as plain values: two sweeps with the same are the same."""
        over: Any = {varied.field: varied.plain for varied in self.varied}
        if self.table:
            text = json.dumps(list(over.values()))
            over = {"sha256": hashlib.sha256(text.encode()).hexdigest()}
        return {
            "muscle": to_mapping(self.muscle, allow_custom=True),
            "test": to_mapping(self.test),
            "fields": [varied.field for varied in self.varied],  # the last varies fastest
            "designs" if self.table else "over": over,
            "count": len(self),
            "tolerance": self.tolerance,
            "chunk": self.chunk,
            "versions": versions(),
        }


@cache
def versions() -> dict[str, str]:
    """Versions of what makes the numbers, on this machine."""
    return {name: version(name) for name in MADE_BY}


def plan(
    muscle: Muscle,
    test: Test,
    over: Mapping[str, Any] | None = None,
    designs: Any = None,
    *,
    tolerance: float = 1e-6,
    chunk: int | None = None,
) -> Plan:
    """The designs of a full grid (`over`) or of a table (`designs`). SpecError for a value that is wrong by itself."""
    if (over is None) == (designs is None):
        raise SpecError("sweep", allowed="must be given either over or designs")
    size = CHUNK if chunk is None else chunk
    if isinstance(size, bool) or not isinstance(size, int) or size < 1:
        raise SpecError("chunk", chunk, "must be a whole number of designs, at least 1")
    varied = from_table(muscle, test, designs) if over is None else from_lists(muscle, test, over)
    made = Plan(muscle, test, varied, over is None, float(tolerance), size)
    if len(made) > MOST:
        raise SpecError("sweep", allowed=f"{made.said}: at most {MOST:,} are taken", advice="vary fewer values")
    return made
