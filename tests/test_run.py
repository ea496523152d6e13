"""Tests as a lab runs them, on the paper's actuator (its fibre and chamber values are assumed)."""

import numpy as np
import pytest

import mckibben as mk

pytestmark = pytest.mark.experiments

PAPER = mk.presets.paper()


def cases_c_and_d(length):
    return mk.Protocol([
        mk.Step(length=f"to {length}", pressure=0.0, points=5),
        mk.Step(length="hold", pressure="0 to 1 bar", points=6),
        mk.Step(force="to 0 N", pressure="hold", points=6),
    ])  # fmt: skip


@pytest.mark.parametrize(
    ("length", "forces"),
    [
        ("115 mm", [3.290, 22.978, 42.573, 62.138, 81.686, 101.221]),
        ("55 mm", [-3.196, -11.941, -20.656, -29.348, -38.025, -46.689]),
    ],
)
def test_cases_a_and_b(length, forces):
    curve = mk.run(PAPER, mk.Isometric(length=length, pressure="0 to 1 bar", points=6))
    assert curve.verdict == ("stable",) * 6
    np.testing.assert_allclose(curve.force, forces, atol=6e-4)


@pytest.mark.parametrize(("length", "strain"), [("115 mm", -0.2872), ("55 mm", 0.4905)])
def test_cases_c_and_d(length, strain):
    curve = mk.run(PAPER, cases_c_and_d(length))
    start = float(length.split()[0]) * 1e-3
    assert curve.reached == len(curve)
    assert curve.force[-1] == pytest.approx(0.0, abs=1e-9)
    assert curve.length[-1] == pytest.approx(81.976e-3, abs=5e-7)
    assert curve.length[-1] / start - 1.0 == pytest.approx(strain, abs=5e-5)


def test_stored_energy_of_case_a():
    curve = mk.run(PAPER, mk.Isometric(length="115 mm", pressure="1 bar"))
    fibres = float((curve.data["energy"] - curve.data["energy_chamber"])[0]) * 1e3
    middle = curve.data.isel(step=0, v=curve.data.sizes["v"] // 2)
    assert fibres == pytest.approx(8.65, abs=5e-3)
    assert float(curve.data["energy_chamber"][0]) * 1e3 == pytest.approx(29.36, abs=5e-3)
    assert float(middle["density_fibres"] / middle["density_chamber"]) == pytest.approx(0.033, abs=5e-4)


def test_stiff_fibres():
    stiff = PAPER.replace("braid.fibre.E", "300 GPa")
    curve = mk.run(stiff, mk.Isometric(length="55 mm", pressure="0 to 1 bar", points=6))
    np.testing.assert_allclose(curve.force[[0, 1, -1]], [-11.80, -21.31, -59.06], atol=6e-3)


def test_the_papers_discretisation():
    curve = mk.run(mk.presets.reference(), mk.Isometric(length="115 mm", pressure="1 bar"), discretisation="paper")
    assert curve.force[0] == pytest.approx(116.2196, abs=5e-5)
    assert (curve.data["modes_antisymmetric"] == -1).all()


def test_every_kind_of_test_agrees_where_they_meet():
    state = mk.solve(PAPER, force="20 N", pressure="1 bar")
    isotonic = mk.run(PAPER, mk.Isotonic(force="20 N", pressure="0.5 to 1 bar", points=3))
    isobaric = mk.run(PAPER, mk.Isobaric(pressure="1 bar", length=[0.09, state.length]))
    assert isotonic.length[-1] == pytest.approx(state.length, rel=1e-9)
    assert isobaric.force[-1] == pytest.approx(20.0, rel=1e-8)
    blocked = mk.run(PAPER, mk.BlockedForce(pressure="0 to 1 bar", points=3))
    assert blocked.length == pytest.approx(0.085)
    free = mk.run(PAPER, mk.FreeContraction(pressure="0 to 1 bar", points=3))
    assert free.force == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "pair", [("length", "force"), ("length", "volume"), ("force", "volume"), ("pressure", "volume")]
)
def test_any_two_held_give_the_same_state(pair):
    state = mk.solve(PAPER, length="105 mm", pressure="1 bar")
    again = mk.solve(PAPER, **{name: getattr(state, name) for name in pair})
    for name in ("length", "force", "pressure", "volume"):
        assert getattr(again, name) == pytest.approx(getattr(state, name), rel=1e-7)


def test_a_path_that_cannot_be_finished_keeps_the_part_reached():
    curve = mk.run(PAPER, mk.Isobaric(pressure="1 bar", length="110 to 135 mm", points=6))
    assert curve.verdict == ("stable",) * 4 + ("no equilibrium",) * 2
    assert np.isfinite(curve.force[:4]).all()
    assert np.isnan(curve.force[4:]).all()
    assert "128.7786 mm" in str(curve.data["reason"].values[-1])
    for name in ("work", "energy", "theta"):
        assert np.isfinite(curve.data[name].values[:4]).all()
        assert np.isnan(curve.data[name].values[4:]).all()


def test_steps_after_one_that_failed_are_not_tried():
    first, second = mk.Step(length="to 140 mm", pressure=0.0, points=4), mk.Step(length="hold", pressure="1 bar")
    curve = mk.run(PAPER, mk.Protocol([first, second]))
    assert curve.verdict[-1] == "not converged"
    assert "step before" in str(curve.data["reason"].values[-1])


def test_jamming_is_a_warning_with_the_state():
    tight = PAPER.replace("braid.fibre.diameter", "1.6 mm").replace("braid.fibre.E", "1 MPa")
    with pytest.warns(mk.MuscleWarning, match="state 2 .70 mm"):
        curve = mk.run(tight, mk.Isobaric(pressure="1 bar", length="85 to 70 mm", points=3))
    assert "jams" in curve.cautions[0]


def test_a_result_is_immutable_and_says_what_it_is():
    curve = mk.run(PAPER, mk.BlockedForce(pressure="0 to 1 bar", points=3))
    with pytest.raises(ValueError, match="read-only"):
        curve.force[0] = 1.0
    assert "braid.fibres" in curve.data.attrs["assumed"]
    assert all(variable.attrs["long_name"] for variable in curve.data.data_vars.values())
    units = {name: curve.data[name].attrs.get("units") for name in ("force", "length", "fibre_tension", "theta")}
    assert units == {"force": "N", "length": "m", "fibre_tension": "N", "theta": "rad"}


@pytest.mark.parametrize(("name", "value"), [("tolerance", 0.5), ("discretisation", "splines")])
def test_wrong_options(name, value):
    with pytest.raises(mk.SpecError, match=name):
        mk.run(PAPER, mk.BlockedForce(pressure="1 bar"), **{name: value})
