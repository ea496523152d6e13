"""What a browser asks to see, checked: a muscle, a pressure, and a load or a contraction beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import attrs

from mckibben.page.muscles import muscle_of
from mckibben.spec import Muscle, SpecError

__all__ = ["Asked", "asked_of"]

HOLDS = ("force", "contraction")
HIGHEST = 1e8
"""Pressures [Pa] and forces [N] of a page."""


@attrs.frozen
class Asked:
    """What a browser asks to see: a muscle, a pressure [Pa], and a force [N] or contraction that is held."""

    muscle: Muscle
    pressure: float
    hold: str
    value: float
    top: float  #: largest pressure of the curves [Pa]


def asked_of(said: Mapping[str, Any]) -> Asked:
    """What a browser says, checked. SpecError for whatever is wrong."""
    hold = said.get("hold")
    if hold not in HOLDS:
        raise SpecError("hold", hold, "must be force or contraction")
    top = _size("top", said, 0.0)
    if top <= 0.0:
        raise SpecError("top", top, "must be above 0")
    return Asked(muscle_of(said.get("muscle")), _size("pressure", said, 0.0), hold, _size("value", said, -1e9), top)


def _size(name: str, said: Mapping[str, Any], low: float) -> float:
    value = said.get(name)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= HIGHEST:
        raise SpecError(name, value, f"must be a number from {low:g} to {HIGHEST:g}, in SI units")
    return float(value)
