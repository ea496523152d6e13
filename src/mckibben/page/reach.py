"""The working range of a muscle at a pressure: between which lengths it can be held."""

from __future__ import annotations

from typing import Any

from mckibben.experiments.limits import limits
from mckibben.page.asked import Asked
from mckibben.page.plain import number

__all__ = ["reach"]


def reach(asked: Asked) -> dict[str, Any]:
    """Shortest and longest length at the pressure that is asked for, and what limits them; SI units."""
    one = limits(asked.muscle, pressure=f"{asked.pressure!r} Pa")
    return {
        "pressure": number(one.pressure), "shortest": number(one.shortest), "longest": number(one.longest),
        "push": number(one.force_extremum), "cause": one.shortest_cause, "rest": number(asked.muscle.rest_length),
    }  # fmt: skip
