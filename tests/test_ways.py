"""Targets without a state: where good states on the way there end, by pressure where the start of the way has none."""

import numpy as np
import pytest

import mckibben as mk
from mckibben.experiments.answer import answer
from mckibben.measure.bore import narrowest_bore
from mckibben.measure.judge import shape_of
from mckibben.measure.meridian import meridian
from mckibben.search.elsewhere import way_there
from mckibben.solver.arclength import branch
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held

pytestmark = pytest.mark.solver

SOFT = mk.Muscle(
    braid=mk.Braid(
        radius="16 mm", length="46 mm", angle="60 deg", fibres=88,
        fibre=mk.Fibre(diameter="0.12 mm", E="0.5 GPa", nu=0.4, stretch=True),
    )
)  # fmt: skip
"""Fibres that pull with 5.7 N where they are twice as long."""
SOLID = mk.Muscle(
    braid=mk.Braid(
        radius="23.6 mm", length="332 mm", angle="45.2 deg", fibres=36,
        fibre=mk.Fibre(diameter="0.32 mm", E="0.86 GPa", nu=0.4),
    ),
    chamber=mk.Chamber(
        outer_diameter="43.2 mm", inner_diameter="28.4 mm", length="317 mm", wall="thick", gap=True,
        law=mk.NeoHookean(c1="22 kPa"),
    ),
)  # fmt: skip
"""A tube with so much rubber that it fills the braid before the fibres are straight."""


def test_soft_fibres_are_blown_up_before_the_pressure_is_there() -> None:
    """No state at 3 bar at any length near rest: what is told is how far the pressure goes at rest, and why no further.

    Followed by arclength past that end, the branch bulges further behind its fitting and never comes to 3 bar.
    """
    bench = Bench.of(SOFT)
    found = answer(bench, Held.of(length=0.0465, pressure=3e5), 1e-6, thorough=False)
    assert found.verdict == "inadmissible"
    assert "from 46 mm and 0 bar good states end at" in found.reason
    assert "behind its fitting" in found.reason
    last = found.way.end.last.state
    assert last.length == pytest.approx(0.046, rel=1e-12)

    start, far = Held.of(length=0.046, pressure=0.98 * last.pressure), Held.of(length=0.046, pressure=3e5)
    problem = bench.problem(24, bench.placement(far))
    here = find(problem, Held.of(length=0.046, pressure=0.0))
    for share in (0.25, 0.5, 0.75, 1.0):
        here = find(problem, Held.of(length=0.046, pressure=share * 0.98 * last.pressure), here, 0.3)
    assert here.converged
    track = branch(problem, here, [start.towards(far, k / 15) for k in range(16)])
    found = [track.state(k) for k in range(track.reached)]
    shapes = [shape_of(*(line[0] for line in meridian(problem, one.u[None]))) for one in found]
    ends = next(k for k, shape in enumerate(shapes) if shape == "behind the end plane")
    assert found[ends - 1].pressure <= last.pressure <= found[ends].pressure
    assert all(shape == "behind the end plane" for shape in shapes[ends:])
    assert max(one.pressure for one in found) < 1.5e5


@pytest.mark.parametrize("share", [0.2, 0.4])
def test_a_free_cylinder_of_soft_fibres_has_a_radius_in_closed_form(share: float) -> None:
    """1 - 1/lambda of the pressure that a cylinder never reaches; bending, which that leaves out, is 1e-6 of it."""
    free, angle, pull = SOFT.replace("ends", "free"), np.radians(60.0), 0.5e9 * np.pi / 4.0 * 0.12e-3**2
    limit = 88 * pull * np.cos(angle) ** 2 / (2.0 * np.pi * 0.016**2 * np.sin(angle))
    state = mk.solve(free, length="46 mm", pressure=share * limit)
    radius = 0.016 / np.cos(angle) * np.sqrt(1.0 / (1.0 - share) ** 2 - np.sin(angle) ** 2)
    assert state.verdict == "stable"
    assert float(state.data["r"].max()) == pytest.approx(radius, rel=2e-6)


def test_a_tube_that_fills_the_braid_ends_the_way() -> None:
    """The bore closes there, and the force grows without the length; points are placed for lengths beyond as well."""
    bench = Bench.of(SOLID)
    held = Held.of(length=0.425, pressure=0.0)
    b = bench.placement(held)
    assert np.isfinite(b)
    end = way_there(bench, held, b, 1e-6, roughly=True).end
    assert not end.complete
    assert end.cause.verdict == "inadmissible"
    assert "the bore of the tube closes" in end.cause.reason
    last = end.last.state
    assert narrowest_bore(last.problem, last.u, last.loads) < 0.05
    before = find(last.problem, Held.of(length=last.length - 1e-3, pressure=0.0), last, 0.3)
    assert before.converged
    assert last.force > 2.0 * before.force


def test_how_far_open_a_bore_is() -> None:
    """On a cylinder by the volume of rubber, which does not change; a thin wall has no bore to close."""
    problem = Bench.of(SOLID.replace("chamber.gap", False)).problem(12, 1.0)
    u, loads = np.zeros(problem.basis.unknowns), np.zeros(2)
    r, section = 23.6e-3, (21.6e-3**2 - 14.2e-3**2) * 317.0 / 332.0
    assert narrowest_bore(problem, u, loads) == pytest.approx(np.sqrt(1.0 - section / r**2), rel=1e-12)
    alone = Bench.of(SOLID).problem(12, 1.0)  # stretched along its axis, it keeps its proportions
    assert narrowest_bore(alone, u, loads) == pytest.approx(14.2 / 21.6, rel=1e-9)
    thin = Bench.of(mk.presets.reference()).problem(12, 1.0)
    assert narrowest_bore(thin, np.zeros(thin.basis.unknowns), loads) == 1.0
