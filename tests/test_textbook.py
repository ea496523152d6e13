"""Eq. (31), Chou-Hannaford and Tondu-Lopez: one formula in three sets of variables, and its magic angle."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from muscles import MAGIC, Drawn, between, muscles, reference, scaled

from mckibben.model.cylinder import cylinder_force, cylinder_length, cylinder_volume
from mckibben.model.parameters import Parameters
from mckibben.model.textbook import chou_hannaford_force, thread, tondu_lopez_force, virtual_work_force

pytestmark = pytest.mark.model

EPS = float(np.finfo(float).eps)
braid_angles = between(math.radians(5.0), math.radians(85.0))


def size(p: Parameters, pressure: float) -> float:
    """Size of the formulas' terms [N], which sets their rounding error: they cancel near the magic angle."""
    return float(3.0 * jnp.pi * (p.R0 / jnp.cos(p.theta0)) ** 2 * abs(pressure))


@given(drawn=muscles(), theta=braid_angles, pressure=between(-1e5, 1e6))
def test_all_formulas_are_the_cylinder_without_stored_energy(drawn: Drawn, theta: float, pressure: float) -> None:
    p = drawn.parameters()
    length, (b, n) = cylinder_length(theta, p), thread(p)
    forces = [
        virtual_work_force(theta, pressure, p),
        chou_hannaford_force(length, pressure, b, n),
        tondu_lopez_force(1.0 - length / p.H0, pressure, p.R0, jnp.pi / 2.0 - p.theta0),
        jax.jit(cylinder_force)(theta, pressure, scaled(p, 0.0)),
    ]
    assert float(np.ptp(forces)) <= 10.0 * EPS * size(p, pressure)


def test_tension_of_a_stretched_muscle() -> None:
    """Eq. (31) at the mid angle of the stretched default muscle: 95.70 N (theory page), for an angle to 0.005 deg."""
    p = reference()
    assert float(virtual_work_force(math.radians(59.86), 1e5, p)) == pytest.approx(95.70, abs=0.02)


@given(drawn=muscles(), pressure=between(1e3, 1e6))
def test_no_force_at_the_magic_angle_only(drawn: Drawn, pressure: float) -> None:
    p = drawn.parameters()
    b, n = thread(p)

    def forces(theta: float) -> np.ndarray:
        length = cylinder_length(theta, p)
        return np.stack([
            virtual_work_force(theta, pressure, p),
            chou_hannaford_force(length, pressure, b, n),
            tondu_lopez_force(1.0 - length / p.H0, pressure, p.R0, jnp.pi / 2.0 - p.theta0),
        ])  # fmt: skip

    rounding = 8.0 * EPS * size(p, pressure)
    assert np.abs(forces(MAGIC)).max() <= rounding
    assert forces(MAGIC + 1e-9).min() > rounding  # a muscle that contracts, so it pulls
    assert forces(MAGIC - 1e-9).max() < -rounding


@given(drawn=muscles(), theta=braid_angles)
def test_a_cylinder_holds_most_at_the_magic_angle(drawn: Drawn, theta: float) -> None:
    """Stationary there, and nowhere larger (Fig. 1)."""
    p = drawn.parameters()
    most = float(cylinder_volume(MAGIC, p))
    assert abs(float(jax.grad(cylinder_volume)(MAGIC, p))) <= 12.0 * EPS * most
    # With x = sin(theta), V ~ (1 - x^2) x is below its maximum at 1/sqrt 3 by exactly (x - 1/sqrt 3)^2 (x + 2/sqrt 3).
    x, top = math.sin(theta), math.sqrt(1.0 / 3.0)
    below = (x - top) ** 2 * (x + 2.0 * top) / (top * (1.0 - top**2))
    assert float(cylinder_volume(theta, p)) == pytest.approx(most * (1.0 - below), abs=8.0 * EPS * most)


@given(drawn=muscles())
def test_thread_is_the_helix_of_a_fibre(drawn: Drawn) -> None:
    p = drawn.parameters()
    b, n = thread(p)
    # Unrolled, a fibre is the diagonal of n circumferences by the length.
    assert float(jnp.hypot(n * 2.0 * jnp.pi * p.R0, p.H0)) == pytest.approx(float(b), rel=4.0 * EPS, abs=0.0)
    assert float(jnp.arcsin(p.H0 / b)) == pytest.approx(float(p.theta0), rel=16.0 * EPS, abs=0.0)


def test_arguments_broadcast() -> None:
    p = reference()
    pressure, other = np.linspace(0.0, 1e5, 3)[:, None], np.linspace(0.5, 1.1, 4)
    b, n = thread(p)
    for force in (
        virtual_work_force(other, pressure, p),
        chou_hannaford_force(other * 0.1, pressure, b, n),
        tondu_lopez_force(other - 0.5, pressure, p.R0, 0.9),
    ):
        assert force.shape == (3, 4)
        np.testing.assert_array_equal(force[0], 0.0)
        np.testing.assert_allclose(force[2], 2.0 * force[1], rtol=4.0 * EPS)
