"""Limits of the reference muscle, and what ends a path."""

import math

import pytest
from cases import CASES

import mckibben as mk

pytestmark = pytest.mark.experiments

REFERENCE = mk.presets.reference()
LIMITS = [case for case in CASES["limits_default"] if "P" in case]


@pytest.mark.parametrize("case", LIMITS, ids=lambda case: f"{case['bc']}-{case['P']}")
def test_shortest_stable_length(case):
    found = mk.limits(REFERENCE.replace("ends", case["bc"]), pressure=case["P"] * 1e6)
    assert found.stable_down_to * 1e3 == pytest.approx(case["limit_h"], rel=1e-6)
    assert found.stable_force == pytest.approx(case["F"], rel=1e-6)
    assert found.longest * 1e3 == pytest.approx(CASES["full_extension_mm"], rel=1e-9)
    assert found.shortest >= found.stable_down_to * (1 - 1e-9)
    if found.shortest > found.stable_down_to * (1 + 1e-6):  # the wall meets the fitting first
        assert "behind its fitting" in found.shortest_cause
    # compression is largest where stability under force control ends, or where the path does
    assert found.force_extremum <= found.shortest_force * (1 - 1e-9)


def test_least_pressure_that_holds_a_length():
    case = next(case for case in CASES["limits_default"] if "h" in case)
    muscle = REFERENCE.replace("ends", case["bc"])
    length = case["h"] * 1e-3
    stable = mk.least_pressure(muscle, length=length, shapes=False)
    assert stable * 1e-6 == pytest.approx(case["limit_P"], rel=1e-6)
    held = mk.least_pressure(muscle, length=length)
    assert held > stable  # pinned ends lean back before they give way
    assert mk.solve(muscle, length=length, pressure=held * 1.001).verdict == "stable"
    below = mk.solve(muscle, length=length, pressure=held * 0.98)
    assert below.verdict == "inadmissible"
    assert "or more holds 55 mm" in below.reason
    assert below.last_good.verdict == "stable"
    with pytest.warns(mk.MuscleWarning, match="the longest possible length"):
        assert math.isnan(mk.least_pressure(muscle, length="130 mm"))


def test_no_pressure_is_needed_near_the_initial_length():
    assert mk.least_pressure(REFERENCE, length="85 mm") == 0.0


def test_working_range_narrows_nowhere_with_pressure():
    region = mk.working_range(REFERENCE, pressures=[0.0, "1 bar", "3 bar"])
    shortest = region["shortest"].values
    assert shortest[0] > shortest[1] > shortest[2]
    assert (region["longest"].values == region["longest"].values[0]).all()
    assert region["shortest"].attrs["units"] == "m"


def test_force_map_is_the_isobaric_curves():
    grid = mk.force_map(REFERENCE, length=[0.08, 0.1, 0.13], pressure=["0 bar", "1 bar"])
    assert dict(grid.sizes) == {"pressure": 2, "length": 3}
    state = mk.solve(REFERENCE, length=0.1, pressure="1 bar")
    assert float(grid["force"][1, 1]) == pytest.approx(state.force, rel=1e-8)
    assert math.isnan(float(grid["force"][1, 2]))
    assert str(grid["verdict"][1, 2].values) == "no equilibrium"


@pytest.mark.parametrize("value", ["0 to 1 bar", "-2 bar", "1 mm"])
def test_wrong_pressure(value):
    with pytest.raises(mk.SpecError, match="pressure"):
        mk.limits(REFERENCE, pressure=value)
