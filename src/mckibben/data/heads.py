"""The head of a column as people write it: which quantity it names, and in which unit."""

from __future__ import annotations

import re
from functools import lru_cache

import attrs

from mckibben.data.quantities import ABSOLUTE, GAUGE, LABELS, OTHER, QUANTITIES
from mckibben.units import is_unit

__all__ = ["Head", "read_head", "unit_of"]

_PLAIN = frozenset(
    ("N", "mN", "kN", "kg", "kgf", "gf", "lb", "lbf", "g", "m", "cm", "mm", "um", "µm", "inch", "Pa", "hPa", "kPa",
     "MPa", "bar", "mbar", "psi", "atm", "barg", "bara", "psig", "psia", "%", "percent", "pct", "s", "ms", "min")
)  # fmt: skip
"""Units that are taken as such without brackets: "length_mm"."""
_BRACKETS = re.compile(r"\[([^\[\]]*)\]|\(((?:[^()]|\([^()]*\))*)\)")
_REFERRED = re.compile(
    r"(bar|mbar|psi|h?Pa|kPa|MPa|atm)[\s_]*\(?(absolute|abs|a|gauge|gage|g|relative|rel)\)?", re.IGNORECASE
)
"""A unit of pressure with what it is measured from: "bara", "psig", "bar (abs)"."""
_ALIASES = {
    "percent": "%", "pct": "%", "-": "1", "": "1", "Newton": "N", "Newtons": "N", "MM": "mm", "CM": "cm",
    "BAR": "bar", "PSI": "psi", "PA": "Pa", "KPA": "kPa", "kpa": "kPa", "MPA": "MPa", "Mpa": "MPa",
    "KG": "kg", "Kg": "kg", "KN": "kN",
}  # fmt: skip
"""Units as they are written in heads, where they would be another or none: "MM" is a molarity."""


@attrs.frozen
class Head:
    """A head: as it is written, its words in lower case, and its unit, empty where none is said."""

    text: str
    words: tuple[str, ...]
    unit: str
    absolute: bool | None = None
    """Of a pressure: whether the head says "absolute" (True) or "gauge" (False)."""

    @property
    def name(self) -> str:
        """The words as one text, without the unit."""
        return " ".join(self.words)

    @property
    def readings(self) -> tuple[str, ...]:
        """The quantities and labels that the head may name."""
        before = self.words
        for cut in ("at", "@", "for", "bei"):  # "force at 600 kPa" is no pressure
            before = before[: before.index(cut)] if cut in before[1:] else before
        if OTHER & set(before):
            return ()
        found = [name for name, about in QUANTITIES.items() if self._named(before, about.words, about.letters)]
        for special in ("rest_length", "free_length"):
            found = [name for name in found if name != "length" or special not in found]
        return (*found, *(name for name, words in LABELS.items() if not found and self._named(before, words, ())))

    @staticmethod
    def _named(said: tuple[str, ...], words: tuple[str, ...], letters: tuple[str, ...]) -> bool:
        return said in [(letter,) for letter in letters] or any(set(word.split()) <= set(said) for word in words)


@lru_cache(maxsize=256)
def unit_of(written: str) -> tuple[str, bool | None]:
    """A unit as people write it, as one that is known, and whether it says absolute (True) or gauge (False)."""
    clean = " ".join(written.split()).strip("[]() ") if written.strip()[:1] in "[(" else " ".join(written.split())
    if clean in _ALIASES:
        return _ALIASES[clean], None
    found = _REFERRED.fullmatch(clean)
    if found and clean not in ("Pa", "hPa", "kPa", "MPa"):  # their own "a" is no "absolute"
        return _cased(found[1]), found[2].lower() in ABSOLUTE | {"a"}
    return _cased(clean), None


def _cased(unit: str) -> str:
    """The unit, in small letters where it is none as written and then one: "Bar"."""
    return _ALIASES.get(unit) or unit.lower() if not is_unit(unit) and is_unit(unit.lower()) else unit


@lru_cache(maxsize=1024)
def read_head(text: str, below: str = "") -> Head:
    """Read a head; `below` is what a row of units says under it.

    "Force [N]", "pressure (bar)", "length_mm", "Load, N" and "F / N" have their unit in them.
    """
    line = " ".join(text.split())
    name, written = line, below.strip()
    for found in reversed(list(_BRACKETS.finditer(line))):
        inner = found[1] if found[1] is not None else found[2]
        if found[1] is not None or inner.strip() in ("", "-") or is_unit(unit_of(inner)[0]):
            name = f"{line[: found.start()]} {line[found.end() :]}"
            written = written or inner.strip() or "1"
            break
    else:
        tail = re.fullmatch(r"(.+?)(?:\s*/\s*|\s+in\s+|\s*,\s*)(\S+)", line)
        if tail and tail[2] in _PLAIN:
            name, written = tail[1], written or tail[2]
    parts = [part for part in re.split(r"[\s_/.,;:()\[\]-]+", name) if part]
    for part in parts[1:] if not written else ():
        if part in _PLAIN:
            written = part
            parts.remove(part)
            break
    words = tuple(part.lower() for part in _uncamelled(parts))
    unit, absolute = unit_of(written) if written else ("", None)
    if absolute is None and set(words) & (ABSOLUTE | GAUGE):
        absolute = bool(set(words) & ABSOLUTE)
    return Head(line, words, unit, absolute)


def _uncamelled(parts: list[str]) -> list[str]:
    """Words that were written as one: "LoadCell"."""
    return [word for part in parts for word in re.split(r"(?<=[a-z])(?=[A-Z])", part)]
