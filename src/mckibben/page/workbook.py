"""Workbooks that browsers send, looked at before they are read: how large they become, which sheets hold something."""

from __future__ import annotations

import io
import re
import zipfile

from mckibben.spec import SpecError

__all__ = ["check_workbook"]

UNPACKED = 100_000_000
"""Bytes that a workbook is unpacked to at most; a table of a hundred thousand rows has a tenth of it."""
CELLS = 2_000_000
"""Cells of a sheet at most, from its first one to its last, those that are empty included."""
PIECE = 1 << 20
_OTHER = ("content.xml", "xl/workbook.bin")
"""Parts by which an archive would be read as another kind of workbook than XLSX."""
_CELL = re.compile(rb'\br="([A-Za-z]{0,8})(\d{1,12})"')
"""A reference of a cell or, of a number alone, of a row. Sheets may lie anywhere in the archive."""
_AS = "save it again as XLSX or CSV, with the table alone"


def check_workbook(content: bytes, name: str) -> None:
    """SpecError for a workbook that is no XLSX, or would become too large in memory: a small archive may hold much."""
    if not content.startswith(b"PK"):
        raise SpecError(name, allowed="is no XLSX workbook", advice=_AS)
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
        names = archive.namelist()
        if "xl/workbook.xml" not in names or any(part in names for part in _OTHER):
            raise SpecError(name, allowed="is no XLSX workbook", advice=_AS)
        left = UNPACKED
        for part in archive.infolist():
            wide, tall = 1, 1
            with archive.open(part) as stream:
                kept = b""
                while piece := stream.read(PIECE):
                    left -= len(piece)
                    if left < 0:
                        said = f"unpacks to more than {UNPACKED / 1e6:g} MB"
                        raise SpecError(name, allowed=said, advice=_AS)
                    wide, tall = _reach(kept + piece, wide, tall)
                    kept = piece[-64:]  # a reference may lie across two pieces
            if wide * tall > CELLS:
                said = f"has a sheet of {tall} rows and {wide} columns, more than {CELLS} cells"
                raise SpecError(name, allowed=said, advice=_AS)
    except SpecError:
        raise
    except Exception as error:  # of an archive that is damaged in one of many ways
        raise SpecError(name, allowed="is no workbook that can be read", advice=_AS) from error


def _reach(text: bytes, wide: int, tall: int) -> tuple[int, int]:
    """The last column and row that the references of a sheet name."""
    for letters, row in _CELL.findall(text):
        column = 0
        for letter in letters.upper():
            column = 26 * column + letter - 64
        wide, tall = max(wide, column), max(tall, int(row))
    return wide, tall
