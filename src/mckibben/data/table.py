"""A table as a file has it: heads, units, cells and the lines they stand in. Nothing is understood yet."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from mckibben.data.heads import Head, read_head, unit_of
from mckibben.data.matlab import columns_of_mat, is_mat
from mckibben.data.sheet import is_workbook, rows_of_sheet
from mckibben.data.text import NUMERIC, Row, bytes_of, decoded, rows_of
from mckibben.spec.errors import SpecError
from mckibben.units import is_unit

__all__ = ["Table", "table_of"]

_LOOKED_THROUGH = 300
"""Rows in which the heads are looked for."""


@attrs.frozen
class Table:
    """Columns with their heads.

    `lines` (rows) are the numbers of the rows in the file, from 1; `counted` is "line" for a text, "element" for
    vectors of a MAT file, else "row".
    """

    source: str
    heads: tuple[Head, ...]
    head_line: int
    columns: tuple[Sequence[object], ...] = attrs.field(repr=False)
    lines: np.ndarray = attrs.field(repr=False)
    counted: str = "line"
    notes: tuple[str, ...] = ()

    def place(self, row: int, column: int) -> str:
        """Where a cell stands, for people."""
        return f'{self.source}, {self.counted} {self.lines[row]}, column "{self.heads[column].text}"'

    @property
    def shown(self) -> str:
        """The heads, for people."""
        return ", ".join(f'"{head.text}"' for head in self.heads)


def table_of(given: Any, names: Iterable[str], sheet: str | int | None, header: int | None) -> Table:
    """The table in a file (its path) or a DataFrame; `names` are heads that the user speaks of."""
    if not isinstance(given, (str, PathLike)):
        return _of_frame(given)
    path = Path(given)
    content, name = bytes_of(path), path.name
    if is_mat(content, name):
        vectors, said = columns_of_mat(content, name, sheet)
        lines = np.arange(1, len(next(iter(vectors.values()))) + 1)
        return Table(name, tuple(map(read_head, vectors)), 0, tuple(vectors.values()), lines, "element", tuple(said))
    comments: list[Row] = []
    notes: tuple[str, ...] = ()
    if is_workbook(content):
        rows, counted = rows_of_sheet(content, name, sheet), "row"
    else:
        if sheet is not None:
            raise SpecError("sheet", sheet, f"{name} is a text and has no sheets", "leave it out")
        text, note = decoded(content, name)
        rows, comments = rows_of(text, name)
        notes, counted = tuple(filter(None, (note,))), "line"
    known = {_normal(name) for name in names}
    start, heads, line = _headed(rows, comments, known, header, name)
    return _filled(name, heads, line, rows[start:], counted, notes)


def _of_frame(frame: Any) -> Table:
    """The table of a pandas.DataFrame or a mapping of columns."""
    import pandas as pd

    if isinstance(frame, dict):
        frame = pd.DataFrame(frame)
    if not isinstance(frame, pd.DataFrame):
        raise SpecError("read_data", frame, "must be the path of a file, a list of them, or a pandas.DataFrame")
    if frame.empty:
        raise SpecError("table", allowed="is empty")
    heads = [" ".join(map(str, head)) if isinstance(head, tuple) else str(head) for head in frame.columns]
    columns = tuple(frame.iloc[:, k].tolist() for k in range(len(heads)))
    return Table("table", tuple(map(read_head, heads)), 0, columns, np.arange(1, len(frame) + 1), "row")


def _normal(text: str) -> str:
    return " ".join(str(text).split()).lower()


def _numeric(cell: object) -> bool:
    return bool(NUMERIC.fullmatch(cell.strip())) if isinstance(cell, str) else isinstance(cell, (int, float))


def _said(row: Row) -> list[str]:
    return [str(cell).strip() for cell in row[1]]


def _headed(
    rows: list[Row], comments: list[Row], known: set[str], header: int | None, name: str
) -> tuple[int, list[Head], int]:
    """Where the numbers begin, the heads above them, and the line of these.

    The heads are the first row of texts above rows with numbers in which something is understood; below it may be a row
    of units.
    """
    numeric = [any(_numeric(cell) for cell in cells) for _, cells in rows[:_LOOKED_THROUGH]]
    if header is not None:
        at = next((k for k, (line, _) in enumerate(rows) if line == header), None)
        if at is None:
            raise SpecError("header", header, f"is no line of {name} with anything in it", "the first line is 1")
        return _with_units(rows, numeric, at)
    fallback = None
    for k in range(len(numeric)):
        if numeric[k]:
            continue
        start, heads, line = _with_units(rows, numeric, k)
        if not all(numeric[start : start + 2]) or len([text for text in _said(rows[k]) if text]) < 2:
            continue
        if known & {_normal(text) for text in _said(rows[k])} or any(head.readings for head in heads):
            return start, heads, line
        fallback = fallback or (start, heads, line)
    if fallback:
        return fallback
    above = [row for row in comments if not rows or row[0] < rows[0][0]]
    if numeric[:1] == [True] and above and len(above[-1][1]) == len(rows[0][1]):  # "# pressure [bar], force [N]"
        return 0, [read_head(text) for text in _said(above[-1])], above[-1][0]
    if numeric[:1] == [True]:
        said = "has no row of heads: the first line holds numbers already"
        raise SpecError(name, allowed=said, advice='write one, such as "pressure [bar],length [mm],force [N]"')
    said = "has no rows of numbers below a row of heads"
    raise SpecError(name, allowed=said, advice="say header= (--header): the line of the heads")


def _with_units(rows: list[Row], numeric: list[bool], at: int) -> tuple[int, list[Head], int]:
    """Where the rows below the heads in row `at` begin, and the heads with the units of a row below them."""
    texts, units, start = _said(rows[at]), [], at + 1
    while start < len(numeric) and not numeric[start]:
        below = _said(rows[start])
        if not all(text in ("", "-") or is_unit(unit_of(text)[0]) for text in below):
            break
        units, start = below, start + 1
    units += [""] * (len(texts) - len(units))
    return start, [read_head(text, unit) for text, unit in zip(texts, units, strict=False)], rows[at][0]


def _filled(name: str, heads: list[Head], line: int, rows: list[Row], counted: str, notes: tuple[str, ...]) -> Table:
    """The table below the heads; a row that is too long is wrong, what a short one lacks is empty."""
    while heads and not heads[-1].text:
        heads = heads[:-1]
    width = len(heads)
    for number, cells in rows:
        if len(cells) > width and any(str(cell).strip() for cell in cells[width:]):
            said = f"has {len(cells)} cells, the heads (line {line}) are {width}"
            advice = "numbers with decimal commas need semicolons or tabs between them, or quotation marks"
            raise SpecError(f"{name}, {counted} {number}", allowed=said, advice=advice)
    columns = tuple([cells[k] if k < len(cells) else "" for _, cells in rows] for k in range(width))
    if not rows:
        raise SpecError(name, allowed="holds no rows below its heads")
    return Table(name, tuple(heads), line, columns, np.array([number for number, _ in rows]), counted, notes)
