"""How a sensitivity is asked for and shown: names, states that are not there, the chart, the command."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app

pytestmark = pytest.mark.app

PAPER, TEST = mk.presets.paper(), mk.Isometric(length="110 mm", pressure=[2e4, 1e5])


def test_names_and_states_are_checked() -> None:
    for wrong, said in (
        ({"of": "forse"}, 'did you mean "force"'),
        ({"by": "braid.angel"}, 'did you mean "braid.angle"'),
        ({"state": 2}, "from -2 to 1"),
    ):
        with pytest.raises(mk.SpecError, match=said):
            mk.sensitivity(PAPER, TEST, **wrong)  # type: ignore[arg-type]


def test_rows_and_zeros() -> None:
    found = mk.sensitivity(PAPER, TEST)
    assert list(found.relative.columns) == ["force", "peak_fibre_tension"]
    assert "test.pressure[1]" in found.relative.index
    assert "test.pressure[0]" not in found.relative.index  # the last state does not depend on it
    assert np.isnan(found.relative["force"]["chamber.law.c2"])  # it is zero
    assert found.absolute["force"]["chamber.law.c2"] > 0.0
    bars = [bar for bar in mk.plot(found).axes[0].patches if bar.get_width() != 0.0]
    assert len(bars) == len(found.relative) - 1
    page = found._repr_html_()
    assert page is not None
    assert page.count("<img") == 1
    assert f"{found.relative['force']['braid.angle']:.4g}" in page


def test_a_state_that_is_not_there_has_a_reason() -> None:
    found = mk.sensitivity(PAPER, mk.Isometric(length="145 mm", pressure=[2e4, 1e5]), by="braid")
    assert not found.complete
    assert found.verdict == "no equilibrium"
    assert "straight" in found.reason
    assert found.absolute.isna().all(axis=None)
    assert not mk.plot(found).axes


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    case = runner.invoke(app, ["presets", "paper", "--toml"]).output
    Path("case.toml").write_text(case, encoding="utf-8")
    asked = ["sensitivity", "case.toml", "--set", "test.pressure=1 bar", "--set", "test.points=1"]
    done = runner.invoke(app, [*asked, "-o", "tornado.png"])
    assert done.exit_code == 0, done.output
    assert Path("tornado.png").read_bytes().startswith(b"\x89PNG")
    assert "ASSUMED" in done.output
    numbers = json.loads(runner.invoke(app, [*asked, "--json"]).output)["numbers"]
    assert numbers["test.pressure"]["relative"]["force"] == pytest.approx(0.965, abs=1e-3)
    assert runner.invoke(app, [*asked, "-o", "table.csv", "-q"]).exit_code == 0
    rows = [line for line in Path("table.csv").read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert len(rows) == 1 + len(numbers)
    assert runner.invoke(app, [*asked, "--set", "test.length=145 mm"]).exit_code == 3
    assert runner.invoke(app, [*asked, "--by", "nothing"]).exit_code == 2
