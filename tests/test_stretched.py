"""States so near full extension that the direct search fails and the force is sought instead."""

import pytest

import mckibben as mk
from mckibben.search.near_extension import stretched
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held

pytestmark = pytest.mark.solver

REFERENCE = mk.presets.reference()
BENCH = Bench.of(REFERENCE)
PRESSURE = 1e5


def direct(gap):
    """What the direct search makes of a length short of full extension by a share of it."""
    held = Held.of(length=BENCH.longest * (1.0 - gap), pressure=PRESSURE)
    return held, find(BENCH.problem(24, BENCH.placement(held)), held)


@pytest.mark.parametrize("gap", [1e-4, 1e-6])
def test_a_state_that_the_direct_search_misses(gap):
    held, failed = direct(gap)
    assert not failed.converged
    state = mk.solve(REFERENCE, length=held.get("length"), pressure=PRESSURE)
    assert state.verdict == "stable"
    assert state.error_estimate < 1e-5
    # the force that was found gives the length back, on points placed for that force and without a secant
    back = mk.solve(REFERENCE, force=state.force, pressure=PRESSURE)
    assert BENCH.longest - back.length == pytest.approx(gap * BENCH.longest, rel=1e-4)
    assert state.length == pytest.approx(held.get("length"), rel=1e-12)


def test_both_ways_agree_where_both_work():
    held, found = direct(1e-3)
    assert found.converged
    state = stretched(BENCH, found, held, 1e-6)
    assert state.force == pytest.approx(
        mk.solve(REFERENCE, length=held.get("length"), pressure=PRESSURE).force, rel=1e-6
    )


def test_the_error_estimate_is_honest_close_to_full_extension() -> None:
    """At 1 - 8e-6 of full extension, where the conserved quantity alone says 45 times too little."""
    fibre = mk.Fibre(B1=12.36506522849355e-6, B2=12.36506522849355e-6, B3=8.832189448923966e-6)
    muscle = mk.Muscle(
        braid=mk.Braid(
            radius=3.6123233924714824e-3, length=60.9814672862168e-3, angle=1.1157886089648457, fibres=90, fibre=fibre
        ),
        chamber=mk.Chamber(
            thickness=0.7614691435950038e-3, law=mk.MooneyRivlin(c1=61268.28369647578, c2=2585.619338879918)
        ),
        ends="pinned",
    )
    held = {"length": 66.2163898041386e-3, "pressure": 109077.22796921719}
    exact = mk.solve(muscle, **held, tolerance=1e-10).force
    for tolerance in (1e-4, 1e-6, 1e-8):
        state = mk.solve(muscle, **held, tolerance=tolerance)
        assert abs(state.force / exact - 1.0) <= state.error_estimate <= tolerance
