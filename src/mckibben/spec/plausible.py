"""Bare numbers that are absurd in SI and plausible in the usual unit: 12.5 for a radius is 12.5 m, where mm was meant.

Only what a user gives as a bare number is doubted: "12.5 m" says what it says, and numbers that the program hands on
inside `trusted()` were read before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from numbers import Real
from typing import Any

import numpy as np

__all__ = ["CONTROLLED", "Doubt", "as_text", "reading", "trusted"]

Doubt = tuple[float, float]
"""From and up to (not including) which size a bare number in SI is doubted."""

CONTROLLED: dict[str, Doubt] = {"m": (10.0, 1e4), "Pa": (0.05, 50.0), "m^3": (1.0, 1e6)}
"""Doubts on controlled quantities by their SI unit: 115 m, 1 Pa, 40 m^3."""
_USUAL = {"m": "mm", "Pa": "bar", "m^3": "mL", "rad": "deg"}
_TYPED = 3
"""A small pressure is doubted only with as few digits as people type; a computed one has more."""

_TRUSTED: ContextVar[bool] = ContextVar("trusted", default=False)


@contextmanager
def trusted() -> Iterator[None]:
    """Numbers read inside come from the program and not from a user: none is doubted."""
    mark = _TRUSTED.set(True)
    try:
        yield
    finally:
        _TRUSTED.reset(mark)


def reading(given: Sequence[Any], unit: str, doubt: Doubt | None) -> str:
    """What was probably meant by bare numbers in an SI unit, as advice: '12.5 m? write "12.5 mm"'; empty if no doubt.

    Several values (a list) are doubted only where all that are not zero are.
    """
    if doubt is None or _TRUSTED.get():
        return ""
    bare = [float(x) for x in given if isinstance(x, Real) and not isinstance(x, (bool, np.bool_))]
    sizes = [size for size in map(abs, bare) if size > 0.0]
    if len(bare) < len(given) or not sizes or not all(doubt[0] <= size < doubt[1] for size in sizes):
        return ""
    first = next(x for x in bare if x)
    if unit == "Pa" and len(f"{max(sizes):.12g}".replace(".", "").strip("0")) > _TYPED:
        return ""
    return f'{first:.12g} {unit}? write "{first:.12g} {_USUAL[unit]}", or "{first:.12g} {unit}" if that is meant'


def as_text(number: float, unit: str, doubt: Doubt | None) -> float | str:
    """A number as it is written to a file: with its unit where a bare one would be doubted when it is read."""
    return f"{number!r} {unit}" if doubt is not None and doubt[0] <= abs(number) < doubt[1] else number
