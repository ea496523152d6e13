"""What a notebook shows of a value: whoever can draw it is told to this file, so that values need not know of pictures.

Notebooks ask a value for `_repr_html_`, and show its text where that is None.
"""

import sys
from collections.abc import Callable
from typing import Any

__all__ = ["Shown", "drawn_by", "shown_as"]

_drawing: list[Callable[[Any], str]] = []


def drawn_by(draw: Callable[[Any], str]) -> None:
    """From now on values are shown as the HTML that `draw` makes of them."""
    _drawing[:] = [draw]


class Shown:
    """A value that a notebook shows by more than its text."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        return _drawing[0](self) if _drawing else None


def shown_as(kind: type, html: Callable[[Any], str | None], text: Callable[[Any], str | None]) -> None:
    """In IPython and its notebooks some values of a kind that is not the package's own are shown so from now on.

    Those of which `html` or `text` make None are shown as they were before. Elsewhere nothing happens.
    """
    found = sys.modules.get("IPython")
    shell = None if found is None else found.get_ipython()
    if shell is None:
        return
    formatters = shell.display_formatter.formatters
    before: dict[str, Any] = {}

    def as_html(value: Any) -> str | None:
        made = html(value)
        own = before["html"] or (lambda one: one._repr_html_() if hasattr(one, "_repr_html_") else None)
        return made if made is not None else own(value)

    def as_text(value: Any, printer: Any, cycle: bool) -> None:
        made = text(value)
        own = before["text"] or (lambda one, to, _: to.text(repr(one)))
        if made is None:
            own(value, printer, cycle)
        else:
            printer.text(made)

    before["html"] = formatters["text/html"].for_type(kind, as_html)
    before["text"] = formatters["text/plain"].for_type(kind, as_text)
