"""The shape of a state as numbers from which a browser draws it: a meridian, and how the fibres run on it."""

from __future__ import annotations

from typing import Any

import numpy as np

from mckibben.page.plain import listed, number
from mckibben.results.result import Result
from mckibben.spec import Muscle
from mckibben.view.braid3d import Body, display_diameter, drawn_fibres, wall_made
from mckibben.view.tube import Tube

__all__ = ["as_made", "shape"]

POINTS = 61
"""Points along the meridian."""


def shape(result: Result, state: int = 0) -> dict[str, Any]:
    """The shape of one state, coloured by the tension of its fibres; lengths in m, tension in N."""
    body = Body.of(result, state)
    tension = result.column("fibre_tension")[state]
    return _told(body.tube, body.diameter, body.fibres, tension, body.wall)


def as_made(muscle: Muscle) -> dict[str, Any]:
    """The shape of the muscle as made, which nothing pulls."""
    tube = Tube.cylinder(muscle)
    made = wall_made(muscle)
    wall = None if made is None else np.full(len(tube.v), made)
    return _told(tube, display_diameter(muscle), drawn_fibres(tube), None, wall)


def _told(tube: Tube, diameter: float, fibres: int, tension: Any, wall: Any) -> dict[str, Any]:
    even = np.interp(np.linspace(0.0, 1.0, POINTS), np.linspace(0.0, 1.0, len(tube.even())), tube.even())
    r, z = tube.at(even)
    at = {name: np.interp(even, tube.v, values) for name, values in (("tension", tension), ("wall", wall))
          if values is not None}  # fmt: skip
    return {
        "r": listed(r),
        "z": listed(z),
        "turn": listed(tube.turned(even)),  # by how far a fibre has gone round [rad]
        "fibres": fibres,
        "drawn": fibres == tube.fibres,
        "diameter": number(diameter),
        "rest": number(tube.R0),
        "tension": listed(at["tension"]) if "tension" in at else None,
        "wall": listed(at["wall"]) if "wall" in at else None,
    }
