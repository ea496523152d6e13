"""Measured points over the curves of a muscle, and how far these are from them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from mckibben.data.compare import compare
from mckibben.data.read import read_data
from mckibben.data.sheet import filled_sheets, is_workbook
from mckibben.data.values import Data
from mckibben.page.asked import Asked
from mckibben.page.plain import listed, number
from mckibben.page.workbook import check_workbook
from mckibben.sheet.levels import curve
from mckibben.spec import SpecError

__all__ = ["data_of", "described", "measured", "sheets_of"]

TESTS = 8
"""Tests that are compared at most."""
POINTS = 200
"""Points of a branch that are drawn; of more, local means. Differences are of all points."""
STEADY = 0.02
"""Part of itself by which the pressure of a test may vary that is compared with a curve."""
WIDE = 1e-3
"""Contraction over which a curve goes at least."""


def data_of(said: Mapping[str, Any]) -> Data:
    """The measured points of a file, which goes by the name that its user gave it. SpecError for what is wrong."""
    return _read(said["path"], said["name"], said["sheet"])


@lru_cache(maxsize=4)
def _read(path: str, name: str, sheet: str) -> Data:
    _workbook(path, name)
    try:
        return read_data(path, sheet=sheet or None)
    except SpecError as error:
        field, allowed = (text.replace(Path(path).name, name) for text in (error.field, error.allowed))
        raise SpecError(field, error.value, allowed, error.advice) from error


def sheets_of(said: Mapping[str, Any]) -> list[str]:
    """The sheets of a workbook among which its user has to choose; empty where there is nothing to choose."""
    content = None if said["sheet"] else _workbook(said["path"], said["name"])
    found = [] if content is None else filled_sheets(content, said["name"])
    return found if len(found) > 1 else []


def _workbook(path: str, name: str) -> bytes | None:
    """The content of a workbook that may be read; None of another file."""
    content = Path(path).read_bytes()
    if not is_workbook(content):
        return None
    check_workbook(content, name)
    return content


def described(data: Data, name: str) -> dict[str, Any]:
    """What was read."""
    return {"name": name, "points": len(data), "tests": list(data.tests), "measured": data.measured,
            "assumptions": list(data.assumptions)}  # fmt: skip


def measured(asked: Asked, data: Data, name: str) -> dict[str, Any]:
    """The points of each test with the model's curve at its pressure, and the differences; SI units."""
    tests = [_test(asked, data[test], test) for test in data.tests[:TESTS]]
    return described(data, name) | {"compared": tests, "left": max(0, len(data.tests) - TESTS)}


def _test(asked: Asked, data: Data, name: str) -> dict[str, Any]:
    contraction = 1.0 - data.lengths(asked.muscle) / float(asked.muscle.rest_length)
    drawn = data.decimated(POINTS)
    told: dict[str, Any] = {
        "test": name,
        "contraction": listed(1.0 - drawn.lengths(asked.muscle) / float(asked.muscle.rest_length)),
        "force": listed(drawn.force),
        "curve": None,
        "said": "",
    }
    pressure = float(np.median(data.pressure))
    if np.ptp(data.pressure) > STEADY * abs(pressure):
        return told | {"said": "its pressure varies: drawn without a curve"}
    ends = float(contraction.min()), float(contraction.max())
    if ends[1] - ends[0] < WIDE:
        return told | {"said": "its length hardly varies: drawn without a curve"}
    result = curve(asked.muscle, pressure, *ends)
    found = compare(result, data)
    lines = {"contraction": listed(result.contraction), "force": listed(result.force)}
    told |= {"pressure": number(pressure), "curve": lines, "said": str(found), "count": len(found.x)}
    if len(found.x):
        told |= {"rms": number(found.rms), "largest": number(found.differences[found.worst])}
    return told
