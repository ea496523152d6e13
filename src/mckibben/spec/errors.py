"""`SpecError`: the error for anything wrong that a user gave, in one line that names the field and what to do."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable

__all__ = ["MISSING", "SpecError", "near", "nearest"]

LONGEST = 600
"""Characters of a field's name, and of what is said of it."""


class _Missing:
    """Marks that no value was given. None will not do: a user may have given it."""

    def __repr__(self) -> str:
        return "<missing>"

    def __reduce__(self) -> str:
        return "MISSING"  # there is only one, also after unpickling


MISSING = _Missing()


class SpecError(ValueError):
    """Invalid input, in one line that names the field, what was given, what is allowed and what to do.

    A ValueError. It is raised before anything is solved; that a muscle has no equilibrium is no error but a verdict.

    Args:
        field: dotted name of the field ("braid.angle", "test.pressure").
        value: what was given; left out if nothing was.
        allowed: what is allowed, or what is wrong, as a phrase.
        advice: what to do; may be empty.

    All four are attributes of the error.

    >>> try:
    ...     mk.presets.paper().replace("braid.angle", "95 deg")
    ... except mk.SpecError as error:
    ...     print(error.field, "|", error.allowed)
    braid.angle | must be above 0 deg and below 90 deg
    """

    def __init__(self, field: str, value: object = MISSING, allowed: str = "", advice: str = "") -> None:
        self.field, self.value, self.allowed, self.advice = field, value, allowed, advice
        given = "" if value is MISSING else f" = {_shown(value)}"
        said = "; ".join(part for part in (allowed, advice) if part)
        name = _shortened(field)
        super().__init__(_one_line(f"{name}{given}: {_shortened(said)}" if said else f"{name}{given}"))

    def renamed(self, field: str) -> SpecError:
        """The same error under another field name, as where a file calls `isometric.length` `test.length`."""
        return SpecError(field, self.value, self.allowed, self.advice)

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows: where the package noticed does not help."""
        return [f"{type(self).__name__}: {self}"]

    def __reduce__(self) -> tuple[type[SpecError], tuple[object, ...]]:
        return SpecError, (self.field, self.value, self.allowed, self.advice)


def _shortened(text: str) -> str:
    """Text without its middle where it is longer than any of ours, because a user's is part of it."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _shown(value: object) -> str:
    if isinstance(value, str):
        line = _one_line(value)
        return (line if len(line) <= 60 else line[:57] + "...") or '""'
    return _one_line(reprlib.repr(value))


def near(word: str, options: Iterable[str]) -> str:
    """Advice for a misspelt name: `did you mean "braid"?`, or empty when nothing is near."""
    from rapidfuzz import process  # only when something is misspelt

    match = process.extractOne(word[:100], list(options), score_cutoff=60)
    return "" if match is None else f'did you mean "{match[0]}"?'


def nearest(word: str, options: Iterable[str]) -> str:
    """Like `near`, but lists the options when nothing is near."""
    known = list(options)
    return near(word, known) or "choose from " + ", ".join(known)
