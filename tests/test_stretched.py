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
