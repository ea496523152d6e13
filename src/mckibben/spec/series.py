"""A signal by its values at given times, as a file of a laboratory has them."""

from __future__ import annotations

from bisect import bisect_right
from enum import StrEnum
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import choice, quantities, spec
from mckibben.spec.signal import TINY, Signal, read_values
from mckibben.units import is_traced, show

__all__ = ["Between", "Series"]


class Between(StrEnum):
    """What a series of values is between two times."""

    LINE = "line"
    HOLD = "hold"


@spec("series")
class Series(Signal):
    """Values at given times, with straight lines between them or each held until the next.

    Before the first time it has the first value. It ends with its last time: a simulation may not be longer.

    Args:
        time: times [s], each after the one before.
        value: as many values.
        between: "line" or "hold".

    Raises:
        SpecError: for lists of different length, times that do not rise, or what is no number.

    >>> mk.Series(time=[0.0, 1.0, 2.0], value=[0.0, 1.0, -1.0])(0.5)
    0.5
    """

    kind: ClassVar[str] = "series"
    time: Reads[tuple[float, ...]] = quantities("s", meaning="times, each after the one before", size=(0.0, 1e6))
    value: Reads[tuple[Any, ...]] = declare(Declared(kind="values", read=read_values, meaning="as many values"))
    between: Reads[Between] = choice(Between, meaning="what the values are between the times", default=Between.LINE)

    def __attrs_post_init__(self) -> None:
        if len(self.time) != len(self.value):
            said = f"must be {len(self.time)} values, as many as there are times, not {len(self.value)}"
            raise SpecError("series.value", allowed=said)
        for k in range(1, len(self.time)):
            if not any(is_traced(one) for one in self.time[k - 1 : k + 1]) and not self.time[k] > self.time[k - 1]:
                said = f"must be after the time before, {show(self.time[k - 1], 's')}"
                raise SpecError(f"series.time[{k}]", show(self.time[k], "s"), said)

    @property
    def steady(self) -> bool:  # type: ignore[override]
        return self.between == Between.HOLD

    def __call__(self, t: float) -> float:
        k = bisect_right(self.time, t + TINY)
        if k == 0 or k == len(self.time) or self.between == Between.HOLD:
            return float(self.value[max(k - 1, 0)])
        t0, t1, a, b = self.time[k - 1], self.time[k], self.value[k - 1], self.value[k]
        return float(a + (b - a) * (t - t0) / (t1 - t0))

    def breaks(self, until: float) -> list[float]:
        return [t for t in self.time if t <= until]

    @property
    def end(self) -> float:
        return self.time[-1]
