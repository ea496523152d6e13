"""Force against contraction at some pressures, as lists of numbers: those of a datasheet."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from mckibben.page.asked import Asked
from mckibben.page.plain import listed, number
from mckibben.results.result import Result
from mckibben.sheet.levels import Ends, Fact, Level, curve, ends, stable
from mckibben.spec import Muscle

__all__ = ["curves", "levels_at", "pressures_with"]

LEVELS = (1.0 / 3.0, 2.0 / 3.0, 1.0)
"""Pressures of the curves that stay, over the largest; the present one is the fourth."""
SAME = 0.01
"""Share of the largest pressure by which two curves must differ."""
KEPT = 32
"""Curves that are kept, as for a load or a pressure that moves while the others stay."""
DIGITS = 7
"""Of the contractions at which curves end, which differ in the last ones by the way to them."""


def pressures_with(present: float, top: float) -> tuple[float, ...]:
    """Four rising gauge pressures [Pa] of which one is the present one."""
    levels = [level * top for level in LEVELS]
    near = [level for level in levels if abs(level - present) <= SAME * top]
    if near:  # always as many, or the curves would have to be compiled anew
        levels.remove(near[0])
        levels.append(LEVELS[0] / 2.0 * top)
    return tuple(sorted([*levels, present]))


def levels_at(muscle: Muscle, pressures: tuple[float, ...]) -> list[Level]:
    """The muscle at some rising pressures [Pa]."""
    both = _ends(muscle, pressures)
    return [both.level(k, _curve(muscle, P, both.first, round(both.end(k), DIGITS))) for k, P in enumerate(pressures)]


@lru_cache(maxsize=KEPT)
def _ends(muscle: Muscle, pressures: tuple[float, ...]) -> Ends:
    return ends(muscle, pressures)


@lru_cache(maxsize=KEPT)
def _curve(muscle: Muscle, pressure: float, first: float, end: float) -> Result:
    return curve(muscle, pressure, first, end)


def curves(asked: Asked) -> dict[str, Any]:
    """The curves, and what is read off them; SI units."""
    found = levels_at(asked.muscle, pressures_with(asked.pressure, asked.top))
    return {"levels": [_told(level, asked.pressure) for level in found]}


def _told(level: Level, present: float) -> dict[str, Any]:
    return {
        "pressure": number(level.pressure),
        "present": level.pressure == present,
        "contraction": listed(level.curve.contraction),
        "force": listed(level.curve.force),
        "good": stable(level.curve).tolist(),
        "blocked": _fact(level.blocked),
        "free": _fact(level.contraction),
        "length": _fact(level.length),
    }


def _fact(fact: Fact) -> dict[str, Any]:
    return {"value": number(fact.value), "reason": fact.reason}
