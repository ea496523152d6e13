"""The states of a result as rows of plain values: what tables, files and pictures of words are made from."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np

from mckibben.results.variables import EXTREMES, STEP, has
from mckibben.spec import Muscle

__all__ = ["COLUMNS", "States", "headed", "rows"]

COLUMNS = STEP | EXTREMES
"""Variables of a table: unit and meaning."""


@runtime_checkable
class States(Protocol):
    """What rows are made from: a `Result`."""

    @property
    def muscle(self) -> Muscle:
        """The specification."""

    def column(self, name: str) -> np.ndarray:
        """A variable as a plain array."""

    def __len__(self) -> int: ...


def rows(result: States) -> Iterator[dict[str, Any]]:
    """The variables of each state, and the extremes of its fields, as plain Python values in SI, None for NaN."""
    columns = {name: result.column(name).tolist() for name in STEP if has(result.muscle, name)} | _extremes(result)
    for state in range(len(result)):
        values = {name: column[state] for name, column in columns.items()}
        yield {name: None if value != value else value for name, value in values.items()}


def _extremes(result: States) -> dict[str, list[float]]:
    """`EXTREMES` of every state, NaN where there are none."""
    tension, strength = result.column("fibre_tension").max(axis=1), result.muscle.braid.fibre.breaking_force
    pulled = np.where(tension > 0.0, tension, np.nan)
    found = (2.0 * result.column("r").max(axis=1), tension, (np.nan if strength is None else strength) / pulled)
    return {name: values.tolist() for name, values in zip(EXTREMES, found, strict=True)}


def headed(name: str, unit: str) -> str:
    """The head of a column: its name, with the unit in brackets where it has one."""
    return f"{name} [{unit}]" if unit not in ("", "1") else name
