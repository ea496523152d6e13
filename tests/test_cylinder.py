"""The uniform cylinder with stored energy: its force against differences of the energy, and its limit, Eq. (31)."""

import math

import jax
import numpy as np
import pytest
from hypothesis import given
from muscles import Drawn, between, muscles, reference, scaled

from mckibben.model.cylinder import cylinder_angle, cylinder_force, cylinder_length, cylinder_volume
from mckibben.model.energy import stored
from mckibben.model.fibres import fibre_densities
from mckibben.model.parameters import Parameters
from mckibben.model.point import Point
from mckibben.model.textbook import virtual_work_force

pytestmark = pytest.mark.model

force = jax.jit(cylinder_force)
shares = between(0.1, 0.95)
"""Length of a cylinder as a share of the longest, H0/sin(theta0)."""

# Central differences at the offsets -4 ... 4, exact for polynomials of degree 8.
OFFSETS = np.array([-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0])
WEIGHTS = np.array([3.0, -32.0, 168.0, -672.0, 672.0, -168.0, 32.0, -3.0]) / 840.0


@jax.jit
def potential(length: jax.Array, pressure: jax.Array, p: Parameters) -> tuple[jax.Array, jax.Array]:
    """Stored energy of the whole cylinder, and the pressure's work P V that it gives up [J]."""
    theta = cylinder_angle(length, p)
    return p.H0 * stored(Point.cylinder(theta), p), pressure * cylinder_volume(theta, p)


@given(drawn=muscles(), share=shares, pressure=between(-2e4, 1e6))
def test_force_is_the_slope_of_the_potential(drawn: Drawn, share: float, pressure: float) -> None:
    """F = d(E - P V)/dh: positive where shortening would release energy, so the cylinder pulls."""
    p = drawn.parameters()
    longest = float(p.H0 / np.sin(p.theta0))
    length, step = share * longest, 0.004 * min(share, 1.0 - share) * longest
    energy, work = potential(length + step * OFFSETS, np.array(pressure), p)
    slope = float(WEIGHTS @ (energy - work)) / step
    found = float(force(cylinder_angle(np.array(length), p), np.array(pressure), p))
    rounding = 1e-15 * float(np.abs(energy).max() + np.abs(work).max()) / step
    assert found == pytest.approx(slope, rel=3e-12, abs=rounding)


@given(drawn=muscles(), theta=between(math.radians(10.0), math.radians(80.0)), pressure=between(1e4, 1e6))
def test_tends_to_the_virtual_work_force(drawn: Drawn, theta: float, pressure: float) -> None:
    """With B and c tending to 0 the difference to Eq. (31) falls in proportion, whatever the pressure: slope 1."""
    p = drawn.parameters()
    expected = float(virtual_work_force(theta, pressure, p))
    factors = np.logspace(-8, 0, 5)
    stored_part = float(force(theta, 0.0, p))
    rest = [float(force(theta, pressure, scaled(p, f))) - expected for f in factors]
    rounding = 2e-15 * (math.pi * drawn.R0**2 / math.cos(drawn.theta0) ** 2 * pressure + abs(stored_part))
    np.testing.assert_allclose(rest, factors * stored_part, rtol=0.0, atol=rounding)


def test_slope_of_the_limit() -> None:
    """The same for the reference muscle, as a slope on logarithmic axes."""
    p = reference()
    factors = np.logspace(-4, 0, 9)
    rest = [abs(force(1.0, 1e5, scaled(p, f)) - virtual_work_force(1.0, 1e5, p)) for f in factors.tolist()]
    slope, _ = np.polyfit(np.log(factors), np.log(rest), 1)
    assert slope == pytest.approx(1.0, abs=5e-12)


@given(drawn=muscles())
def test_nothing_pulls_at_rest(drawn: Drawn) -> None:
    p = drawn.parameters()
    stiff = drawn.N * float(p.B1) / drawn.R0**2 + float(p.A0) * (drawn.c1 + drawn.c2)
    assert abs(float(force(p.theta0, 0.0, p))) <= 5e-16 * stiff


@given(drawn=muscles(), share=shares)
def test_angle_and_length_are_inverse(drawn: Drawn, share: float) -> None:
    p = drawn.parameters()
    length = share * drawn.H0 / math.sin(drawn.theta0)
    theta = float(cylinder_angle(length, p))
    assert theta == pytest.approx(math.asin(share), rel=2e-15, abs=0.0)
    assert float(cylinder_length(theta, p)) == pytest.approx(length, rel=2e-15, abs=0.0)
    r = drawn.R0 * math.sqrt(1.0 - share**2) / math.cos(drawn.theta0)
    assert float(cylinder_volume(theta, p)) == pytest.approx(math.pi * r**2 * length, rel=5e-15, abs=0.0)


def test_angle_beyond_full_extension() -> None:
    p = reference()
    assert float(cylinder_angle(0.2, p)) == math.pi / 2.0


@given(drawn=muscles(), share=shares)
def test_energy_of_helical_fibres(drawn: Drawn, share: float) -> None:
    """N helices of radius r and angle theta: curvature cos^2/r and torsion sin cos/r, against those at rest."""
    p = drawn.parameters()
    theta, theta0, fibre_length = math.asin(share), drawn.theta0, drawn.H0 / math.sin(drawn.theta0)
    r = fibre_length * math.cos(theta) / (fibre_length * math.cos(theta0) / drawn.R0)  # the turns stay
    curvature = math.cos(theta) ** 2 / r - math.cos(theta0) ** 2 / drawn.R0
    torsion = math.sin(theta) * math.cos(theta) / r - math.sin(theta0) * math.cos(theta0) / drawn.R0
    bending = drawn.E * math.pi * drawn.d**4 / 64.0
    twisting = bending / (1.0 + drawn.nu)
    expected = drawn.N * fibre_length / 2.0 * (bending * curvature**2 + twisting * torsion**2)
    found = float(p.H0 * sum(fibre_densities(Point(theta, 0.0, 0.0), p)))
    rounding = 1e-15 * drawn.N * fibre_length * bending / drawn.R0**2
    assert found == pytest.approx(expected, rel=1e-14, abs=rounding)
