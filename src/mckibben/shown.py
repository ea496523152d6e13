"""What a notebook shows of a value: whoever can draw it is told to this file, so that values need not know of pictures.

Notebooks ask a value for `_repr_html_`, and show its text where that is None.
"""

from collections.abc import Callable
from typing import Any

__all__ = ["Shown", "drawn_by"]

_drawing: list[Callable[[Any], str]] = []


def drawn_by(draw: Callable[[Any], str]) -> None:
    """From now on values are shown as the HTML that `draw` makes of them."""
    _drawing[:] = [draw]


class Shown:
    """A value that a notebook shows by more than its text."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        return _drawing[0](self) if _drawing else None
