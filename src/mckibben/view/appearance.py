"""How a muscle is shown in space: which state, what colours it, what is opened, from where; checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral, Real
from typing import Any

import attrs
import numpy as np
from matplotlib import colormaps

from mckibben.results.result import Result, State
from mckibben.results.variables import FIELDS, has
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import show
from mckibben.view import style
from mckibben.view.braid3d import SECTOR, Body
from mckibben.view.projection import View
from mckibben.view.tube import Floats
from mckibben.view.words import title

PLAIN = "none"
"""The colour that says nothing."""
ON_CHAMBER = (
    "psi", "r", "z", "stretch_hoop", "stretch_axial", "stretch_thickness", "density_chamber", "share_chamber",
    "contact_pressure",
)  # fmt: skip
"""Fields that colour the chamber; all others colour the fibres."""
SIZES = {"horizontal": (1200, 600), "vertical": (700, 1000)}
"""Width and height of the window in pixels, of a muscle that lies or stands."""
SMALLEST, LARGEST = 100, 8000
"""Pixels of a picture's sides."""


@attrs.frozen
class Appearance:
    """How it is shown; what these are, `scene` says."""

    colour: str
    cut: bool
    translucent: bool
    ghost: bool
    view: View
    zoom: float
    size: tuple[int, int]  #: of the window in pixels

    @classmethod
    def of(
        cls, call: str, result: Result, colour: Any, cut: Any, translucent: Any, ghost: Any, axis: Any, tilt: Any,
        turn: Any, zoom: Any, size: Any,
    ) -> Appearance:  # fmt: skip
        """What was asked for; SpecError for what is no such thing."""
        known = [name for name in FIELDS if has(result.muscle, name)]
        if colour is None:
            colour = PLAIN
        if not isinstance(colour, str) or colour not in (*known, PLAIN):
            raise SpecError(f"{call}.colour", colour, "is unknown", nearest(str(colour), [*known, PLAIN]))
        if axis not in SIZES:
            raise SpecError(f"{call}.axis", axis, "is unknown", nearest(str(axis), SIZES))
        for name, value in {"tilt": tilt, "turn": turn}.items():
            if isinstance(value, bool) or not isinstance(value, Real) or not abs(float(value)) <= 360.0:
                raise SpecError(f"{call}.{name}", value, "must be a number from -360 to 360, in degrees")
        if isinstance(zoom, bool) or not isinstance(zoom, Real) or not 0.1 <= float(zoom) <= 100.0:
            raise SpecError(f"{call}.zoom", zoom, "must be a number from 0.1 to 100")
        pixels = SIZES[axis] if size is None else read_size(call, size)
        view = View(axis, float(tilt), float(turn))
        return cls(colour, bool(cut), bool(translucent), bool(ghost), view, float(zoom), pixels)

    def body(self, result: Result, state: int) -> Body:
        """What is drawn of a state; a muscle that is cut open is cut where the viewer stands, and somewhat above."""
        horizontal = self.view.axis == "horizontal"
        towards = -SECTOR / 2.0 + math.radians(12.0) if horizontal else 0.0
        return Body.of(result, state, towards - math.radians(self.view.turn) if self.cut else None)

    def on_chamber(self, result: Result) -> bool:
        """Whether the field colours the chamber and not the fibres."""
        return self.colour in ON_CHAMBER and result.muscle.chamber is not None

    def map(self, result: Result) -> Any:
        """The map from numbers to colours."""
        return colormaps[style.DENSITY_CHAMBER if self.on_chamber(result) else style.DENSITY_MESH]

    def values(self, result: Result, state: int) -> Floats | None:
        """The field that colours, along v, in the unit for people."""
        if self.colour == PLAIN:
            return None
        return np.asarray(style.shown(result.column(self.colour)[state], FIELDS[self.colour][0]), float)

    def label(self) -> str:
        """What the colours mean, with the unit for people."""
        unit, meaning = FIELDS[self.colour]
        return style.axis_label(meaning, unit)

    def limits(self, result: Result, states: Sequence[int]) -> tuple[float, float]:
        """The ends of the scale of colours over these states."""
        values = [self.values(result, state) for state in states]
        finite = np.concatenate([each[np.isfinite(each)] for each in values if each is not None] or [np.zeros(0)])
        if not len(finite):
            return 0.0, 1.0
        low, high = float(np.min(finite)), float(np.max(finite))
        if low == high == 0.0:
            return 0.0, 1.0
        least = 1e-6 * max(abs(low), abs(high))
        return (low, high) if high - low > least else (low - 50.0 * least, high + 50.0 * least)


def the_result(call: str, given: Any) -> Result:
    """The result that is to be shown; SpecError for what has no shape."""
    if isinstance(given, State):
        return given.result
    if not isinstance(given, Result):
        raise SpecError(call, given, "must be what run or solve gave, or a result that was loaded")
    return given


def reached(call: str, result: Result) -> list[int]:
    """The states that have a shape; SpecError where none has."""
    found = np.flatnonzero(np.isfinite(result.column("r")).all(axis=1)).tolist()
    if not found:
        said = f"none of the {len(result)} states was reached" if len(result) > 1 else "the state was not reached"
        reason = str(result.column("reason")[-1]) if len(result) else ""
        raise SpecError(call, allowed=f"{said}: {reason}" if reason else said)
    return found


def the_state(call: str, result: Result, state: Any) -> int:
    """The number of the state that is to be shown, of None the last that was reached."""
    shapes = reached(call, result)
    if state is None:
        return shapes[-1]
    whole = isinstance(state, Integral) and not isinstance(state, bool)
    if not whole or not -len(result) <= int(state) < len(result):
        raise SpecError(
            f"{call}.state", state, f"must be a whole number from 0 to {len(result) - 1}", "from the end: -1, -2 ..."
        )
    number = int(state) % len(result)
    if number not in shapes:
        there = ", ".join(map(str, shapes)) if len(shapes) <= 8 else f"{shapes[0]} to {shapes[-1]}"
        said = f"was not reached: {result.column('reason')[number]}"
        raise SpecError(f"{call}.state", state, said, f"there are shapes of the states {there}")
    return number


def head(result: Result, state: int) -> str:
    """What is shown, in a line."""
    name = title(result.muscle)
    numbers = ((result.length, "m"), (result.pressure, "Pa"), (result.force, "N"))
    said = ", ".join(show(float(values[state]), unit, 4) for values, unit in numbers)
    verdict = result.verdict[state]
    return f"{name}: {said}" + ("" if verdict == "stable" else f" ({verdict})")


def notes(result: Result, body: Body) -> list[str]:
    """What must be known of a picture: what is assumed in it, what is left out."""
    said = [style.assumption(result.muscle)]
    fibre = result.muscle.braid.fibre
    if fibre.diameter is None:
        said.append(f"Fibres are drawn {show(body.diameter, 'm', 2)} thick: their diameter is not given.")
    if body.fibres < body.tube.fibres:
        said.append(f"{body.fibres} of the {body.tube.fibres} fibres are drawn.")
    return [line for line in said if line]


def left_out(result: Result) -> str:
    """Which states have no shape, in a sentence; empty where all have one."""
    lost = len(result) - int(np.isfinite(result.column("r")).all(axis=1).sum())
    return f"{lost} of {len(result)} states were not reached and are left out." if lost else ""


def read_size(call: str, size: Any) -> tuple[int, int]:
    """Width and height of a picture in pixels; SpecError for what is none."""
    try:
        width, height = (int(side) if int(side) == side else -1 for side in size)
    except (TypeError, ValueError):
        width = height = -1
    if not all(SMALLEST <= side <= LARGEST for side in (width, height)):
        raise SpecError(
            f"{call}.size", size, f"must be width and height from {SMALLEST} to {LARGEST} pixels", "such as (1200, 800)"
        )
    return width, height
