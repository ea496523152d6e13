"""Fittings that give way: a spring in series with the braid, whatever is held."""

from typing import Any

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk

pytestmark = pytest.mark.measure

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
