"""Further ways to hold a step: sealed gas, past limit points, and a test that is interrupted."""

import numpy as np
import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app

pytestmark = pytest.mark.experiments

REFERENCE = mk.presets.reference()
ATMOSPHERE = 101325.0


@pytest.mark.parametrize(("gas", "exponent"), [("isothermal", 1.0), ("adiabatic", 1.4)])
def test_sealed_gas_keeps_its_law(gas, exponent):
    fill = mk.Step(length="85 mm", pressure="0 to 1 bar", points=3)
    curve = mk.run(REFERENCE, mk.Protocol([fill, mk.Step(length="to 100 mm", gas=gas, points=4)]))
    sealed = curve.data["protocol_step"].values == 1
    amount = (curve.pressure + ATMOSPHERE) * curve.volume**exponent
    assert curve.status == "complete"
    np.testing.assert_allclose(amount[sealed], amount[2], rtol=1e-9)
    assert (np.diff(curve.pressure[sealed]) > 0.0).all()  # stretched past the magic angle, the volume shrinks
    state = mk.solve(REFERENCE, length="100 mm", pressure=float(curve.pressure[-1]))
    assert state.force == pytest.approx(curve.force[-1], rel=1e-8)


def test_sealed_gas_pushes_back_with_its_exponent():
    fill = mk.Step(length="85 mm", pressure="1 bar")
    ends = [
        mk.run(REFERENCE, mk.Protocol([fill, mk.Step(length="to 100 mm", gas=gas, points=2)])).pressure[-1]
        for gas in ("isothermal", "adiabatic")
    ]
    assert ends[0] < ends[1]


def test_a_branch_is_followed_past_its_limit_point():
    # a pushed muscle loses its hold as the pressure falls: least pressure, then the unstable branch beyond it
    curve = mk.run(REFERENCE, mk.Step(force="-60 N", pressure="1 bar to 0.3 bar", along="branch", points=60))
    good = np.isfinite(curve.pressure)
    pressure, verdict = curve.pressure[good], np.array(curve.verdict)[good]
    turn = int(np.argmin(pressure))
    assert 0 < turn < len(pressure) - 1
    assert (np.diff(pressure[: turn + 1]) < 0.0).all()
    assert (np.diff(pressure[turn:]) > 0.0).all()
    np.testing.assert_allclose(curve.force[good], -60.0, rtol=1e-9)
    assert (curve.data["residual"].values[good] < 1e-8).all()
    assert (verdict[: turn - 1] == "stable").all()
    assert (verdict[turn + 1 :] == "unstable").all()
    assert (curve.data["modes_force_control"].values[good][turn + 1 :] == 1).all()


def test_a_volume_controlled_branch_runs_on_where_the_pressure_turns():
    # with the force held the pressure has a least value along the branch: the volume has none and holds what it cannot
    step = mk.Step(volume="35.3 cm^3 to 30.5 cm^3", force="-60 N", along="branch", points=60)
    curve = mk.run(REFERENCE, step)
    pressure, turn = curve.pressure, int(np.argmin(curve.pressure))
    assert curve.status == "complete"
    assert 5 < turn < len(curve) - 5
    assert (np.diff(curve.volume) < 0.0).all()
    assert (np.diff(curve.length) < 0.0).all()
    assert (np.diff(pressure[: turn + 1]) < 0.0).all()
    assert (np.diff(pressure[turn:]) > 0.0).all()
    np.testing.assert_allclose(curve.force, -60.0, rtol=1e-9)
    assert (curve.data["residual"].values < 1e-10).all()
    # even steps of arclength: the shape changes by much the same from state to state, and never jumps
    change = np.sqrt((np.diff(curve.data["psi"].values, axis=0) ** 2).mean(axis=1))[:-1]
    assert change.max() < 3.0 * change.min()
    assert change.max() < 0.05
    # energy stored is work done, F dh + P dV, also past the turn
    stored = curve.data["energy"].values - curve.data["energy"].values[0]
    np.testing.assert_allclose(stored, curve.data["work"].values, atol=1e-7 * np.ptp(stored))
    # symmetric shapes never give way under this control; to one side they do from the least pressure on
    assert (curve.data["modes_force_control"].values == 0).all()
    assert set(curve.data["modes_antisymmetric"].values[: turn - 1]) == {0}
    assert set(curve.data["modes_antisymmetric"].values[turn + 1 :]) == {1}
    state = mk.solve(REFERENCE, volume=float(curve.volume[turn + 4]), force="-60 N")
    assert state.pressure == pytest.approx(pressure[turn + 4], rel=1e-8)


def test_a_branch_without_a_limit_point_is_the_path():
    branch = mk.run(REFERENCE, mk.Step(force="20 N", pressure="0.5 bar to 1 bar", along="branch", points=40))
    state = mk.solve(REFERENCE, force="20 N", pressure=float(branch.pressure[-1]))
    assert branch.pressure[-1] >= 1e5
    assert state.length == pytest.approx(branch.length[-1], rel=1e-9)


@pytest.mark.parametrize("held", [{"pressure": "1 bar"}, {"gas": "isothermal"}], ids=["pressure", "gas"])
def test_an_interrupted_test_keeps_the_part_reached(held):
    def stop(done, total):
        if done >= 1:
            raise KeyboardInterrupt

    curve = mk.run(REFERENCE, mk.Step(length="85 mm to 120 mm", points=8, **held), watch=stop)
    assert curve.status == "interrupted"
    assert 1 <= curve.reached < 8
    assert np.isfinite(curve.force[: curve.reached]).all()
    assert curve.verdict[-1] == "not converged"
    assert str(curve.data["reason"].values[-1]) == "interrupted"


def test_the_command_saves_what_was_reached_before_ctrl_c(tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("mckibben.solver.path.follow_to", interrupted)
    case, out = tmp_path / "case.toml", tmp_path / "out.nc"
    case.write_text('[muscle]\npreset = "reference"\n[test]\nkind = "blocked-force"\npressure = "0 to 1 bar"\n')
    done = CliRunner().invoke(app, ["run", str(case), "-o", str(out), "--quiet"])
    assert done.exit_code == 130
    result = mk.load(out)
    assert (result.status, result.reached, len(result)) == ("interrupted", 1, 21)


@pytest.mark.parametrize(
    ("step", "words"),
    [
        ({"pressure": 1e5, "gas": "isothermal"}, "length or force and gas"),
        ({"length": 0.1, "gas": "helium"}, "isothermal"),
        ({"length": 0.1, "pressure": 1e5, "along": "branch"}, "needs one of two"),
    ],
)
def test_wrong_controls(step, words):
    with pytest.raises(mk.SpecError, match=words):
        mk.Step(**step)


def test_cautions_say_where_they_begin():
    weak = REFERENCE.replace("braid.fibre.breaking_force", "3 N")
    with pytest.warns(mk.MuscleWarning, match="breaking force of 3 N"):
        curve = mk.run(weak, mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    assert "from state 1" in curve.cautions[0]
    thick = mk.solve(REFERENCE.replace("chamber.thickness", "4 mm"), length="85 mm", pressure="1 bar")
    assert any("thin" in note for note in thick.cautions)
    slack = REFERENCE
    for stiffness in ("B1", "B2", "B3"):
        slack = slack.replace(f"braid.fibre.{stiffness}", 1e-10)
    slack = mk.solve(slack, length="80 mm", pressure=0.0)
    assert any("wrinkle" in note for note in slack.cautions)
    long = mk.solve(REFERENCE.replace("braid.length", "300 mm"), length="275 mm", pressure="1 bar")
    assert any("column" in note for note in long.cautions)
    assert mk.solve(REFERENCE, length="85 mm", pressure="1 bar").cautions == ()


def test_cautions_before_anything_is_solved():
    assert mk.cautions(REFERENCE, length="85 mm", pressure="1 bar") == ()
    weak = REFERENCE.replace("braid.fibre.breaking_force", "2 N").replace("chamber.thickness", "4 mm")
    weak = weak.replace("braid.fibre.diameter", "1.6 mm")
    said = " ".join(mk.cautions(weak, length="115 mm", pressure="1 bar"))
    assert "thin" in said
    assert "breaking force of 2 N" in said
    assert "jams" in " ".join(mk.cautions(weak, length="65 mm", pressure="1 bar"))
    long = REFERENCE.replace("braid.length", "300 mm")
    assert "column" in " ".join(mk.cautions(long, length="270 mm", pressure="1 bar"))
    with pytest.raises(mk.SpecError, match="one value"):
        mk.cautions(REFERENCE, length="85 to 90 mm", pressure="1 bar")
