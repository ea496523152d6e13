"""`Path`: one controlled quantity along a step, from what a user writes to its values at the points."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from mckibben.spec.plausible import CONTROLLED, as_text
from mckibben.units import Number, UnitError, is_traced, show, split, to_si

__all__ = ["Path", "PathMode"]


class PathMode(StrEnum):
    """How a path's numbers are meant."""

    CONSTANT = "constant"  # one value throughout
    RAMP = "ramp"  # from waypoint to waypoint
    RAMP_FROM_PRESENT = "ramp from present"  # from where the muscle is, through the waypoints
    HOLD = "hold"  # the present value
    LIST = "list"  # exactly these values


@attrs.frozen
class Path:
    """One quantity along a step: SI `waypoints`, how they are meant, and their unit.

    Waypoints are numbers that may be differentiated; mode and unit are choices.
    """

    waypoints: tuple[Number, ...]
    mode: PathMode = PathMode.CONSTANT
    unit: str = "1"

    @classmethod
    def parse(cls, value: Any, unit: str) -> Path:
        """Read what a user gave: a number or text (constant), "0 to 1 bar", "to 0 N", "hold", or a list of values.

        Raises UnitError for anything else.
        """
        if isinstance(value, Path):
            return value if value.unit == unit else attrs.evolve(value, unit=unit)
        if isinstance(value, str):
            return cls._from_text(value, unit)
        items = _items(value)
        if items is None:
            return cls((to_si(value, unit),), PathMode.CONSTANT, unit)
        if not items:
            raise UnitError("must hold at least one value")
        return cls(tuple(to_si(item, unit) for item in items), PathMode.LIST, unit)

    @classmethod
    def _from_text(cls, text: str, unit: str) -> Path:
        words = " ".join(text.split())  # the pattern below takes the square of the time for many spaces
        if words == "hold":
            return cls((), PathMode.HOLD, unit)
        pieces = [piece.strip() for piece in re.split(r"(?:^|\s+)to(?:\s+|$)", words)]
        if len(pieces) == 1:
            return cls((to_si(words, unit),), PathMode.CONSTANT, unit)
        from_present = pieces[0] == ""
        pieces = pieces[1:] if from_present else pieces
        if "" in pieces:
            raise UnitError('has a "to" without a value', 'write it like "0 to 1 bar", "to 0 N" or "hold"')
        # "0 to 1 bar": the unit of the last value serves the values that are bare numbers.
        shared = (split(pieces[-1]) or ("", ""))[1]
        bare = [(split(piece) or ("", "unread"))[1] == "" for piece in pieces]
        spelt = [f"{piece} {shared}" if b else piece for piece, b in zip(pieces, bare, strict=True)]
        mode = PathMode.RAMP_FROM_PRESENT if from_present else PathMode.RAMP
        return cls(tuple(to_si(piece, unit) for piece in spelt), mode, unit)

    @property
    def needs_present(self) -> bool:
        """Whether the values depend on where the muscle is when the step begins."""
        return self.mode in (PathMode.HOLD, PathMode.RAMP_FROM_PRESENT)

    @property
    def varies(self) -> bool:
        """Whether the path has more than one value."""
        return self.mode in (PathMode.RAMP, PathMode.RAMP_FROM_PRESENT, PathMode.LIST)

    @property
    def fewest_points(self) -> int:
        """The least number of points that visits every waypoint."""
        return len(self.waypoints) + (self.mode == PathMode.RAMP_FROM_PRESENT) if self.varies else 1

    def weights(self, points: int) -> NDArray[np.float64]:
        """Matrix W with values = W @ knots, knots being the waypoints (after the present value, if it is needed).

        Waypoints are hit exactly. The points are shared evenly among the legs of a ramp, and the first legs get those
        that are left over, so that two quantities with as many legs turn at the same points.
        """
        knots = len(self.waypoints) + self.needs_present
        if self.mode == PathMode.LIST and points != knots:
            raise ValueError(f"a path of {knots} listed values has {knots} points, not {points}")
        if points < self.fewest_points:
            raise ValueError(f"{points} points cannot visit {knots} values")
        if not self.varies:
            return np.ones((points, 1))
        legs = knots - 1
        if legs == 0:
            return np.ones((points, 1))
        share, left = divmod(points - 1, legs)
        counts = [share + (leg < left) for leg in range(legs)]
        at = np.concatenate([[0.0], *(leg + np.arange(1, n + 1) / n for leg, n in enumerate(counts))])
        result: NDArray[np.float64] = np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(knots)))
        return result

    def sample(self, points: int, present: float | None = None) -> NDArray[np.float64]:
        """The SI values at `points` points. `present` is needed by "hold" and "to ..."; ValueError without it.

        Where the waypoints are being differentiated, multiply `weights` with them instead.
        """
        if self.needs_present and present is None:
            raise ValueError(f'a path "{self}" needs the present value')
        first = () if not self.needs_present or present is None else (present,)
        return self.weights(points) @ np.asarray([*first, *self.waypoints], dtype=float)

    def to_plain(self) -> Any:
        """The path as a TOML value that reads back equal: an SI float, a list of them, or text with exact numbers."""
        numbers = [float(value) for value in self.waypoints]
        if self.mode in (PathMode.CONSTANT, PathMode.LIST):
            written = [as_text(number, self.unit, CONTROLLED.get(self.unit)) for number in numbers]
            return written if self.mode == PathMode.LIST else written[0]
        if self.mode == PathMode.HOLD:
            return "hold"
        lead = "to " if self.mode == PathMode.RAMP_FROM_PRESENT else ""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return lead + " to ".join(f"{number!r}{unit}" for number in numbers)

    def __str__(self) -> str:
        if self.mode == PathMode.HOLD:
            return "hold"
        percent = self.unit == "1" and not any(is_traced(value) for value in self.waypoints)
        texts = [f"{100.0 * x:.12g} %" if percent else show(x, self.unit, digits=12) for x in self.waypoints]
        if self.mode == PathMode.LIST:
            return ", ".join(texts)
        return ("to " if self.mode == PathMode.RAMP_FROM_PRESENT else "") + " to ".join(texts)

    def called(self, field: str) -> str:
        """What the field of this path is called by who gave it: a length without a unit is a contraction."""
        return "contraction" if field == "length" and self.unit == "1" else field

    def __repr__(self) -> str:
        return f"Path({str(self)!r})"


def _items(value: Any) -> list[Any] | None:
    """The values of a list, tuple, array or quantity of an array; None for a single value."""
    if isinstance(value, (list, tuple)):
        return list(value)
    if hasattr(value, "magnitude") and np.ndim(value.magnitude) == 1:
        return [item * value.units for item in value.magnitude]
    if (isinstance(value, np.ndarray) or is_traced(value)) and value.ndim == 1:
        return list(value)
    return None
