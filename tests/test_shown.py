"""What people look for in tables, files, pictures and help."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.image import imread
from results import made
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.app.states import as_json, show
from mckibben.files.table import rows

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
