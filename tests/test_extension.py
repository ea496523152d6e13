"""Full extension against independently computed values, the extremal's integrals, and a direct maximisation."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from muscles import between
from numpy.polynomial.legendre import leggauss
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.special import elliprd, elliprf

from mckibben import spec
from mckibben.model import elliptic
from mckibben.model.extension import full_extension

pytestmark = pytest.mark.effects

angles = between(math.radians(5.0), math.radians(85.0))

# Radius, length [mm], angle [rad], full extension [mm], from the independent solver behind the theory page's numbers.
STORED = [
    (12.5, 85.0, math.radians(37.0), 128.7786195322568),
    (10.718292961680342, 175.83923006823912, 0.9676559429058024, 206.8437310316671),
    (9.452140563740635, 67.85700057454984, 0.9383004330395456, 78.01603634654705),
    (5.265979740393099, 30.22097101992259, 0.6305872018546488, 45.90898767626477),
    (12.752382858386893, 69.44722875075952, 0.4420133792876506, 146.204632669813),
    (18.067622100891093, 310.64681939862623, 0.8964455846410756, 385.0303088373869),
    (12.328567547465966, 61.5360740350262, 0.47638753182915666, 119.17052541649073),
    (8.692876962507276, 135.22709833807454, 0.3988198562841358, 336.6863178125074),
    (3.8865822771409673, 71.1948578329557, 0.5738067837275502, 126.92292002986719),
    (7.611882820442326, 55.20132860224865, 0.8584285528250432, 67.29925481558645),
    (8.327153338334854, 62.973029584366024, 0.410683896894435, 146.82095398492615),
    (9.638298902876521, 85.72298253712012, 0.5177251025327326, 162.00615068895604),
    (5.211708306929966, 61.196134734557425, 0.9797417808384905, 70.52818533476317),
    (4.617605474522359, 75.19749713744243, 0.9797132052004652, 87.75093708259458),
    (10.679796597559136, 200.8772884000945, 0.8012259601016283, 271.0416644481713),
    (23.18311357283526, 185.18598680899112, 0.6034011328345917, 301.99329487450956),
    (3.6171154491684554, 23.299102275739294, 1.2208345925469457, 23.7489071363591),
    (12.143184650244507, 58.395829901591334, 0.9740124581467254, 63.71170478694466),
    (6.361989712448659, 13.893152847350779, 0.7162365065052826, 16.319061111506098),
    (13.45857315569315, 50.03607548557481, 0.4333534279547014, 101.96829546448825),
    (8.80710066618343, 110.38229588411895, 0.9242632251874785, 132.3929198839188),
    (11.361611671073732, 139.00367966363504, 0.3525146064576703, 386.75446895887853),
    (5.258554858533554, 63.26143794707849, 0.7120023483003098, 92.01043444833165),
    (4.453482873931948, 66.0997439535149, 0.8609329105660926, 83.84984202492845),
]


@pytest.mark.parametrize("ends", ["clamped", "pinned"])
@pytest.mark.parametrize(("radius", "length", "angle", "expected"), STORED)
def test_independent_values(radius: float, length: float, angle: float, expected: float, ends: str) -> None:
    assert full_extension(radius * 1e-3, length * 1e-3, angle, ends) * 1e3 == pytest.approx(
        expected, rel=1e-12, abs=0.0
    )


@given(theta0=angles, T=between(0.01, 20.0))
def test_integrals_of_the_extremal(theta0: float, T: float) -> None:
    """The theory page's two integrals, by quadrature, with T and the angle chosen and the muscle found from them."""
    c, xm = math.cos(theta0), math.cos(theta0) / math.cosh(T)

    def integral(power: float) -> float:
        # t = T (1 - y^3) spreads the points towards T, where the integrand peaks when theta0 is small.
        value, _ = quad(
            lambda y: (1.0 - (xm * math.cosh(T * (1.0 - y**3))) ** 2) ** power * 3.0 * y * y * T,
            0.0, 1.0, epsabs=0.0, epsrel=1e-13, limit=200,
        )  # fmt: skip
        return float(value)

    length = 2.0 * math.sqrt(1.0 - xm**2) * integral(-0.5) * math.sin(theta0) / c
    assert full_extension(1.0, length, theta0, "clamped") == pytest.approx(2.0 * integral(0.5) / c, rel=2e-14, abs=0.0)


@pytest.mark.parametrize(("theta0", "ratio"), [(20.0, 0.5), (20.0, 2.0), (37.0, 6.8), (60.0, 10.0), (80.0, 20.0)])
def test_no_braid_is_longer(theta0: float, ratio: float) -> None:
    """The longest of all braids, found by maximising the length itself over polynomials cos(theta(v))."""
    angle = math.radians(theta0)
    c, s = math.cos(angle), math.sin(angle)
    points, weights = leggauss(60)
    modes = np.arange(16)[:, None]
    basis = (1.0 - points**2) * np.cos(2 * modes * np.arccos(points))  # even, zero at both ends
    slopes = -2.0 * points * np.cos(2 * modes * np.arccos(points)) + np.sqrt(1.0 - points**2) * 2 * modes * np.sin(
        2 * modes * np.arccos(points)
    )

    def shortness(a: jax.Array) -> jax.Array:
        x, x_v = c - a @ basis, -(a @ slopes) * 2.0 / ratio
        # z' = sqrt(s^2 - r'^2), with meridian stretch s and r = cos(theta)/cos(theta0)
        return -jnp.sum(weights * jnp.sqrt((1.0 - x**2) / s**2 - (x_v / c) ** 2)) * ratio / 2.0

    value, slope = jax.jit(shortness), jax.jit(jax.grad(shortness))
    best = minimize(value, np.zeros(16), jac=slope, hess=jax.jit(jax.hessian(shortness)), method="trust-exact")
    assert full_extension(1.0, ratio, angle, "pinned") == pytest.approx(-best.fun, rel=3e-12, abs=0.0)


@given(theta0=angles, ratio=between(0.5, 200.0))
def test_bounds(theta0: float, ratio: float) -> None:
    """Longer than at rest and shorter than a fibre; the missing part grows with the length, to 2 (1 - sin) R0/cos."""
    fibre = ratio / math.sin(theta0)
    rounding = 2e-15 * fibre
    missing = fibre - full_extension(1.0, ratio, theta0, "clamped")
    limit = 2.0 * (1.0 - math.sin(theta0)) / math.cos(theta0)
    assert missing < fibre - ratio
    assert 0.0 < missing <= limit + rounding
    longer = 1.01 * ratio
    assert longer / math.sin(theta0) - full_extension(1.0, longer, theta0, "clamped") >= missing - rounding


@pytest.mark.parametrize("theta0", [5.0, 37.0, 85.0])
def test_the_long_muscle_joins_smoothly(theta0: float) -> None:
    """Across the switch to the limit, half a fibre of about 25.7 R0/cos(theta0), nothing jumps."""
    angle = math.radians(theta0)
    ratios = 2.0 * np.linspace(25.69, 25.70, 5) * math.tan(angle)
    found = [full_extension(1.0, float(ratio), angle, "pinned") for ratio in ratios]
    np.testing.assert_allclose(np.diff(found), np.diff(ratios) / math.sin(angle), rtol=1e-11)


def test_free_ends_reach_the_length_of_a_fibre() -> None:
    fibre = full_extension(12.5e-3, 85e-3, math.radians(37.0), "free")
    assert fibre == pytest.approx(141.23941199541e-3, rel=1e-13, abs=0.0)
    assert fibre == full_extension(99.0, 85e-3, math.radians(37.0), spec.Ends.FREE)


def test_unknown_ends_are_refused() -> None:
    with pytest.raises(ValueError, match="welded"):
        full_extension(12.5e-3, 85e-3, 0.6, "welded")


def test_elliptic_integrals_are_those_of_scipy() -> None:
    rng = np.random.default_rng(4)
    for x, y, z in 10.0 ** rng.uniform(-20.0, 3.0, (300, 3)):
        assert elliptic.elliprf(x, y, z) == pytest.approx(elliprf(x, y, z), rel=3e-15)
        assert elliptic.elliprd(x, y, z) == pytest.approx(elliprd(x, y, z), rel=3e-15)
    assert elliptic.elliprf(0.0, 1.0, 1.0) == pytest.approx(math.pi / 2, rel=1e-15)
    assert elliptic.elliprd(4.0, 4.0, 4.0) == pytest.approx(1 / 8, rel=1e-15)
