"""Fittings that give way: a spring in series with the braid, whatever is held."""

from typing import Any

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk

pytestmark = pytest.mark.effects

C = 1e-5
"""Compliance [m/N]: that of the theory page's Festo membrane, 0.0101 mm/N, rounded."""


def giving(compliance: float = C, **changes: Any) -> mk.Muscle:
    """The paper's muscle in fittings that give way."""
    muscle = mk.presets.paper().replace("fittings", mk.Fittings(compliance=compliance))
    for name, value in changes.items():
        muscle = muscle.replace(name, value)
    return muscle


def test_a_spring_in_series() -> None:
    """At one force and pressure the braid is in the same state, and the muscle longer by C F."""
    rigid = mk.presets.paper()
    for length in ("100 mm", "115 mm"):
        state = mk.solve(giving(), length=length, pressure="1 bar", tolerance=1e-9)
        within = mk.solve(rigid, length=state.length - C * state.force, pressure="1 bar", tolerance=1e-9)
        assert state.verdict == "stable"
        assert_allclose(within.force, state.force, rtol=1e-8)
        assert_allclose(within.volume, state.volume, rtol=1e-9)
        data = state.result.data.isel(step=0)
        assert_allclose(data["z"][-1], within.length, rtol=1e-8)
        assert_allclose(data["energy_fittings"], 0.5 * C * state.force**2, rtol=1e-9)
        assert_allclose(data["r"][64], within.result.data["r"][0, 64], rtol=1e-8)


def test_controls() -> None:
    """Held by force, by volume, or with what is sealed in, the same states are found."""
    muscle = giving()
    state = mk.solve(muscle, length="110 mm", pressure="1 bar")
    by_force = mk.solve(muscle, force=state.force, pressure="1 bar")
    by_volume = mk.solve(muscle, length="110 mm", volume=state.volume)
    assert_allclose(by_force.length, 0.11, rtol=1e-8)
    assert_allclose(by_volume.pressure, 1e5, rtol=1e-6)


def test_no_length_is_too_long() -> None:
    """The braid stops at full extension, 128.8 mm; its fittings do not."""
    curve = mk.run(giving(), mk.Isobaric(pressure="1 bar", length="120 mm to 150 mm", points=7))
    assert curve.verdict == ("stable",) * 7
    braid = curve.data["z"].values[:, -1]
    assert_allclose(curve.length, braid + C * curve.force, rtol=1e-9)
    assert braid.max() < 0.12878
    assert curve.force[-1] > 1e3


def test_work_is_stored() -> None:
    curve = mk.run(giving(), mk.Isobaric(pressure="1 bar", length="100 mm to 115 mm", points=61))
    stored = curve.data["energy"].values[-1] - curve.data["energy"].values[0]
    assert_allclose(curve.data["work"].values[-1], stored, rtol=1e-6)


def test_slope_by_the_compliance() -> None:
    """dF/dC = -k F/(1 + k C) at a length held, with k the stiffness of the braid."""
    test = mk.Isometric(length="110 mm", pressure="1 bar")
    muscle = giving()
    found = mk.response(muscle, test, tolerance=1e-9)
    F = float(found["force"][0])
    by = float(jax.grad(lambda m: mk.response(m, test, tolerance=1e-9)["force"][0])(muscle).fittings.compliance)
    h, rigid = 0.11 - C * F, mk.presets.paper()
    k = jax.grad(
        lambda length: mk.response(rigid, mk.Isometric(length=length, pressure="1 bar"), tolerance=1e-9)["force"][0]
    )(h)
    assert by == pytest.approx(float(-k * F / (1.0 + k * C)), rel=1e-7, abs=0.0)


def test_short_muscles_lose_force() -> None:
    """What a rigid fitting cannot show: at its rest length the force falls as the muscle gets shorter."""
    lengths = np.array([0.08, 0.16, 0.32])
    forces = [mk.solve(giving(**{"braid.length": h}), length=h, pressure="1 bar").force for h in lengths.tolist()]
    rigid = [
        mk.solve(mk.presets.paper().replace("braid.length", h), length=h, pressure="1 bar").force
        for h in lengths.tolist()
    ]
    assert (np.diff(forces) > 0.0).all()
    assert_allclose(rigid, rigid[0], rtol=1e-9)  # the cylinder, whose forces do not depend on the length


@pytest.mark.parametrize("compliance", ["-0.01 mm/N", 0.0, "3 mm"])
def test_wrong_input(compliance: Any) -> None:
    with pytest.raises(mk.SpecError, match=r"fittings\.compliance"):
        mk.Fittings(compliance=compliance)


DEAD = 0.007
"""Dead length [m] of the tests."""
TEST = mk.Isobaric(pressure="1 bar", length=["92 mm", "122 mm", "136 mm"])


def hiding(dead: float = DEAD) -> mk.Muscle:
    """The paper's muscle with a dead length under its fittings."""
    return mk.presets.paper().replace("fittings", mk.Fittings(dead_length=dead))


def test_a_dead_length_shifts_lengths() -> None:
    """The braid is in the state of a muscle shorter by the dead length; contraction is of the whole."""
    plain = mk.run(mk.presets.paper(), mk.Isobaric(pressure="1 bar", length=[0.085, 0.115, 0.129]))
    found = mk.run(hiding(), TEST)
    assert found.verdict == plain.verdict == ("stable", "stable", "no equilibrium")
    assert found.data["reason"].values[2].endswith("straight at 135.7786 mm, the longest possible length")
    assert_allclose(found.force, plain.force, rtol=1e-9)
    assert_allclose(found.data["volume"], plain.data["volume"], rtol=1e-9)
    assert_allclose(found.data["z"].values[:2, -1], found.length[:2] - DEAD, rtol=1e-9)
    assert_allclose(found.contraction[:2], [0.0, -0.03 / 0.092], atol=1e-12)
    assert_allclose(found.data["energy"], plain.data["energy"], rtol=1e-9, atol=1e-15)
    formula = mk.textbook_force(hiding(), length=[0.092, 0.122, 0.15], pressure=1e5)
    assert_allclose(formula, mk.textbook_force(mk.presets.paper(), length=[0.085, 0.115, 0.143], pressure=1e5))


def test_a_dead_length_in_tests_and_limits() -> None:
    """Free contraction is that of the braid in parts of the whole; limits are those of the braid, longer."""
    ratio = 0.085 / (0.085 + DEAD)
    test = mk.FreeContraction(pressure=["0.5 bar", "1 bar"])
    free = mk.run(hiding(), test)
    assert_allclose(free.contraction, ratio * mk.run(mk.presets.paper(), test).contraction, rtol=1e-7)
    (step,) = mk.BlockedForce(pressure="1 bar").as_steps(hiding())
    assert step.length.waypoints == (0.085 + DEAD,)
    found, plain = (mk.limits(muscle, pressure="1 bar") for muscle in (hiding(), mk.presets.paper()))
    for name in ("shortest", "longest", "stable_down_to", "force_extremum_length"):
        assert getattr(found, name) == pytest.approx(getattr(plain, name) + DEAD, abs=1e-8)
    assert found.shortest_force == pytest.approx(plain.shortest_force, rel=1e-5)
    assert mk.cautions(hiding(), length="122 mm", pressure="1 bar") == ()


def test_slopes_by_the_dead_length() -> None:
    """dF/d(dead length) = -dF/dh at a length held."""

    def force(muscle: mk.Muscle, length: Any) -> Any:
        return mk.response(muscle, mk.Isometric(length=length, pressure="1 bar"), tolerance=1e-9)["force"][0]

    by_muscle, by_length = jax.grad(force, (0, 1))(hiding(), 0.122)
    assert float(by_muscle.fittings.dead_length) == pytest.approx(-float(by_length), rel=1e-9, abs=0.0)


def test_a_sweep_of_the_dead_length(tmp_path: Any) -> None:
    over = {"fittings.dead_length": [0.0, DEAD]}
    held = mk.sweep(hiding(), mk.Isometric(length="115 mm", pressure="1 bar"), over, workers=1)
    assert (held["method"] == 0).all()
    alone = [mk.solve(mk.presets.paper(), length=0.115 - dead, pressure="1 bar").force for dead in (0.0, DEAD)]
    assert_allclose(held["force"].values[:, 0], alone, rtol=1e-9)
    parts = mk.sweep(hiding(), mk.Isometric(contraction="-10 %", pressure="1 bar"), over, workers=1)
    assert_allclose(parts["length"].values[:, 0], [1.1 * 0.085, 1.1 * (0.085 + DEAD)], rtol=1e-9)


def test_files_of_a_dead_length(tmp_path: Any) -> None:
    found = mk.run(hiding(), TEST)
    mk.save(found, tmp_path / "curve.nc")
    assert mk.load(tmp_path / "curve.nc") == found
    assert mk.plot(found).axes
    with pytest.raises(mk.SpecError, match="fittings: are given nothing; give compliance, dead_length or both"):
        mk.Fittings()
    with pytest.raises(mk.SpecError, match=r"fittings\.dead_length = -1 mm: must be at least 0 mm"):
        mk.Fittings(dead_length="-1 mm")


def test_a_dead_length_beside_a_compliance() -> None:
    both = mk.presets.paper().replace("fittings", mk.Fittings(compliance=C, dead_length=DEAD))
    state = mk.solve(both, length="117 mm", pressure="1 bar")
    without = mk.solve(giving(), length="110 mm", pressure="1 bar")
    assert_allclose(state.force, without.force, rtol=1e-9)
    assert not mk.run(giving(), TEST).data["length"].isnull().any()


def test_the_papers_mesh_has_rigid_fittings() -> None:
    test = mk.Isometric(length="122 mm", pressure="1 bar")
    with pytest.raises(mk.SpecError, match="in rigid fittings of its own radius"):
        mk.run(giving(), test, discretisation="paper")
