"""Cautions against their closed forms: jamming at both ends, the column, broken fibres, the wall between fibres."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk
from mckibben.experiments.foresee import derived
from mckibben.measure.signs import after
from mckibben.model.column import bending_stiffness, column_load
from mckibben.model.cylinder import cylinder_force
from mckibben.model.energy import stored
from mckibben.model.jamming import across, jamming_angles
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.model.span import bulging_pressure

pytestmark = pytest.mark.measure

PAPER = mk.presets.paper()
TUBE = mk.Chamber(outer_diameter="20 mm", inner_diameter="18 mm", law=mk.NeoHookean(c1="50 kPa"))
INSIDE = PAPER.replace("chamber", TUBE)


def states(muscle: mk.Muscle, theta: float, **numbers: float) -> list[str]:
    """What is told of one state, a cylinder of this angle [rad]."""
    braid = muscle.braid
    r = braid.radius * math.cos(theta) / math.cos(braid.angle)
    own = {"length": braid.length * math.sin(theta) / math.sin(braid.angle), "pressure": 0.0, "force": 0.0}
    fields = {"theta": theta, "r": r, "fibre_tension": 0.0, "contact_pressure": 0.0, "stretch_thickness": 1.0}
    steps = {name: np.array([numbers.get(name, value)]) for name, value in own.items()}
    return after(muscle, steps, {name: np.full((1, 3), numbers.get(name, value)) for name, value in fields.items()})


@pytest.mark.parametrize(
    ("angle", "said"), [(5.9, "flat around it, as below 14.55 mm"), (84.1, "steep along it, as beyond 140.")]
)
def test_jamming_at_both_ends(angle: float, said: str) -> None:
    """Fibres of 0.36 mm touch where sin(2 theta) = N d cos(theta0)/(2 pi R0)."""
    thick = PAPER.replace("braid.fibre.diameter", "0.36 mm")
    jammed = jamming_angles(0.0125, PAPER.braid.angle, 56, 0.36e-3)
    assert_allclose(
        np.sin(2.0 * np.array(jammed)), 56 * 0.36e-3 * math.cos(PAPER.braid.angle) / (2.0 * math.pi * 0.0125)
    )
    r = 0.0125 * np.cos(jammed) / math.cos(PAPER.braid.angle)
    assert_allclose(across(r, np.array(jammed), 56), 0.36e-3, rtol=1e-12)
    theta = math.radians(angle)
    assert said in states(thick, theta)[0]
    assert states(thick, theta + math.radians(0.1 if angle < 45.0 else -0.1)) == []
    assert dict(row[:2] for row in derived(thick))["jammed"].startswith("below 14.55 mm, beyond 140.")


@pytest.mark.parametrize(("theta", "pressure"), [(0.4, 1e5), (0.7, 1e5), (1.0, 3e5)])
def test_the_bent_cylinder(theta: float, pressure: float) -> None:
    """Energy of a bent cylinder with a round section, every place of its wall at its own axial stretch, in numbers."""
    p = parameters(mk.presets.reference())
    force = float(cylinder_force(theta, pressure, p))
    R0, theta0 = float(p.R0), float(p.theta0)
    s, phi = math.sin(theta) / math.sin(theta0), np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    energy = jax.jit(jax.vmap(lambda stretch: stored(Point.cylinder(jnp.arcsin(stretch * jnp.sin(theta0))), p)))

    def bent(curvature: float) -> float:
        """Energy less the work of the loads, per unit v, at an angle per unit v [1/m]."""
        rho, around, stretch = R0, np.ones_like(phi), np.ones_like(phi)
        for _ in range(60):  # the wall goes around the section once
            stretch = s + curvature * rho * np.cos(phi)
            around = np.cos(np.arcsin(stretch * math.sin(theta0))) / math.cos(theta0)
            rho = R0 / np.mean(1.0 / around)
        inside = np.asarray(energy(jnp.asarray(stretch))) * rho / (R0 * around)
        return float(np.mean(inside) - pressure * np.pi * rho**2 * s)

    found = s * (bent(0.5) - 2.0 * bent(0.0) + bent(-0.5)) / 0.25
    assert float(bending_stiffness(theta, force, pressure, p)) == pytest.approx(found, rel=3e-4, abs=0.0)


def test_a_net_that_stores_nothing_as_a_column() -> None:
    """B = pi r^4 P tan^2(theta) (1 + 3 tan^2(theta))."""
    p = parameters(mk.presets.reference())
    p = p._replace(B1=0.0 * p.B1, B2=0.0 * p.B2, B3=0.0 * p.B3, A0=0.0 * p.A0)
    theta, P = 0.5, 2e5
    r, steep = float(p.R0) * math.cos(theta) / math.cos(float(p.theta0)), math.tan(theta) ** 2
    found = bending_stiffness(theta, cylinder_force(theta, P, p), P, p)
    assert float(found) == pytest.approx(math.pi * r**4 * P * steep * (1.0 + 3.0 * steep), rel=1e-12, abs=0.0)
    assert float(column_load(0.3, found)) == pytest.approx(4.0 * math.pi**2 * float(found) / 0.09, rel=1e-12, abs=0.0)


def test_a_muscle_that_pushes_may_bow() -> None:
    long = mk.presets.reference().replace("braid.length", "300 mm")
    (said,) = mk.cautions(long, length="270 mm", pressure="1 bar")
    theta = math.asin(0.9 * math.sin(long.braid.angle))
    p = parameters(long)
    force = float(cylinder_force(theta, 1e5, p))
    bears = float(column_load(0.27, bending_stiffness(theta, force, 1e5, p)))
    assert -force > bears > 0.0
    assert f"it pushes with {-force:.3g} N, and bows like a column from about {bears:.3g} N" in said
    assert states(long, theta, force=-0.49 * bears, pressure=1e5) == []  # B is a little larger at less force
    stubby = mk.presets.reference().replace("braid.length", "120 mm")
    assert mk.cautions(stubby, length="108 mm", pressure="1 bar") == ()


def test_a_fibre_that_breaks_tells_its_safety() -> None:
    weak = PAPER.replace("braid.fibre.breaking_force", "3 N")
    (said,) = states(weak, 0.8, fibre_tension=4.0)
    assert said.endswith("exceeds the breaking force of 3 N: 4 N, a safety factor of 0.75")
    assert states(weak, 0.8, fibre_tension=2.9) == []


def test_a_wall_that_bulges_between_fibres() -> None:
    """5.25 mu t/w; twice a slit's arc; the paper's wall lies around the fibres and spans nothing."""
    half = 4.0 * (math.pi / 2.0 - (2.0 / math.pi) ** 3)
    assert bulging_pressure(1e-3, 0.5e-3, 1e5) == pytest.approx(half * 1e5 * 0.5e-3 / 1e-3)
    small = 0.01  # small arcs: plane strain of a linear sheet, 4 mu t (lambda - 1) sin(beta) 2/w, twice
    linear = 4.0 / 1e-3 * 4.0 * 1e5 * 0.5e-3 * small**3 / 6.0
    assert bulging_pressure(1e-3, 0.5e-3, 1e5, small) == pytest.approx(linear, rel=1e-3)
    theta = PAPER.braid.angle
    width = 4.0 * math.pi * 0.0125 * math.sin(theta) / 56 - 0.25e-3
    bears = half * 1e5 * 1e-3 / width
    assert states(INSIDE, theta, pressure=0.99 * bears) == []
    (said,) = states(INSIDE, theta, pressure=1.01 * bears)
    assert "the wall, 1 mm there, bulges by half a circle and more through the openings of 1.4 mm" in said
    assert states(PAPER, theta, pressure=1.01 * bears) == []
