"""What people look for in tables, files, pictures and help."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.image import imread
from results import made
from texts import CASE
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.app.states import as_json, show
from mckibben.experiments import limits
from mckibben.results.rows import rows
from mckibben.spec.text import to_toml

pytestmark = pytest.mark.view

PAPER = mk.presets.paper()
STRONG = PAPER.replace("braid.fibre.breaking_force", "20 N")
CURVE = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)


def test_tables_have_the_largest_diameter_the_peak_tension_and_the_safety_factor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = made(STRONG, CURVE, reached=2)
    tension, radius = result.column("fibre_tension").max(axis=1), result.column("r").max(axis=1)
    state = list(rows(result))[1]
    assert state["largest_diameter"] == 2.0 * radius[1]
    assert state["peak_fibre_tension"] == tension[1]
    assert state["safety_factor"] == 20.0 / tension[1]
    assert list(rows(result))[2]["safety_factor"] is None
    told = as_json(result, None)
    assert told["states"][1]["safety_factor"] == state["safety_factor"]
    assert told["units"]["largest_diameter"] == "m"
    frame = pd.read_csv(mk.save(result, tmp_path / "out.csv"))
    np.testing.assert_array_equal(frame["safety_factor"][:2], 20.0 / tension[:2])
    show(result, 1e-6)
    shown = capsys.readouterr().out
    assert "no equilibrium" in shown  # wider than the terminal, and no digit is cut off
    assert "safety" in shown


def test_a_table_is_nothing_but_a_table(tmp_path: Path) -> None:
    result = made(PAPER, CURVE, reached=3)
    path = mk.save(result, tmp_path / "out.csv")
    assert len(pd.read_csv(path)) == 3
    assert "mckibben" in (tmp_path / "out.csv.txt").read_text(encoding="utf-8")
    path.unlink()
    with pytest.raises(mk.SpecError, match=r"out\.csv\.txt: exists"):
        mk.save(result, path)
    assert not path.exists()


@pytest.mark.parametrize(
    ("test", "said"),
    [
        (CURVE, 'Muscle "paper": isometric test, length 115 mm'),
        (mk.Isobaric(pressure="1 bar", length="85 mm to 110 mm", points=3), "isobaric test, pressure 1 bar"),
        (mk.FreeContraction(pressure="0 to 1 bar", points=3), "free-contraction test, force 0 N"),
        (mk.BlockedForce(pressure="0 to 1 bar", points=3), "blocked-force test, length 85 mm"),
        (
            mk.Protocol([mk.Step(length="to 115 mm", pressure=0), mk.Step(length="hold", force="to 0 N")]),
            "protocol test, 1 length to 115 mm, pressure 0 bar; 2 length hold, force to 0 N",
        ),
    ],
)  # fmt: skip
def test_pictures_name_the_muscle_the_test_and_what_is_held(test: object, said: str) -> None:
    result = made(PAPER, test, reached=2)
    assert said in mk.plot(result).get_suptitle().replace("\n", " ")
    assert said in mk.plot(result, kind="tension").get_suptitle().replace("\n", " ")


def test_pictures_are_wide_enough_for_slides(tmp_path: Path) -> None:
    mk.save(made(PAPER, CURVE, reached=3), tmp_path / "out.nc")
    done = CliRunner().invoke(app, ["plot", str(tmp_path / "out.nc")])
    assert done.exit_code == 0
    assert imread(tmp_path / "out.png").shape[1] >= 1200


def test_help_keeps_its_brackets() -> None:
    runner = CliRunner()
    told = runner.invoke(app, ["sweep", "--help"], env={"COLUMNS": "200"}).stdout
    for words in ("[sweep]", "[default: SWEEP.zarr]", "[default: one per core]"):
        assert words in told
    assert "[default: FILE.png]" in runner.invoke(app, ["plot", "--help"], env={"COLUMNS": "200"}).stdout


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def told(*words: object, code: int = 0) -> dict[str, Any]:
    """What a command prints as JSON."""
    done = CliRunner().invoke(app, [*map(str, words), "--json"])
    assert done.exit_code == code, done.output
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_json_of_check_presets_and_info(case: Path, tmp_path: Path) -> None:
    found = told("check", case)
    assert found["valid"] is True
    assert found["muscle"]["braid"]["radius"] == 0.0125
    assert "contracts under pressure" in found["braid"]
    assert found["derived"]["full extension"].endswith(" mm")
    assert [row["name"] for row in told("presets")["presets"]] == list(mk.presets.names())
    assert told("presets", "paper")["sources"] == mk.presets.sources("paper")
    assert told("info")["mckibben"]
    mk.save(made(PAPER, CURVE, reached=3), tmp_path / "out.nc")
    assert told("info", tmp_path / "out.nc")["verdicts"] == "3 stable"


def test_errors_are_json_too(case: Path) -> None:
    for command in ("check", "run"):
        error = told(command, case, "--set", "braid.angle=95 deg", code=2)["error"]
        assert (error["field"], error["value"]) == ("braid.angle", "95 deg")
        assert error["allowed"] == "must be above 0 deg and below 90 deg"
        assert error["message"].startswith("braid.angle = 95 deg: ")
    assert told("presets", "papr", code=2)["error"]["advice"] == 'did you mean "paper"?'


REGION = xr.Dataset(
    {"shortest": ("pressure", [0.03, 0.031], {"units": "m"}), "longest": ("pressure", [0.12, 0.12], {"units": "m"}),
     "stable_down_to": ("pressure", [0.03, 0.03], {"units": "m"}), "shortest_cause": ("pressure", ["it folds", ""])},
    {"pressure": ("pressure", [1e5, 2e5], {"units": "Pa"})},
    {"muscle": to_toml(PAPER)},
)  # fmt: skip


def test_what_a_muscle_can_do_from_the_command_line(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[list[str]] = []
    monkeypatch.setattr(limits, "working_range", lambda _, pressures: asked.append(pressures) or REGION)
    words = ["working-range", str(case), "--pressure", "1 to 2 bar", "--points", "2"]
    found = told(*words, "-o", tmp_path / "range.csv")
    assert asked == [["100000.0 Pa", "200000.0 Pa"]]
    assert found["rows"][0] == {
        "pressure": 1e5, "shortest": 0.03, "longest": 0.12, "stable_down_to": 0.03, "shortest_cause": "it folds",
    }  # fmt: skip
    assert pd.read_csv(tmp_path / "range.csv")["shortest [m]"].tolist() == [0.03, 0.031]
    done = CliRunner().invoke(app, [*words, "-o", str(tmp_path / "range.png")])
    assert done.exit_code == 0
    assert "31" in done.stdout
    assert imread(tmp_path / "range.png").shape[1] >= 1200
    only = limits.Limits(1e5, 0.03, -70.0, "it folds", 0.03, -70.0, 0.12, -71.0, np.nan)
    monkeypatch.setattr(limits, "limits", lambda *_, **__: only)
    found = told("limits", case, "--pressure", "1 bar")
    assert (found["shortest"], found["force_extremum_length"]) == (0.03, None)


def test_a_force_map_from_the_command_line(case: Path, tmp_path: Path) -> None:
    words = ["force-map", case, "--length", "130 mm to 131 mm", "--pressure", "1 to 2 bar", "--points", "2"]
    found = told(*words, "-o", tmp_path / "map.csv", code=3)
    assert found["complete"] is False
    assert {row["verdict"] for row in found["rows"]} == {"no equilibrium"}
    assert len(pd.read_csv(tmp_path / "map.csv")) == 4
    assert told(*words, "-o", tmp_path / "map.csv", code=2)["error"]["allowed"] == "exists"


def test_several_pressures_in_one_command(case: Path, tmp_path: Path) -> None:
    words = ["run", case, "--set", "test.length=130 mm", "--pressure", "1 bar", "--pressure", "0 to 2 bar", "-q"]
    done = CliRunner().invoke(app, [*map(str, words), "-o", str(tmp_path / "out.csv")])
    assert done.exit_code == 3
    assert len(pd.read_csv(tmp_path / "out_1_bar.csv")) == 21  # the points of the case
    assert len(pd.read_csv(tmp_path / "out_0_to_2_bar.csv")) == 21
    again = CliRunner().invoke(app, [*map(str, words), "-o", str(tmp_path / "out.csv")])
    assert again.exit_code == 2


def test_a_family_of_curves_in_one_picture() -> None:
    results = {name: made(PAPER, CURVE, reached=3) for name in ("thin", "thick")}
    axes = mk.plot(results).axes[0]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["thin", "thick"]
    assert axes.get_xlabel() == "Pressure (bar)"
    other = made(PAPER, mk.FreeContraction(pressure="0 to 1 bar", points=3), reached=3)
    with pytest.raises(mk.SpecError, match="tests of several kinds"):
        mk.plot(results | {"free": other})
    with pytest.raises(mk.SpecError, match="must hold results of run"):
        mk.plot({"thin": 3})


def test_the_textbook_formula_by_its_public_name() -> None:
    """Zero at the magic angle, NaN where the fibres do not reach."""
    magic = PAPER.braid.length / np.sin(PAPER.braid.angle) / np.sqrt(3.0)
    forces = mk.textbook_force(PAPER, length=[magic, 0.085, 0.15], pressure="1 bar")
    assert abs(forces[0]) < 1e-9
    theta, R0 = PAPER.braid.angle, PAPER.braid.radius
    assert forces[1] == pytest.approx(np.pi * R0**2 / np.cos(theta) ** 2 * (3.0 * np.sin(theta) ** 2 - 1.0) * 1e5)
    assert np.isnan(forces[2])
    with pytest.raises(mk.SpecError, match=r"textbook_force\.length = 85: needs a unit"):
        mk.textbook_force(PAPER, length="85", pressure="1 bar")


def test_examples_and_recipes_use_public_names_only() -> None:
    root = Path(__file__).parent.parent
    for page in (*(root / "examples").glob("*.py"), root / "docs" / "howto.md", root / "README.md"):
        assert "from mckibben." not in page.read_text(encoding="utf-8"), page


def test_the_theory_reads_without_a_network() -> None:
    """MathJax is among the pages, with its licence."""
    docs = Path(__file__).parent.parent / "docs"
    assert 'mathjax_path = "mathjax/tex-svg-full.js"' in (docs / "conf.py").read_text(encoding="utf-8")
    assert (docs / "_static" / "mathjax" / "tex-svg-full.js").stat().st_size > 1_000_000
    assert "Apache License" in (docs / "_static" / "mathjax" / "LICENSE").read_text(encoding="utf-8")
