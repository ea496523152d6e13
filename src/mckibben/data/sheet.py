"""A sheet of a workbook (XLSX, XLS, ODS) → rows of cells."""

from __future__ import annotations

import io
from typing import Any

from mckibben.data.text import Row
from mckibben.spec.errors import SpecError, nearest

__all__ = ["filled_sheets", "is_workbook", "rows_of_sheet"]

_STARTS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
"""How workbooks begin: those of today are archives, those of old are OLE files."""


def is_workbook(content: bytes) -> bool:
    """Whether a file's content is that of a workbook, whatever its name."""
    return content.startswith(_STARTS)


def rows_of_sheet(content: bytes, name: str, sheet: str | int | None) -> list[Row]:
    """The rows of a sheet that are not empty, with their numbers; SpecError where several sheets could be meant."""
    sheets = _sheets(content, name)
    chosen = _chosen(sheet, list(sheets), _filled(sheets), name)
    return [
        (number, [_plain(cell) for cell in row])
        for number, row in enumerate(sheets[chosen], 1)
        if any(cell != "" for cell in row)
    ]


def filled_sheets(content: bytes, name: str) -> list[str]:
    """Names of the sheets of a workbook that hold something."""
    return _filled(_sheets(content, name))


def _sheets(content: bytes, name: str) -> dict[str, list[list[Any]]]:
    """The cells of all sheets by their names."""
    try:
        import python_calamine as calamine
    except ImportError as error:
        advice = 'pip install "mckibben[lab]", or save the sheet as CSV'
        raise SpecError(name, allowed="is a workbook, which takes python-calamine to read", advice=advice) from error
    try:
        book = calamine.load_workbook(io.BytesIO(content))
        return {known: book.get_sheet_by_name(known).to_python(skip_empty_area=False) for known in book.sheet_names}
    except Exception as error:  # it raises many kinds for files that are damaged or something else
        said = "is no workbook that can be read"
        raise SpecError(name, allowed=said, advice="save it again as XLSX or CSV") from error


def _filled(sheets: dict[str, list[list[Any]]]) -> list[str]:
    return [known for known, rows in sheets.items() if any(cell != "" for row in rows for cell in row)]


def _chosen(sheet: str | int | None, names: list[str], filled: list[str], name: str) -> str:
    listed = ", ".join(f'"{known}"' for known in filled or names)
    if sheet is None:
        if len(filled) == 1:
            return filled[0]
        if not filled:
            raise SpecError(name, allowed="is empty")
        advice = f'say sheet="{filled[0]}" (--sheet)'
        raise SpecError(name, allowed=f"has several sheets: {listed}", advice=advice)
    if isinstance(sheet, str) and sheet in names:
        return sheet
    if isinstance(sheet, int) and 1 <= sheet <= len(names):
        return names[sheet - 1]
    if isinstance(sheet, str) and sheet.isdigit() and 1 <= int(sheet) <= len(names):  # as the command line gives it
        return names[int(sheet) - 1]
    raise SpecError(f"{name}, sheet", sheet, "is none of its sheets", nearest(str(sheet), names))


def _plain(cell: Any) -> object:
    """A whole number as text without its ".0": heads such as 2024 are text, and numbers are read from text too."""
    return cell if not isinstance(cell, float) or not cell.is_integer() or abs(cell) > 1e15 else int(cell)
