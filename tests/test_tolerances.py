"""Tolerances against closed forms, against derivatives where they are tiny, and as they are asked for and shown."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app
from mckibben.files import hdf5, motions
from mckibben.scatter.draw import _table
from mckibben.scatter.given import scattering
from mckibben.sweeps import chunk
from mckibben.sweeps.plan import plan

pytestmark = pytest.mark.scatter

PAPER = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="1 bar")
BEYOND = mk.Isometric(length="140 mm", pressure="1 bar")
"""Beyond full extension: nothing is solved, so it is quick."""


def found(vary: dict[str, Any], test: mk.Isometric = TEST, samples: int = 64, **options: Any) -> mk.Tolerances:
    return mk.tolerances(PAPER, test, vary, samples=samples, **options)


def test_tiny_tolerances_are_linear() -> None:
    tiny = {"braid.angle": "0.01 deg", "test.pressure": "2 mbar", "braid.radius": "0.1 % uniform"}
    seen = found(tiny, of=("force", "peak_fibre_tension"), samples=512)
    np.testing.assert_allclose(seen.deviation, seen.linear, rtol=7e-3)
    assert (np.abs(seen.quantiles[1] - seen.data["result_value"].values) < 0.1 * seen.linear).all()
    for kind in ("first", "total"):
        np.testing.assert_allclose(seen.data[kind], seen.data["share"], atol=0.04)
    assert seen.data["share"].values.min() > 0.03  # none of them is lost beside the others
    np.testing.assert_allclose(seen.data["share"].sum("number"), 1.0, rtol=1e-12)
    slopes = mk.sensitivity(PAPER, TEST, "force", ["braid.radius"]).absolute
    effect = slopes.loc["braid.radius", "force"] * 1e-3 * 12.5e-3 / math.sqrt(3.0)
    assert float(seen.data["effect"].sel(number="braid.radius", result="force")) == pytest.approx(effect, rel=1e-9)


def test_contraction_and_length_are_closed_forms() -> None:
    seen = found({"test.length": "1 mm uniform", "braid.length": "0.2 mm"}, of=("length", "contraction"), samples=512)
    length, contraction = seen.linear
    assert length == pytest.approx(1e-3 / math.sqrt(3.0), rel=1e-9)
    parts = np.array([1e-3 / math.sqrt(3.0) / 85e-3, 0.2e-3 * 115.0 / 85.0 / 85e-3])
    assert contraction == pytest.approx(np.linalg.norm(parts), rel=1e-6)
    np.testing.assert_allclose(seen.data["share"].sel(result="contraction"), parts**2 / (parts**2).sum(), rtol=1e-6)
    np.testing.assert_allclose(seen.quantiles[:, 0], [0.1141, 0.115, 0.1159], atol=5e-6)  # 5, 50, 95 % of 114 to 116 mm
    np.testing.assert_allclose(seen.deviation, seen.linear, rtol=3e-3)
    np.testing.assert_allclose(seen.data["total"].sel(result="length"), [1.0, 0.0], atol=0.01)


def test_one_number_alone_has_the_whole_variance() -> None:
    seen = found({"braid.angle": "1 deg"}, samples=256)
    assert float(seen.data["share"].item()) == 1.0
    for kind in ("first", "total"):
        assert float(seen.data[kind].item()) == pytest.approx(1.0, abs=0.03)
    assert seen.deviation[0] > 1.02 * seen.linear[0]  # the force bends upwards with the angle
    assert seen.quantiles[2, 0] - seen.quantiles[1, 0] > 1.1 * (seen.quantiles[1, 0] - seen.quantiles[0, 0])


def test_the_same_call_gives_the_same_and_the_axis_turns_the_sign() -> None:
    seen, again = (found({"braid.angle": "0.3 deg"}) for _ in range(2))
    assert seen.data.identical(again.data)
    axis = mk.Muscle(
        braid=mk.Braid(radius="12.5 mm", length="85 mm", angle="53 deg", angle_from="axis", fibres=56,
                       fibre=PAPER.braid.fibre), chamber=PAPER.chamber, ends=PAPER.ends,
    )  # fmt: skip
    other = mk.tolerances(axis, TEST, {"braid.angle": "0.3 deg"}, samples=64)
    assert float(other.data["number_value"].item()) == pytest.approx(math.radians(53.0))
    assert float(other.data["effect"].item()) == pytest.approx(-float(seen.data["effect"].item()), rel=1e-9)
    assert other.deviation[0] == pytest.approx(seen.deviation[0], rel=0.02)


def test_states_that_are_lost_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    single = chunk.run

    def fragile(muscle: mk.Muscle, test: mk.Isometric, **options: float) -> mk.Result:
        if muscle.braid.angle > math.radians(37.3):
            raise ZeroDivisionError("so what")
        return single(muscle, test, **options)

    monkeypatch.setattr(chunk, "run", fragile)
    monkeypatch.setattr(chunk, "solve_together", lambda *_, **__: [])
    seen = found({"braid.angle": "0.5 deg uniform"}, samples=16)
    bad = seen.data["drawn"].values[:, 0] > math.radians(37.3)
    assert bad.any()
    assert (np.isnan(seen.data["sampled"].values[:, 0]) == bad).all()
    lost = int(seen.data.attrs["lost"])
    assert lost == bad.sum() + bad[8:].sum()  # with one number, its Sobol muscles are the second half again
    assert f"{lost} of 24 muscles could not be computed, the first because: ZeroDivisionError: so what" in seen.notes
    assert not seen.stable
    assert np.isnan(seen.data["first"].values).all()
    assert float(seen.data["share"].item()) == 1.0
    assert seen.quantiles[2, 0] == np.quantile(seen.data["sampled"].values[~bad, 0], 0.95)
    assert len(mk.plot(seen).axes) == 2


def test_nothing_is_stable() -> None:
    seen = found({"braid.angle": "0.1 deg"}, BEYOND, samples=16)
    assert not seen.stable
    assert seen.notes[0].startswith("no estimate by derivatives: the state as meant is no equilibrium")
    assert seen.notes[1].startswith("24 of 24 muscles have a state that is no equilibrium, the first because: state 0")
    assert set(seen.spread.loc["force"]) == {"-"}
    assert np.isnan(seen.table.iloc[:, 2:].to_numpy(float)).all()
    assert "no sample" in mk.plot(seen).axes[0].texts[0].get_text()
    assert "force -" in repr(seen)
    page = seen._repr_html_()
    assert page is not None
    assert page.count("<img") == 1


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"vary": {"braid.angel": "1 deg"}}, r'braid.angel: .*did you mean "braid.angle"'),
    ({"vary": {"friction.coefficient": 0.1}}, "friction.coefficient: is no number of this muscle or test"),
    ({"vary": {"braid.angle": "0 deg"}}, "braid.angle = 0 deg: must be above 0"),
    ({"vary": {"chamber.thickness": "-0.1 mm"}}, "must be above 0"),
    ({"vary": {"chamber.thickness": "0.1 bar"}}, "wrong kind of unit"),
    ({"vary": {"chamber.thickness": "0.5 mm"}}, "reaches from -1 mm to 3 mm .4 standard deviations., where"),
    ({"vary": {"braid.angle": "60 deg uniform"}}, "reaches from -23 deg to 97 deg .all of the range."),
    ({"vary": {"braid.fibres": 2}}, "is a whole number"),
    ({"vary": {"braid.fibre.nu": "5 %"}}, "plain number"),
    ({"vary": {"chamber.law.c2": "5 %"}}, "is a share of 0"),
    ({"vary": {"braid.angle": "1 deg", "muscle.braid.angle": "1 deg"}}, "given twice"),
    ({"vary": {}}, "at least one number"),
    ({"vary": {"braid.angle": "1 deg"}, "distribution": "norml"}, 'did you mean "normal"'),
    ({"vary": {"braid.angle": "1 deg"}, "samples": 1000}, "power of 2"),
    ({"vary": {"braid.angle": "1 deg"}, "samples": 8}, "from 16 to"),
    ({"vary": {"braid.angle": "1 deg"}, "of": "forse"}, 'did you mean "force"'),
    ({"vary": {"braid.angle": "1 deg"}, "state": 1}, "from -1 to 0"),
]


@pytest.mark.parametrize(("asked", "said"), WRONG, ids=[str(list(asked.values())) for asked, _ in WRONG])
def test_wrong_input(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        mk.tolerances(PAPER, TEST, **asked)


def test_numbers_within_lists_paths_and_steps_are_put_in_their_place() -> None:
    law = mk.Ogden(mu=["10 kPa", "2 kPa"], alpha=[2.0, -1.0])
    muscle = PAPER.replace("chamber.law", law)
    test = mk.Protocol(steps=[mk.Step(length="to 115 mm", pressure=0, points=2),
                              mk.Step(contraction="-35 %", pressure="0 to 1 bar", points=3)])  # fmt: skip
    given = scattering(
        muscle,
        test,
        {
            "chamber.law.mu[1]": "1 %", "chamber.law.mu[0]": "1 %", "test.steps[1].pressure[1]": "1 %",
            "test.steps[1].contraction": 0.01, "test.steps[0].length": "1 mm",
        },
        "uniform",
    )  # fmt: skip
    values = np.array([[one.value + one.size for one in given]])
    changed, asked = plan(muscle, test, designs=_table(muscle, test, given, values)).design(0)
    assert isinstance(changed.chamber, mk.Chamber)
    np.testing.assert_allclose(changed.chamber.law.mu, [10100.0, 2020.0])
    first, second = asked.steps
    assert first.length.waypoints == (0.116,)
    assert first.length.needs_present
    np.testing.assert_allclose(second.pressure.waypoints, [0.0, 1.01e5])
    np.testing.assert_allclose(second.length.waypoints, [-0.34])
    assert second.length.unit == "1"


CASE = """
[muscle]
preset = "paper"
[test]
kind = "isometric"
length = "115 mm"
pressure = "1 bar"
[tolerances]
braid.angle = "0.3 deg"
"chamber.thickness" = "10 % uniform"
"""


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE, encoding="utf-8")
    runner, asked = CliRunner(), ["tolerances", "case.toml", "--samples", "64"]
    done = runner.invoke(app, [*asked, "-o", "spread.png"])
    assert done.exit_code == 0, done.output
    assert Path("spread.png").read_bytes().startswith(b"\x89PNG")
    for words in ("0.3 deg (one standard deviation)", "±0.1 mm (uniform)", "ASSUMED", "101.2 N", "5 %", "95 %"):
        assert words in done.output
    told = json.loads(runner.invoke(app, [*asked, "--vary", "chamber.thickness=0.1 mm", "--json"]).output)
    assert told["numbers"]["chamber.thickness"]["distribution"] == "normal"  # the option counts before the file
    assert told["numbers"]["braid.angle"]["share"]["force"] > 0.99
    assert told["results"]["force"]["value"] == pytest.approx(101.22, abs=0.01)
    assert (told["samples"], told["tried"], told["lost"]) == (64, 128, 0)
    assert runner.invoke(app, [*asked, "-o", "table.csv", "-q"]).exit_code == 0
    rows = Path("table.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("number,value,tolerance,deviation,distribution,unit,assumed,force effect [N],")
    assert rows[1].startswith("braid.angle,0.645")
    assert len(rows) == 3
    assert "101.2 N" in Path("table.csv.txt").read_text(encoding="utf-8")
    lost = runner.invoke(app, [*asked, "--set", "test.length=140 mm"])
    assert lost.exit_code == 3
    assert "128 of 128 muscles" in lost.output
    for wrong in (["--vary", "braid.angle"], ["--vary", "braid.angel=1 deg"], ["-o", "spread.doc"]):
        assert runner.invoke(app, [*asked, *wrong]).exit_code == 2
    told = runner.invoke(app, ["run", "case.toml"])
    assert told.exit_code == 2
    assert "mckibben tolerances" in told.output


def test_tolerances_are_kept(tmp_path: Path) -> None:
    seen = found({"braid.angle": "0.5 deg", "test.length": "0.1 mm uniform"}, samples=16)
    loaded = mk.load(mk.save(seen, tmp_path / "spread.nc"))
    assert loaded == seen
    assert loaded.table.equals(seen.table)
    assert "braid.angle" in mk.save(seen, tmp_path / "spread.csv").read_text()


def test_tolerances_without_a_state_are_kept(tmp_path: Path) -> None:
    seen = found({"braid.angle": "0.5 deg"}, BEYOND, samples=16)
    assert mk.load(mk.save(seen, tmp_path / "lost.nc")) == seen
    with pytest.raises(mk.SpecError, match="holds no motion"):
        motions.of(hdf5.opened(tmp_path / "lost.nc"), "lost.nc")
