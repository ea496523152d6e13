"""What a simulation needs of the map of a muscle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, runtime_checkable

__all__ = ["At", "Ends", "Mapped", "RubbingAt", "ends_of"]

At = Callable[[float, float], Any]
"""Length [m] and gauge pressure [Pa] -> force, volume, stiffness, volume_by_length and so on, as `Chart.at` has it."""
RubbingAt = Callable[[float, float], Any]
"""The same -> friction, sticking, room and its slopes, as `Chart.rubbing_at` has it where there is friction."""


@runtime_checkable
class Mapped(Protocol):
    """A map: what `chart` gives, or anything with the same functions."""

    @property
    def at(self) -> At: ...

    @property
    def pressures(self) -> tuple[float, float]: ...

    def lengths(self, pressure: Any) -> tuple[Any, Any]: ...

    def air_volume(self, length: Any, pressure: Any) -> Any: ...


class Ends(NamedTuple):
    """Shortest and longest length [m] of a map at a pressure."""

    low: float
    high: float


def ends_of(chart: Mapped, pressure: float) -> Ends:
    """Between which lengths a map is good at a gauge pressure [Pa]."""
    low, high = chart.lengths(min(max(pressure, chart.pressures[0]), chart.pressures[1]))
    return Ends(float(low), float(high))
