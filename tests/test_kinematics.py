"""Surface and fibre strains against the shape itself: the director frame in space, differentiated numerically.

Only Eqs. (1), (7) and (13) are used to build the shape. The fields are admissible and otherwise arbitrary.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from muscles import Drawn, between, muscles, reference
from numpy.polynomial.chebyshev import Chebyshev

from mckibben.model.kinematics import (
    angle_rate,
    fibre_strains,
    height_rate,
    meridian_stretch,
    natural_strains,
    radius,
    stretches,
    volume_rate,
)
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.point import Point
from mckibben.spec import presets

pytestmark = pytest.mark.model

Curve = Callable[[np.ndarray], np.ndarray]
"""A scalar or vector function of an array of points; components come last."""

# A central difference that is exact for polynomials of degree 12.
OFFSETS = np.array([j for j in range(-6, 7) if j])
WEIGHTS = np.array([
    (-1) ** (j + 1) * math.factorial(6) ** 2 / (j * math.factorial(6 - j) * math.factorial(6 + j))
    for j in OFFSETS.tolist()
])  # fmt: skip


def derivative(f: Curve, at: np.ndarray, step: float) -> np.ndarray:
    return np.tensordot(WEIGHTS, f(at + step * OFFSETS.reshape(-1, *[1] * at.ndim)), 1) / step


class Shape(NamedTuple):
    """A muscle in some admissible state, as fields of v."""

    psi: Curve
    kappa: Curve
    theta: Chebyshev
    z: Chebyshev


def shape(p: Parameters, amplitudes: Sequence[float]) -> Shape:
    """The state of slope psi = sum a_k sin(2 pi k v/H0), which closes because psi is odd about the middle."""
    R0, H0, theta0 = float(p.R0), float(p.H0), float(p.theta0)
    waves = 2.0 * np.pi * np.arange(1, len(amplitudes) + 1) / H0
    a = np.array(amplitudes)

    def psi(v: np.ndarray) -> np.ndarray:
        return np.sin(v[..., None] * waves) @ a

    def kappa(v: np.ndarray) -> np.ndarray:
        return np.cos(v[..., None] * waves) @ (a * waves)

    domain = [-0.2 * H0, 1.2 * H0]  # wider than the muscle, for the differences at its ends
    slope = Chebyshev.interpolate(lambda v: -np.sin(psi(v)) / (R0 * math.tan(theta0)), 300, domain)
    theta = theta0 + slope.integ(lbnd=0.0)
    rise = Chebyshev.interpolate(lambda v: np.sin(theta(v)) / math.sin(theta0) * np.cos(psi(v)), 300, domain)
    return Shape(psi, kappa, theta, rise.integ(lbnd=0.0))


def surface(p: Parameters, state: Shape) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Position of (u, v) in space, Eq. (1), with the radius that Eq. (11) demands."""

    def position(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        r = float(p.R0) * np.cos(state.theta(v)) / math.cos(p.theta0)
        turn = u / float(p.R0)
        return np.stack([r * np.cos(turn), r * np.sin(turn), state.z(v)], axis=-1)

    return position


def scale(p: Parameters) -> float:
    """Length [m] over which the shapes of this file change."""
    return min(float(p.R0), float(p.H0) / 6.0)


class Measured(NamedTuple):
    """What a fibre shows in space."""

    rate: np.ndarray  # |d position/dt|: 1 if the fibre keeps its length
    angle: np.ndarray  # from the parallel to the tangent
    strains: np.ndarray  # u1, u2, u3 by the definitions in Eqs. (14)-(16)


def measured(p: Parameters, state: Shape, v: np.ndarray, step: float) -> Measured:
    position, across = surface(p, state), step * scale(p)
    c, s = math.cos(p.theta0), math.sin(p.theta0)

    def tangent(t: np.ndarray) -> np.ndarray:  # to the curve of Eq. (7)
        return derivative(lambda t: position(t * c, t * s), t, across)

    def parallel(t: np.ndarray) -> np.ndarray:
        return derivative(lambda u: position(u, t * s + 0.0 * u), t * c, across)

    def meridian(t: np.ndarray) -> np.ndarray:
        return derivative(lambda v: position(t * c + 0.0 * v, v), t * s, across)

    def directors(t: np.ndarray) -> np.ndarray:  # Eq. (13), as [..., director, component]
        d1, d3 = np.cross(parallel(t), meridian(t)), tangent(t)
        d1 /= np.linalg.norm(d1, axis=-1, keepdims=True)
        return np.stack([d1, np.cross(d3, d1), d3], axis=-2)

    t = v / s
    b, along = tangent(t), parallel(t)
    d, rates = directors(t), derivative(directors, t, across)
    strains = np.sum(rates[:, [1, 2, 0]] * d[:, [2, 0, 1]], axis=-1)  # d2'.d3, d3'.d1, d1'.d2
    angle = np.arctan2(np.linalg.norm(np.cross(along, b), axis=-1), np.sum(along * b, axis=-1))
    return Measured(np.linalg.norm(b, axis=-1), angle, strains)


def points(p: Parameters) -> np.ndarray:
    return np.linspace(0.0, float(p.H0), 23)


def check_fibre(p: Parameters, state: Shape, step: float, tolerance: float) -> None:
    v = points(p)
    theta, psi, kappa = state.theta(v), state.psi(v), state.kappa(v)
    seen = measured(p, state, v, step)
    # These take one difference, the strains two.
    np.testing.assert_allclose(seen.rate, 1.0, rtol=0.0, atol=tolerance / 50.0)
    np.testing.assert_allclose(seen.angle, theta, rtol=0.0, atol=tolerance / 50.0)
    modelled = np.stack(fibre_strains(Point(theta, psi, kappa), p), axis=-1)
    np.testing.assert_allclose(seen.strains * float(p.R0), modelled * float(p.R0), rtol=0.0, atol=tolerance)


def check_surface(p: Parameters, state: Shape, step: float, tolerance: float) -> None:
    v, R0 = points(p), float(p.R0)
    theta, psi = state.theta(v), state.psi(v)
    at = Point(theta, psi, state.kappa(v))
    meridian = derivative(lambda v: surface(p, state)(0.0 * v, v), v, step * scale(p))
    r, dr, dz = surface(p, state)(0.0 * v, v)[:, 0], meridian[:, 0], meridian[:, 2]
    hoop, axial, thickness = stretches(at, p)
    for seen, modelled in (
        (r / R0, radius(at, p) / R0),
        (np.hypot(dr, dz), meridian_stretch(at, p)),
        (np.arctan2(dr, dz), psi),
        (dz, height_rate(at, p)),
        (r**2 * dz / R0**2, volume_rate(at, p) / (np.pi * p.R0**2)),
        (derivative(state.theta, v, step * scale(p)) * R0, angle_rate(at, p) * p.R0),
        (r / R0, hoop),
        (np.hypot(dr, dz), axial),
        (1.0, hoop * axial * thickness),
    ):
        np.testing.assert_allclose(seen, modelled, rtol=0.0, atol=tolerance)


@given(drawn=muscles(), shares=st.tuples(*3 * [between(-1.0, 1.0)]))
def test_any_muscle_in_any_gentle_shape(drawn: Drawn, shares: tuple[float, float, float]) -> None:
    """Any muscle, in shapes that keep theta between 0 and 90 deg: wave k turns it by less than a_k H0/(pi k R0 tan)."""
    p = drawn.parameters()
    theta0, R0, H0 = drawn.theta0, drawn.R0, drawn.H0
    room = 0.7 * min(theta0, math.pi / 2.0 - theta0)
    most = [min(0.4, room / 3.0 * math.pi * k * R0 * math.tan(theta0) / H0) for k in (1, 2, 3)]
    state = shape(p, [share * limit for share, limit in zip(shares, most, strict=True)])
    check_fibre(p, state, step=0.03, tolerance=1e-10)
    check_surface(p, state, step=0.03, tolerance=1e-11)


def test_a_shape_that_overhangs() -> None:
    """Slopes beyond 90 deg, where the paper's square root has no value."""
    p = reference()
    state = shape(p, [0.0, 0.0, 0.0, -1.7])
    assert np.abs(state.psi(points(p))).max() > np.radians(95.0)
    check_fibre(p, state, step=0.015, tolerance=1e-9)
    check_surface(p, state, step=0.015, tolerance=1e-10)


def test_the_misprinted_equation_fails() -> None:
    """Eq. (15) as printed, with tan(theta0) in its first term, misses the curvature of the very same shape."""
    p = reference()
    state, v = shape(p, [-0.1, 0.04]), points(p)
    theta, psi, kappa = state.theta(v), state.psi(v), state.kappa(v)
    seen = measured(p, state, v, step=0.03).strains[:, 1]
    z_v, theta_vv = height_rate(Point(theta, psi, kappa), p), -np.cos(psi) * kappa / (p.R0 * np.tan(p.theta0))
    second = -p.R0 * np.tan(p.theta0) * np.sin(theta) ** 2 * theta_vv / z_v
    factor = -np.cos(p.theta0) * np.sin(p.theta0) * z_v / p.R0
    error = {name: np.abs(factor / np.tan(t) + second - seen).max() * float(p.R0)
             for name, t in (("printed", p.theta0), ("corrected", theta))}  # fmt: skip
    assert error["corrected"] < 1e-11
    assert error["printed"] > 0.1


@given(drawn=muscles())
def test_at_rest_the_fibres_are_natural_helices(drawn: Drawn) -> None:
    p = drawn.parameters()
    found = np.array(fibre_strains(Point(p.theta0, 0.0, 0.0), p)) * drawn.R0
    natural = np.array(natural_strains(Point(p.theta0, 0.0, 0.0), p)) * drawn.R0
    np.testing.assert_allclose(found, natural, rtol=0.0, atol=3e-16)
    c, s = math.cos(drawn.theta0), math.sin(drawn.theta0)
    np.testing.assert_allclose(natural, [0.0, -c * c, c * s], rtol=0.0, atol=3e-16)  # Eq. (18)


def test_straight_fibres_have_no_natural_strain() -> None:
    muscle = presets.reference().replace("braid.fibre.natural", "straight")
    np.testing.assert_array_equal(natural_strains(Point.cylinder(0.6), parameters(muscle)), 0.0)
