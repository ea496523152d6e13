"""States and verdicts against values from an independent solver."""

import math

import pytest
from cases import CASES, held, muscle, relative_error

import mckibben as mk

pytestmark = pytest.mark.reference

REFERENCE = pytest.mark.parametrize("case", CASES["reference"], ids=lambda case: case["name"])


@REFERENCE
def test_states_at_a_tight_tolerance(case):
    state = mk.solve(muscle(case), **held(case), tolerance=1e-10)
    assert relative_error(case, state) < 1e-7
    assert state.volume * 1e9 == pytest.approx(case["volume_mm3"], rel=1e-7)
    counts = case["negative_modes"]
    assert state.modes.length_control == counts["symmetric_length_control"]
    assert state.modes.force_control == counts["symmetric_force_control"]
    assert state.modes.antisymmetric == counts["antisymmetric"]
    assert state.data["shape"] == case["shape"]
    assert state.verdict == ("unstable" if counts["antisymmetric"] else "stable")


@REFERENCE
def test_default_tolerance_is_met_and_the_estimate_bounds_the_error(case):
    state = mk.solve(muscle(case), **held(case))
    error = relative_error(case, state)
    assert error < 1e-6
    assert state.error_estimate <= 1e-6
    # the reference itself is good to 8 digits
    assert error <= max(state.error_estimate, 1e-9)


@pytest.mark.parametrize("case", CASES["hard"], ids=lambda case: case["id"])
def test_hard_targets_get_their_verdict(case):
    m, pressure = muscle(case), case["pressure_MPa"] * 1e6
    state = mk.solve(m, length=case["length_mm"] * 1e-3, pressure=pressure)
    if case["verdict"].startswith("no admissible state"):
        assert state.verdict == "inadmissible"
        assert math.isnan(state.force)
        assert state.last_good.verdict == "stable"
        # the reference bracketed its branch ends along its own path: they agree to that bracket
        assert state.last_good.length * 1e3 == pytest.approx(case["branch_end"]["length_mm"], rel=1.5e-3)
        assert "good states end at" in state.reason
    else:
        assert case["verdict"] == "antisymmetrically unstable"
        assert state.verdict == "unstable"
        assert state.modes.antisymmetric == 1
        assert "asymmetric state" in state.reason
        assert state.asymmetric is None or state.asymmetric.verdict == "stable"


def test_asymmetric_minimum_of_t47():
    case = next(case for case in CASES["reference"] if case["name"] == "R25")
    state = mk.solve(muscle(case), **held(case))
    assert state.asymmetric.force == pytest.approx(-51.7666, abs=5e-5)
    # it stores less energy than the symmetric state of the same length and pressure, loads included
    P = case["pressure_MPa"] * 1e6
    tipped, straight = state.asymmetric, state
    potential = [float(s.data["energy"]) - P * s.volume for s in (tipped, straight)]
    assert potential[0] < potential[1]


def test_full_extension_has_no_equilibrium():
    m = mk.presets.reference()
    longest = CASES["full_extension_mm"] * 1e-3
    assert mk.solve(m, length=longest, pressure="1 bar").verdict == "no equilibrium"
    near = [mk.solve(m, length=longest * (1 - gap), pressure="1 bar") for gap in (1e-2, 1e-3, 1e-4)]
    assert [state.verdict for state in near] == ["stable"] * 3
    assert near[0].force < near[1].force < near[2].force
