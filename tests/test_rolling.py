"""Fibres that roll where they cross: against finite elements of the rods, and against fibres that also stretch."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk

pytestmark = pytest.mark.effects

# Bare braid without pressure: F (8/N)/d^4 [N/mm^4] of the model with roll by an independent code, to the digits given,
# and of a finite-element model of 56 rods with spherical joints (theory page).
STORED = [
    ("clamped", 80.0, -0.27623, -0.27624),
    ("clamped", 95.0, 0.74544, 0.74545),
    ("clamped", 115.0, 4.49983, 4.49903),
    ("pinned", 95.0, 0.49861, 0.49864),
    ("pinned", 115.0, 2.45704, 2.45066),
]
LARGEST = {("clamped", 115.0): 27.0, ("pinned", 115.0): 49.0}
"""Roll [deg] that the finite elements show, to a degree."""


def pinned_crossings(**changes: str) -> mk.Muscle:
    """The paper's muscle with crossings that share their position alone."""
    muscle = mk.presets.paper().replace("braid.joint", "pin")
    for name, value in changes.items():
        muscle = muscle.replace(name, value)
    return muscle


@pytest.mark.parametrize(("ends", "length", "stored", "rods"), STORED)
def test_bare_braid(ends: str, length: float, stored: float, rods: float) -> None:
    state = mk.solve(pinned_crossings(ends=ends).replace("chamber", None), length=1e-3 * length, pressure=0.0)
    force = state.force * 8.0 / 56.0 / 0.25**4
    assert_allclose(force, stored, atol=6e-6)
    assert_allclose(force, rods, rtol=3e-3)
    roll = np.degrees(state.result.data["roll"].values[0])
    if (ends, length) in LARGEST:
        assert np.abs(roll).max() == pytest.approx(LARGEST[ends, length], abs=0.6)
    assert_allclose(roll, -roll[::-1], atol=1e-12)
    assert abs(roll[0]) < 1e-12 or ends == "pinned"


@pytest.mark.parametrize(
    ("fibres", "diameter", "stored", "rods"), [(56, "0.25 mm", 97.94, 97.80), (28, "1 mm", 117.39, 117.20)]
)
def test_pressurised_braid(fibres: int, diameter: str, stored: float, rods: float) -> None:
    """The joint matters little with thin fibres (98.33 N with hinges), and much with thick ones (131.15 N)."""
    muscle = pinned_crossings().replace("chamber", None).replace("braid.fibres", fibres)
    state = mk.solve(muscle.replace("braid.fibre.diameter", diameter), length="115 mm", pressure="1 bar")
    assert_allclose(state.force, stored, atol=6e-3)
    assert_allclose(state.force, rods, rtol=2e-3)


def test_tension_is_that_of_fibres_that_hardly_stretch() -> None:
    """The multiplier, which needs the derivatives of psi' and of the roll's rate, against the law of stiff fibres."""
    held = {"length": "115 mm", "pressure": "1 bar", "tolerance": 1e-9}
    inner = slice(16, 113)  # a layer of width d/4 sqrt(E A/(axial stiffness)) at the fittings is not resolved
    exact = mk.solve(pinned_crossings(), **held).result.data["fibre_tension"].values[0, inner]  # type: ignore[arg-type]
    off = []
    for axial in ("1e4 N", "1e5 N"):
        stiff = pinned_crossings().replace("braid.fibre.stretch", True).replace("braid.fibre.axial_stiffness", axial)
        found = mk.solve(stiff, **held).result.data["fibre_tension"].values[0, inner]  # type: ignore[arg-type]
        off.append(np.abs(found - exact).max() / exact.max())
    assert off[0] < 2e-3
    assert off[1] < 0.15 * off[0]  # a tenth, and what the mesh leaves of a law as steep as this


def test_work_is_stored() -> None:
    curve = mk.run(pinned_crossings(ends="pinned"), mk.Isobaric(pressure="1 bar", length="100 mm to 115 mm", points=61))
    stored = curve.data["energy"].values[-1] - curve.data["energy"].values[0]
    assert_allclose(curve.data["work"].values[-1], stored, rtol=1e-6)
    assert curve.data["conserved_variation"].max() < 1e-6


def test_files_say_the_joint_where_it_is_no_hinge() -> None:
    assert "joint" not in repr(mk.presets.paper())
    assert "joint='pin'" in repr(pinned_crossings())
    with pytest.raises(mk.SpecError, match="one of hinge, pin"):
        mk.presets.paper().replace("braid.joint", "glue")
