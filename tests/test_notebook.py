"""What a notebook shows: values as tables with pictures, errors in one line, and the tutorial run as one."""

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import jupytext
import nbclient
import nbformat
import pytest

import mckibben as mk

pytestmark = pytest.mark.view

VOID = {"img"}
TUTORIAL = Path(__file__).parent.parent / "docs" / "tutorial.md"


class Reader(HTMLParser):
    """Checks that tags are closed in order, and keeps text, tags and where pictures come from."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.said: list[str] = []
        self.sources: list[str] = []
        self.feed(page)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]
        self.open += [] if tag in VOID else [tag]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.said.append(data)

    @property
    def text(self) -> str:
        return " ".join(self.said)


def shown(value: Any) -> Reader:
    page = Reader(value._repr_html_())
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    return page


@pytest.fixture(scope="module")
def paper() -> mk.Muscle:
    return mk.presets.paper()


@pytest.fixture(scope="module")
def curve(paper: mk.Muscle) -> mk.Result:
    return mk.run(paper, mk.Isometric(length="115 mm", pressure="0 to 1 bar"))


def test_a_muscle_and_its_parts(paper: mk.Muscle) -> None:
    page = shown(paper)
    assert page.tags.count("img") == 1
    assert page.text.count("assumed") == len(paper.assumed)
    assert "37 deg from the parallels (53 deg from the axis)" in page.said
    assert "12.5 mm" in shown(paper.braid).said
    assert "115 mm" in shown(mk.Isometric(length="115 mm", pressure="0 to 1 bar")).said


def test_a_curve_is_no_wall_of_numbers(curve: mk.Result) -> None:
    page = shown(curve)
    assert page.tags.count("tr") == 1 + 9  # heads, four states at either end, dots between
    assert f"{curve.force[-1]:.5g}" in page.said
    assert "force [N]" in page.said
    assert page.tags.count("img") == 1


def test_a_state_and_one_that_is_none(paper: mk.Muscle) -> None:
    state = mk.solve(paper, length="115 mm", pressure="1 bar")
    page = shown(state)
    assert {"101.22", "N", "stable under length control"} <= set(page.said)
    none = mk.solve(paper, length="130 mm", pressure="1 bar")
    page = shown(none)
    assert "no equilibrium: the fibres are straight at 128.7786 mm, the longest possible length" in page.said
    assert "assumed, not measured" in page.text
    assert page.tags.count("img") == 0
    assert "nan" not in page.text.lower()
    assert none.summary().startswith("no equilibrium: the fibres are straight")


def test_what_people_write_is_escaped(paper: mk.Muscle) -> None:
    page = shown(paper.replace("name", "<script>alert('&')</script>"))
    assert "script" not in page.tags
    assert "<script>alert('&')</script>" in page.text


def test_measured_points() -> None:
    data = mk.read_data({"pressure [bar]": [1, 1, 1], "length [mm]": [80, 90, 100], "force [N]": [0, 12, 31]})
    assert "0 to 31 N" in shown(data).said


def test_numbers_of_a_table_are_those_of_the_curve(curve: mk.Result) -> None:
    frame = curve.to_pandas()
    assert frame["force [N]"].tolist() == curve.force.tolist()
    assert frame["pressure [Pa]"].tolist() == curve.pressure.tolist()
    assert frame.index.name == "state"
    assert frame["safety_factor"].isna().all()  # of fibres whose breaking force nobody gave
    assert frame["safety_factor"].dtype == float


def test_an_error_is_one_message(paper: mk.Muscle) -> None:
    with pytest.raises(mk.SpecError) as raised:
        paper.replace("braid.angle", "95 deg")
    (line,) = raised.value._render_traceback_()
    assert line == f"SpecError: {raised.value}"


def executed(*cells: str) -> list[Any]:
    """The outputs of cells that are run one after the other."""
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbclient.NotebookClient(book, timeout=300, allow_errors=True).execute()
    return [cell.outputs for cell in book.cells]


def test_a_bar_tells_how_far_long_work_is() -> None:
    _, (swept,), (cut, error) = executed(
        "import mckibben as mk\npaper, test = mk.presets.paper(), mk.Isometric(length='115 mm', pressure='1 bar')",
        "with mk.progress('sweep') as watch:\n"
        "    _ = mk.sweep(paper, test, {'braid.angle': ['36 deg', '37 deg']}, tolerance=1e-4, watch=watch)",
        "with mk.progress('cut <b>') as watch:\n    watch(1, 3)\n    paper.replace('braid.angle', '95 deg')",
    )
    page = Reader(swept.data["text/html"])
    assert page.tags == ["progress"]
    assert page.text.startswith(" sweep: 2 done in ")
    assert swept.data["text/plain"] == page.text.strip()
    assert 'value="2" max="2"' in swept.data["text/html"]
    assert Reader(cut.data["text/html"]).text.startswith(" cut <b>: 1 ended in ")
    assert len(error.traceback) == 1


def test_a_bar_in_a_terminal_and_none_in_a_log(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for terminal in ("", "1"):
        monkeypatch.setenv("FORCE_COLOR", terminal)
        with mk.progress("fit", unit="muscles") as watch:
            watch(3)
            watch(5, 8, "second part")
        said = capsys.readouterr()
        assert said.out == ""
        assert ("second part" in said.err and "5/8" in said.err) == bool(terminal)
        assert terminal or not said.err


def test_the_tutorial_runs_as_a_notebook(tmp_path: Path) -> None:
    book = jupytext.read(TUTORIAL)
    nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    assert not [out for cell in cells for out in cell.outputs if out.output_type == "error"]
    (picture,) = [cell for cell in cells if cell.source.endswith("figure")]
    assert [set(out.data) for out in picture.outputs] == [{"text/plain", "image/png"}]
    (swept,) = [cell for cell in cells if cell.source == "data"]
    assert "states: 14 stable" in Reader(swept.outputs[0].data["text/html"]).said
    assert any("sweep: 14 done in" in str(out.get("data", "")) for cell in cells for out in cell.outputs)
    assert (tmp_path / "curve.png").exists()
    said = {cell.source: "".join(out.get("text", "") for out in cell.outputs) for cell in cells}
    assert any("101.22" in text for text in said.values())
