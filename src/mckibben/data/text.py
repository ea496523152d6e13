"""The bytes of a text file → rows of cells: its encoding, its separator, its comments."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from pathlib import Path

from mckibben.spec.errors import SpecError

__all__ = ["MOST", "NUMERIC", "Row", "bytes_of", "decoded", "rows_of"]

Row = tuple[int, list[object]]
"""The number of a line in its file (the first is 1), and its cells."""
MOST = 256 * 2**20
"""Bytes of a file that are read: some million rows."""
NUMERIC = re.compile(r"[+\-−]?[\d.,'’\s]*\d[\d.,'’\s]*(?:[eE][+-]?\d+)?\s*%?")
"""A cell that is a number in some country's writing."""
_COMMENTS = ("#", "%", "//")
_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_SEPARATORS = ("\t", ";", ",", "|", " ")
"""In the order of trust where several fit equally well."""


def bytes_of(path: Path) -> bytes:
    """The content of a file; SpecError where it cannot be read, is empty or too large."""
    name = path.name or str(path)
    try:
        if path.is_dir():
            raise SpecError(name, allowed="is a folder", advice="give the name of a file, or a list of them")
        if path.stat().st_size > MOST:
            size = f"{path.stat().st_size / 2**20:.0f} MB"
            raise SpecError(name, allowed=f"is too large: {size}, at most {MOST // 2**20}", advice="thin it first")
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise SpecError(str(path), allowed="cannot be read: there is no such file") from error
    except (OSError, ValueError) as error:
        raise SpecError(str(path), allowed=f"cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if not content.strip():
        raise SpecError(name, allowed="is empty")
    return content


def decoded(content: bytes, name: str) -> tuple[str, str]:
    """The text of a file, and what had to be taken for granted to read it (maybe nothing)."""
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return _strictly(content, encoding, name), ""
    start = content[:4096]
    zeros = [start[k::2].count(0) for k in (0, 1)]
    if max(zeros) > 0.3 * len(start) / 2 and min(zeros) == 0:  # UTF-16 whose mark is missing: every other byte is 0
        return _strictly(content, "utf-16-be" if zeros[0] else "utf-16-le", name), ""
    strange = sum(byte < 32 and byte not in (9, 10, 11, 12, 13, 26, 27) for byte in start)
    if strange:
        raise _no_table(name)
    try:
        return content.decode("utf-8"), ""
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace"), "text taken as Latin-1 (Windows-1252): it is no UTF-8"


def _strictly(content: bytes, encoding: str, name: str) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        raise _no_table(name) from error


def _no_table(name: str) -> SpecError:
    return SpecError(name, allowed="is no table of text", advice="give a CSV, TSV or XLSX file")


def rows_of(text: str, name: str) -> tuple[list[Row], list[Row]]:
    """The rows of a text with at least one cell that is not empty, and those of its comments, cut the same way."""
    separator = _separator(text, name)
    rows: list[Row] = []
    comments: list[Row] = []
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
        line = 1
        for cells in reader:
            if any(cell.strip() for cell in cells):
                comment = cells[0].lstrip().startswith(_COMMENTS) and cells[0].strip() not in _COMMENTS[1:2]
                (comments if comment else rows).append((line, list(cells)))
            line = reader.line_num + 1
    except csv.Error as error:
        raise SpecError(f"{name}, line {reader.line_num + 1}", allowed=f"is no row of a table: {error}") from error
    return rows, [(line, [str(cells[0]).lstrip("#%/ "), *cells[1:]]) for line, cells in comments]


def _separator(text: str, name: str) -> str:
    """What separates the cells: with which the rows have most numbers, and more than one cell."""
    lines = [line for line in text[: 2**16].splitlines() if line.strip() and not line.lstrip().startswith(_COMMENTS)]
    sample = lines[:200][-100:]
    best, found = 0.0, ""
    for separator in _SEPARATORS:
        rows = list(csv.reader(sample, delimiter=separator, skipinitialspace=True))
        rows = [[cell for cell in row if separator != " " or cell] for row in rows]
        width, times = Counter(len(row) for row in rows).most_common(1)[0] if rows else (0, 0)
        cells = [cell.strip() for row in rows if len(row) == width for cell in row if cell.strip()]
        if width < 2 or not cells:
            continue
        share = sum(bool(NUMERIC.fullmatch(cell)) for cell in cells) / len(cells) * times / len(rows)
        if share > 1.05 * best:
            best, found = share, separator
    if not found:
        raise SpecError(name, allowed="is no table: no rows of several cells", advice="give a CSV, TSV or XLSX file")
    return found
