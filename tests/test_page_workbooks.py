"""Workbooks that a browser sends: read as CSV files are, limited in what they become, never run."""

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pages import answered, client, look
from starlette.testclient import TestClient
from workbooks import workbook

import mckibben as mk
from mckibben.page.workbook import CELLS, PIECE, UNPACKED, check_workbook

pytestmark = pytest.mark.page
pytest.importorskip("python_calamine")

BENCH = Path(__file__).parent.parent / "examples" / "bench.csv"
LINES = [line.split(";") for line in BENCH.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
ROWS: list[list[Any]] = [LINES[0], *([float(cell) for cell in line] for line in LINES[1:])]


@pytest.fixture(scope="module")
def page() -> Iterator[TestClient]:
    with client() as made:
        yield made


def sent(page: TestClient, content: bytes, name: str = "bench.xlsx", sheet: str = "") -> Any:
    return page.post("/data", params={"name": name, "sheet": sheet}, content=content)


def changed(content: bytes, parts: dict[str, bytes | None]) -> bytes:
    """A workbook with other parts; None for one that it loses."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        kept = {name: old.read(name) for name in old.namelist()} | parts
        for name, part in kept.items():
            if part is not None:
                new.writestr(name, part)
    return made.getvalue()


BOOK = workbook({"bench": ROWS})
SHEET = "xl/worksheets/sheet1.xml"
XML = zipfile.ZipFile(io.BytesIO(BOOK)).read(SHEET)


def test_a_workbook_is_read_as_its_table(page: TestClient) -> None:
    told = sent(page, BOOK).json()
    data = mk.read_data(BENCH)
    assert (told["name"], told["points"], told["tests"]) == ("bench.xlsx", len(data), list(data.tests))
    with page.websocket_connect("/socket") as socket:
        found = answered(socket, "measured", look() | {"data": told["data"]})["done"]
    for one in found["compared"]:
        assert one["force"] == pytest.approx(data[one["test"]].force.tolist())


def test_of_several_sheets_one_is_asked_for(page: TestClient) -> None:
    book = workbook({"notes": [["by hand"]], "empty": [], "bench": ROWS})
    assert sent(page, book).json() == {"sheets": ["notes", "bench"]}
    assert sent(page, book, sheet="bench").json()["points"] == len(ROWS) - 1
    assert "is none of its sheets" in sent(page, book, sheet="../bench").json()["error"]


def test_formulas_are_not_computed(page: TestClient) -> None:
    """What a cell showed when it was saved is read, whatever its formula would do now."""
    place = XML.index(b"<v>", XML.index(b'r="C2"'))
    formula = b'<f>WEBSERVICE("http://127.0.0.1:9/")</f>'
    told = sent(page, changed(BOOK, {SHEET: XML[:place] + formula + XML[place:]})).json()
    assert told["points"] == len(ROWS) - 1


def test_nothing_outside_of_it_is_read(page: TestClient, tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("7.25", encoding="utf-8")
    head = f'<!DOCTYPE x [<!ENTITY e SYSTEM "{secret.as_uri()}">]>'.encode()
    place = XML.index(b"<v>", XML.index(b'r="C2"')) + 3
    inside = XML[:place] + b"&e;" + XML[XML.index(b"</v>", place) :]
    answer = sent(page, changed(BOOK, {SHEET: head + inside}))
    assert answer.status_code == 400 or answer.json()["points"] == len(ROWS) - 2
    assert "7.25" not in answer.text


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({SHEET: b" " * (UNPACKED + 1)}, "unpacks to more than 100 MB"),
        ({SHEET: XML.replace(b'r="A1"', b'r="XFD1048576"')}, "has a sheet of 1048576 rows and 16384 columns"),
        ({SHEET: XML.replace(b'<row r="2"', b'<row r="900000"')}, "has a sheet of 900000 rows and 3 columns"),
        ({"content.xml": b"<x/>"}, "is no XLSX workbook"),
        ({"xl/workbook.xml": None, "xl/workbook.bin": b"x"}, "is no XLSX workbook"),
        ({"xl/workbook.xml": b"<workbook"}, "is no workbook that can be read"),
    ],
    ids=["a bomb", "a far cell", "a far row", "another kind", "a binary one", "torn"],
)  # fmt: skip
def test_what_would_become_too_large_or_is_none(page: TestClient, parts: dict[str, bytes | None], words: str) -> None:
    content = changed(BOOK, parts)
    assert len(content) < 1_000_000
    answer = sent(page, content)
    assert answer.status_code == 400, answer.text
    assert answer.json()["error"].startswith("bench.xlsx")
    assert words in answer.json()["error"]


def test_a_reference_that_lies_across_two_pieces_counts() -> None:
    far = b'r="XFD1048576"'
    head, _, tail = XML.partition(b'r="A1"')
    padded = head + b" " * (PIECE - len(head) - len(far) // 2) + far + tail
    assert padded.index(far) < PIECE < padded.index(far) + len(far)
    with pytest.raises(mk.SpecError, match="16384 columns"):
        check_workbook(changed(BOOK, {SHEET: padded}), "bench.xlsx")


def test_a_large_table_is_still_read() -> None:
    rows = [["p [bar]", "l [mm]", "F [N]"], *([1.0, 80.0 + 1e-4 * k, 1e-3 * k] for k in range(50_000))]
    check_workbook(workbook({"bench": rows}), "bench.xlsx")
    assert 3 * len(rows) < CELLS
