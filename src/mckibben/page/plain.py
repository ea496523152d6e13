"""Numbers as JSON has them: few digits, None where there is none."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

__all__ = ["encoded", "listed", "number"]


def number(value: Any, digits: int = 12) -> float | None:
    """A number with so many digits; None for NaN and infinity."""
    value = float(value)
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None


def listed(values: Any, digits: int = 6) -> list[float | None]:
    """An array of numbers as a list."""
    return [number(value, digits) for value in np.asarray(values, float)]


def encoded(value: Any) -> str:
    """JSON in one line. ValueError for a number that JSON does not know."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
