"""Measured points in the panels of Fig. 4: read as the panel means them, and the model's differences from them."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import attrs
import numpy as np

from mckibben.data.branches import LOADING
from mckibben.data.compare import Comparison, difference, matching
from mckibben.data.read import read
from mckibben.data.values import Data
from mckibben.results.result import Result
from mckibben.spec import SpecError
from mckibben.units import to_si

__all__ = ["Measured", "measured_points", "read_measured"]

FORCE, STRAIN = "ab", "cd"
"""Cases whose panels show force, and change of length over the length before pressurisation."""


@attrs.frozen(eq=False)
class Measured:
    """Points of one panel: pressure [Pa], force [N] or change of length over length, and the model less these."""

    source: str
    pressure: np.ndarray
    value: np.ndarray
    branches: np.ndarray
    comparison: Comparison

    @property
    def said(self) -> str:
        """How far the model is from the points, in a sentence without its full stop."""
        return f"model less measured ({self.source}): {self.comparison}"


def read_measured(path: str | os.PathLike[str], case: str, length: str) -> Data:
    """The measured points of a case ("a" to "d") from a file as laboratories write them (`read_data`).

    What the file does not say is taken from the case: `length` held (a, b), no force (c, d). A file with the columns
    pressure (bar where it says no unit) and value is read as well: N, or change of length over length.
    """
    L = float(to_si(length, "m"))
    value, otherwise = ("force", {"length": L}) if case in FORCE else ("contraction", {"force": 0.0})
    old: dict[str, Any] = {"columns": {"pressure": "pressure", value: "value"}}
    if case in STRAIN:  # a change of length grows where a contraction falls
        old |= {"reverse": ("contraction",), "held": {"rest_length": L}}
    trouble: SpecError | None = None
    for options in ({}, old, old | {"units": {"pressure": "bar"}}):
        try:
            return read(path, otherwise, **options)
        except SpecError as error:
            if trouble is None or not error.field.startswith("columns."):  # it has the columns, so that this is wrong
                trouble = error
    assert trouble is not None
    raise trouble.renamed(f"measured.{case}: {trouble.field}")


def measured_points(data: Mapping[str, Data], cases: Mapping[str, Result], relaxed: Result) -> dict[str, Measured]:
    """The points of each panel, and what the model says there; SpecError where none belongs to the panel's curve."""
    return {
        name: _force(cases[name], points) if name in FORCE else _strain(cases[name], relaxed, points)
        for name, points in data.items()
    }


def _force(result: Result, data: Data) -> Measured:
    points = matching(result, data)
    rising = points.branches == LOADING
    found = difference(result.pressure, result.force, points.pressure, points.force, rising, "N", "Pa")
    return Measured(data.source, points.pressure, points.force, points.branches, found)


def _strain(result: Result, relaxed: Result, data: Data) -> Measured:
    """Change of length over the length L at which the muscle was pressurised."""
    points = matching(relaxed, data)
    L = float(result.length[np.flatnonzero(result.column("protocol_step") == 0)[-1]])
    strain = points.lengths(relaxed.muscle) / L - 1.0
    curve, rising = relaxed.length / L - 1.0, points.branches == LOADING
    found = difference(relaxed.pressure, curve, points.pressure, strain, rising, "1", "Pa")
    return Measured(data.source, points.pressure, strain, points.branches, found)
