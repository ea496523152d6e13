"""Cells → numbers: decimal commas, thousands, and what stands where a number is missing."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from numbers import Real

import numpy as np

from mckibben.spec.errors import SpecError

__all__ = ["decimal_mark", "numbers"]

_MISSING = frozenset(
    ("", "-", "--", "nan", "n/a", "na", "#n/a", "#na", "null", "none", "nil", "<na>", "nat", "missing")
)
_POINT = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_COMMA = re.compile(r"[+-]?(?:\d+,?\d*|,\d+)(?:[eE][+-]?\d+)?")
_THOUSANDS = {
    ".": re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?"),
    ",": re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*"),
}
"""Numbers with thousands marked, by their decimal mark: with a decimal comma only where the comma is there to tell."""
_SPACES = re.compile(r"(?<=\d)[\s'’](?=\d{3}(?!\d))")
"""What marks thousands beside commas and points: 1 234, 1'234."""


def decimal_mark(columns: Iterable[Sequence[object]], where: str) -> str:
    """The decimal mark of a table, "." or ",", from its columns of numbers; SpecError where it cannot be told."""
    doubtful = ""
    for cells in columns:
        for cell in cells:
            if not isinstance(cell, str) or "," not in cell:
                continue
            text = _SPACES.sub("", cell.strip()).replace("−", "-")
            if "." in text and _THOUSANDS["."].fullmatch(text):
                return "."
            if _THOUSANDS[","].fullmatch(text):
                return ","
            if _COMMA.fullmatch(text):
                if not _THOUSANDS["."].fullmatch(text) or text.lstrip("+-").startswith("0"):
                    return ","
                doubtful = doubtful or text
    if doubtful:
        said = f'"{doubtful}" may have a decimal comma or thousands marked'
        raise SpecError(where, allowed=said, advice='say decimal="," or decimal="." (--decimal)')
    return "."


def numbers(cells: Sequence[object], mark: str) -> tuple[np.ndarray, int | None]:
    """The numbers of a column (n), NaN where one is missing, and the place of the first cell that is something else."""
    plain = _POINT if mark == "." else _COMMA
    values = np.empty(len(cells))
    for place, cell in enumerate(cells):
        if isinstance(cell, str):
            text = cell.strip()
            if not plain.fullmatch(text):
                text = _SPACES.sub("", text).replace("−", "-")
                if _THOUSANDS[mark].fullmatch(text):
                    text = text.replace("," if mark == "." else ".", "")
                elif text.lower() in _MISSING:
                    text = "nan"
                elif not plain.fullmatch(text):
                    return values, place
            values[place] = float(text.replace(",", ".") if mark == "," else text)
        elif cell is None or type(cell).__name__ in ("NAType", "NaTType"):
            values[place] = math.nan
        elif isinstance(cell, Real) and not isinstance(cell, (bool, np.bool_)):
            values[place] = float(cell)
        else:
            return values, place
        if math.isinf(values[place]):
            return values, place
    return values, None
