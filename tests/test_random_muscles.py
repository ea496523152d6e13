"""A fixed subset of the random muscles of validation/: verdicts, and states against 144 unknowns."""

import json
import math
from pathlib import Path

import pytest

import mckibben as mk

pytestmark = pytest.mark.reference

FILE = Path(__file__).parent / "data" / "random_targets.json"
TARGETS = json.loads(FILE.read_text(encoding="utf-8"))["targets"]


def muscle(target):
    m = target["muscle"]
    fibre = mk.Fibre(diameter=m["d"], E=m["E"], nu=m["nu"])
    braid = mk.Braid(radius=m["R0"], length=m["H0"], angle=m["theta0"], fibres=m["N"], fibre=fibre)
    chamber = mk.Chamber(thickness=m["t0"], law=mk.MooneyRivlin(c1=m["c1"], c2=m["c2"]))
    return mk.Muscle(braid=braid, chamber=chamber, ends=target["ends"])


def force_scale(target, force):
    """Size that an error in the force is held against: it may pass through zero."""
    return abs(force) + math.pi * target["muscle"]["R0"] ** 2 * target["held"]["pressure"]


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: f"{target['id']}: {target['expected']['verdict']}")
def test_default_call_on_a_random_muscle(target):
    expected, state = target["expected"], mk.solve(muscle(target), **target["held"])
    assert state.verdict == expected["verdict"]
    if "last_good" in expected:
        last = state.last_good
        assert math.isnan(state.force)
        assert last.verdict == "stable"
        assert last.length == pytest.approx(expected["last_good"]["length"], rel=1e-6)
        assert last.force == pytest.approx(expected["last_good"]["force"], rel=1e-5)
        assert last.error_estimate <= 1e-6
        return
    if "asymmetric" in expected:
        other = state.asymmetric
        assert other.verdict == "stable"
        assert other.force == pytest.approx(expected["asymmetric"], rel=1e-6)
    assert float(state.data["residual"]) < 1e-10
    assert state.error_estimate <= 1e-6
    if "force" in expected:  # not where a state of another shape than the direct one is given
        assert state.length == pytest.approx(expected["length"], rel=1e-6)
        assert state.force == pytest.approx(expected["force"], abs=1e-6 * force_scale(target, expected["force"]))
    for name, value in target["held"].items():
        assert getattr(state, name) == pytest.approx(value, rel=1e-10, abs=1e-10)
