"""XLSX files as tests need them."""

import io
import zipfile
from typing import Any
from xml.sax.saxutils import escape


def workbook(sheets: dict[str, list[list[Any]]]) -> bytes:
    """The smallest XLSX file with these sheets: texts and numbers in their cells."""
    kind = "http://schemas.openxmlformats.org"
    main, packaged = f"{kind}/spreadsheetml/2006/main", f"{kind}/package/2006"
    office = f"{kind}/officeDocument/2006/relationships"
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        parts = [f'<Override PartName="/xl/worksheets/sheet{k}.xml" ContentType="application/vnd.openxmlformats-'
                 f'officedocument.spreadsheetml.worksheet+xml"/>' for k in range(1, len(sheets) + 1)]  # fmt: skip
        file.writestr(
            "[Content_Types].xml",
            f'<Types xmlns="{packaged}/content-types"><Default Extension="rels" ContentType="application/vnd.'
            'openxmlformats-package.relationships+xml"/><Override PartName="/xl/workbook.xml" ContentType="application/'
            f'vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/>{"".join(parts)}</Types>',
        )
        file.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{packaged}/relationships"><Relationship Id="r1" Type="{office}/officeDocument" '
            'Target="xl/workbook.xml"/></Relationships>',
        )
        listed = "".join(f'<sheet name="{n}" sheetId="{k}" r:id="r{k}"/>' for k, n in enumerate(sheets, 1))
        file.writestr(
            "xl/workbook.xml", f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>{listed}</sheets></workbook>'
        )
        related = "".join(
            f'<Relationship Id="r{k}" Type="{office}/worksheet" Target="worksheets/sheet{k}.xml"/>'
            for k in range(1, len(sheets) + 1)
        )
        file.writestr(
            "xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{packaged}/relationships">{related}</Relationships>'
        )
        for k, rows in enumerate(sheets.values(), 1):
            lines = []
            for r, row in enumerate(rows, 1):
                cells = (
                    f'<c r="{chr(65 + c)}{r}" t="inlineStr"><is><t>{escape(cell)}</t></is></c>'
                    if isinstance(cell, str) else f'<c r="{chr(65 + c)}{r}"><v>{cell!r}</v></c>'
                    for c, cell in enumerate(row) if cell is not None
                )  # fmt: skip
                lines.append(f'<row r="{r}">{"".join(cells)}</row>')
            sheet = f'<worksheet xmlns="{main}"><sheetData>{"".join(lines)}</sheetData></worksheet>'
            file.writestr(f"xl/worksheets/sheet{k}.xml", sheet)
    return content.getvalue()
