"""Friction at the crossings of a muscle that moves: what force lies between its sliding branches, by the path.

All crossings of a muscle together are one element that sticks up to its limit, and remembers by one number e: its force
is sqrt(S) e, its stored energy e^2 / 2, its limit the room f / sqrt(S), with f and S of the map (page of motion).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mckibben.motion.mapped import RubbingAt

__all__ = ["Rubbed", "rubbed"]

SHARP = 4
"""How sharply sticking ends: slipping goes with this power of the share of the limit that is reached."""
MOST = 2.0
"""Share of the limit up to which it does; a solver's error may lead beyond 1."""


class Rubbed(NamedTuple):
    """What rubbing crossings do at one time, SI."""

    force: float  #: beside that of the map [N]
    stored: float  #: [J]
    rate: float  #: of e [sqrt(J)/s]
    lost: float  #: power that becomes heat [W], never below 0


def rubbed(at: RubbingAt, length: float, pressure: float, speed: float, pressure_rate: float, e: float) -> Rubbed:
    """The element at a length and pressure that change at such rates."""
    found = at(length, pressure)
    root, share = math.sqrt(found.sticking), max(-MOST, min(e / found.room, MOST))
    limit_rate = found.room_by_length * speed + found.room_by_pressure * pressure_rate
    turning = root * speed
    towards = turning - share * limit_rate  # how fast the share grows, but for slipping, times the room
    slip = towards * abs(share) ** SHARP if towards * share > 0.0 else 0.0
    return Rubbed(root * e, 0.5 * e * e, turning - slip, e * slip)
