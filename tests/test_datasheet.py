"""The datasheet: its numbers against runs, its two forms, texts of users, and what cannot be computed."""

import io
import math
import re
import sys
from pathlib import Path

import attrs
import numpy as np
import pypdf
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.sheet.facts import Facts, cautions_once, facts
from mckibben.sheet.html import html
from mckibben.sheet.levels import Fact
from mckibben.sheet.pdf import pdf
from mckibben.sheet.pictures import curves, drawing, svg
from mckibben.sheet.words import Page, page
from mckibben.units import show

pytestmark = pytest.mark.sheet

PAPER = mk.presets.paper()
PRESSURES = (5e4, 1e5)


@pytest.fixture(scope="module")
def found() -> Facts:
    return facts(PAPER, PRESSURES, (1380.0, 1100.0))


def paged(found: Facts) -> Page:
    return page(found, svg(drawing(found)), svg(curves(found)), "2026-01-01")


@pytest.fixture(scope="module")
def sheet(found: Facts) -> Page:
    return paged(found)


def test_numbers_are_those_of_run(found: Facts, sheet: Page) -> None:
    free = mk.run(PAPER, mk.FreeContraction(pressure=["0.5 bar", "1 bar"]))
    blocked = mk.run(PAPER, mk.BlockedForce(pressure=["0.5 bar", "1 bar"]))
    for k, row in enumerate(sheet.levels):
        assert row == (
            ("0.5 bar", "1 bar")[k], show(blocked.force[k], "N", 4), f"{100.0 * free.contraction[k]:.4g} %",
            show(free.length[k], "m", 4),
        )  # fmt: skip
    key = dict(sheet.key)
    assert key["Free contraction at 1 bar"] == f"{100.0 * free.contraction[1]:.4g} % (to {1e3 * free.length[1]:.4g} mm)"
    assert key["Working range at 1 bar"].startswith("32.08 mm to 128.8 mm")
    volume = float(free.data["air_volume"][1])
    assert found.air.value == pytest.approx((1.0 + 1e5 / 101325.0) * volume - math.pi * 0.0125**2 * 0.085, rel=1e-4)
    top = found.levels[-1].curve
    assert top.force[-1] == pytest.approx(0.0, abs=1e-3)  # the curve ends where the muscle is free
    assert found.tension.value == pytest.approx(float(top.data["fibre_tension"].max()), rel=1e-12)
    assert found.work.value == pytest.approx(-np.trapezoid(top.force, top.length), rel=1e-12)
    widest = max(float(level.curve.data["r"].max()) for level in found.levels)
    assert found.diameter.value == pytest.approx(2.0 * (widest + 0.25e-3), rel=1e-12)  # where two fibres cross
    fibres = 1380.0 * 56 * 0.085 / math.sin(math.radians(37.0)) * math.pi * 0.125e-3**2
    rubber = 1100.0 * math.pi * (13.5e-3**2 - 12.5e-3**2) * 0.085
    assert found.mass.value == pytest.approx(fibres + rubber, rel=1e-9)


def test_assumed_parameters_are_marked(sheet: Page) -> None:
    marks = {name: mark for name, _, _, mark in sheet.parameters}
    assert {name for name, mark in marks.items() if mark == "assumed"} == set(PAPER.assumed)
    assert sheet.limits[0].startswith("Assumed, not measured: braid.fibres")


def test_pdf_has_two_pages_and_equal_ones_are_equal_files(found: Facts, sheet: Page) -> None:
    made = pdf(sheet)
    assert made == pdf(paged(found))
    pages = pypdf.PdfReader(io.BytesIO(made)).pages
    assert len(pages) <= 2
    text = " ".join(part.extract_text() for part in pages)
    for words in ("paper", "6.661 N", "3.557 %", "assumed", "2026-01-01", "mckibben 0."):
        assert words in text


def test_html_stands_alone(sheet: Page) -> None:
    text = html(sheet).decode("utf-8")
    assert not re.search(r"<(script|link|img|iframe|object)\b", text)
    assert all(target.startswith("#") for target in re.findall(r'(?:href|src)="([^"]*)"', text))
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)\)", text))
    assert "default-src 'none'" in text
    assert text.count("<svg") == 2
    assert "6.661 N" in text


NASTY = [
    "#let x = 1 $y$ *b* _i_ \\ `c` @d <e>",
    "<script>alert(1)</script>&amp;\"'",
    "x" * 10_000,
    "a\nb\0c\u202e",
    "筋肉 ﷽ 💪",
]


@pytest.mark.parametrize("name", NASTY, ids=["typst", "html", "long", "control", "letters"])
def test_names_of_users_are_text(found: Facts, name: str) -> None:
    said = paged(attrs.evolve(found, muscle=attrs.evolve(PAPER, name=name)))
    pages = pypdf.PdfReader(io.BytesIO(pdf(said))).pages
    assert len(pages) <= 2
    plain = html(said).decode("utf-8").replace("\u200b", "")
    assert "<script" not in plain
    if name == NASTY[0]:
        assert "#let x = 1 $y$ *b* _i_ \\ `c` @d &lt;e&gt;" in plain
        assert "#let x = 1 $y$ *b*" in pages[0].extract_text().replace("\u200b", "")


def test_what_is_not_there_has_its_reason(found: Facts) -> None:
    none = Fact(math.nan, "no equilibrium: so it is")
    last = attrs.evolve(found.levels[1], blocked=none, contraction=none, length=none)
    lost = attrs.evolve(
        found, levels=(found.levels[0], last), range=None, no_range="friction", tension=none, diameter=none,
        volume=none, air=none, work=none, mass=Fact(math.nan, "not known: the density of the fibres"),
    )  # fmt: skip
    said = paged(lost)
    text = html(said).decode("utf-8")
    assert "nan" not in re.sub(r"<svg.*?</svg>", "", text, flags=re.DOTALL).lower()
    key = dict(said.key)
    assert key["Free contraction at 1 bar"] == "not computed: no equilibrium: so it is"
    assert key["Working range at 1 bar"] == "not computed: friction"
    assert key["Mass without fittings"] == "not known: the density of the fibres"
    assert said.levels[1] == ("1 bar", "–", "–", "–")
    assert "At 1 bar no free contraction: no equilibrium: so it is." in said.reasons


def test_cautions_are_told_once_and_from_where() -> None:
    told = list(cautions_once([
        ("from state 2 (70 mm, 1 bar) on: fibres touch at 3 mm", "the wall is thick"),
        ("from state 9 (60 mm, 2 bar) on: fibres touch at 4 mm",),
        ("state 0 (85 mm, 1 bar) and 3 more: it is apart; in the shape of state 0 it touches from 2 bar",),
    ]))  # fmt: skip
    assert told == ["from 70 mm, 1 bar on: fibres touch at 3 mm", "the wall is thick",
                    "from 85 mm, 1 bar on: it is apart; there it touches from 2 bar"]  # fmt: skip


WRONG = [
    ({"path": "x.doc"}, "must end in .pdf"),
    ({"pressure": "0 bar"}, "must be above 0"),
    ({"pressure": ["2 bar", "1 bar"]}, "must rise"),
    ({"pressure": "0 to 1 bar"}, "one value or a list"),
    ({"pressure": "1 bar", "fibre_density": "3 mm"}, "wrong kind of unit"),
    ({"pressure": "1 bar", "chamber_density": "-1 kg/m^3"}, "must be above 0"),
    ({"muscle": attrs.evolve(PAPER, name="mine")}, "give the largest one"),
]


@pytest.mark.parametrize(("asked", "said"), WRONG, ids=[said for _, said in WRONG])
def test_wrong_input(asked: dict[str, object], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(mk.SpecError, match=said):
        mk.datasheet(**({"muscle": PAPER, "path": "x.html"} | asked))  # type: ignore[arg-type]


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runner, asked = CliRunner(), ["datasheet", "case.toml", "--pressure", "0.5 bar", "--pressure", "1 bar"]
    Path("case.toml").write_text('[muscle]\npreset = "paper"\n', encoding="utf-8")
    done = runner.invoke(app, [*asked, "-o", "sheet.pdf", "--date", "today"])
    assert done.exit_code == 0, done.output
    assert Path("sheet.pdf").read_bytes().startswith(b"%PDF")
    again = runner.invoke(app, [*asked, "-o", "sheet.pdf"])
    assert again.exit_code == 2
    assert "exists" in again.output
    monkeypatch.setitem(sys.modules, "typst", None)
    missing = runner.invoke(app, [*asked, "-o", "other.pdf"])
    assert missing.exit_code == 2
    assert 'pip install "mckibben[report]"' in missing.output
    assert missing.output.count("\n") == 1
