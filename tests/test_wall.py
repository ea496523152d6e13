"""The chamber's wall, thin and thick, against closed forms; its pressure on the mesh against virtual work."""

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import mckibben as mk
from mckibben.model import wall
from mckibben.model.chamber import energy_density
from mckibben.model.kinematics import stretches
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_density, chamber_pull, contact_pressure, mean_density, touching_pressure

pytestmark = pytest.mark.effects

R0, H0 = 5e-3, 0.1
RUBBER = mk.MooneyRivlin(c1="0.1 MPa", c2="0.03 MPa")
BRAID = mk.Braid(radius=R0, length=H0, angle="60 deg", fibres=40, fibre=mk.Fibre(diameter="0.2 mm", E="3 GPa", nu=0.4))


def made(**chamber: Any) -> Parameters:
    return parameters(mk.Muscle(braid=BRAID, chamber=mk.Chamber(**({"law": RUBBER} | chamber))))


def tube(inner: float, **more: Any) -> Parameters:
    """An 8 mm tube of 90 mm in the 10 mm braid of 100 mm."""
    return made(outer_diameter="8 mm", inner_diameter=inner, length="90 mm", **more)


def faces(p: Parameters, theta: float, Ri: float, Ro: float = 4e-3) -> tuple[float, float, float]:
    """Axial stretch and the radii of the two faces of the 8 mm tube where the braid is a cylinder at an angle."""
    hoop, axial = math.cos(theta) / math.cos(p.theta0), math.sin(theta) / math.sin(p.theta0) * H0 / 90e-3
    outer = R0 * hoop
    return axial, math.sqrt(outer**2 - (Ro**2 - Ri**2) / axial), outer


def thick_tube(axial: float, inner: float, outer: float, Ri: float, Ro: float) -> float:
    """Pressure [Pa] of a thick Mooney-Rivlin tube: the integral of (hoop less radial stress)/radius, in closed form."""
    k = outer**2 * axial - Ro**2
    logarithm = math.log(Ro / Ri) / axial - math.log(outer / inner) / axial
    return 2.0 * (1e5 + 3e4 * axial**2) * (logarithm - k / (2.0 * axial**2) * (outer**-2 - inner**-2))


ANGLES = [math.radians(degrees) for degrees in (40.0, 55.0, 60.0, 62.0)]


@pytest.mark.parametrize("inner", [2e-3, 4e-3, 6e-3, 7.99e-3])
@pytest.mark.parametrize("theta", ANGLES)
def test_thick_tube_under_pressure(theta: float, inner: float) -> None:
    """What the chamber bears is the classical pressure of a thick tube, P(radii, axial stretch)."""
    p = tube(inner, wall="thick")
    axial, bore, outer = faces(p, theta, inner / 2.0)
    found = -float(contact_pressure(Point.cylinder(theta), 0.0, p))
    closed = thick_tube(axial, bore, outer, inner / 2.0, 4e-3)
    assert found == pytest.approx(closed, rel=2e-7 if inner < 4e-3 else 2e-10)


@pytest.mark.parametrize("theta", ANGLES)
def test_pull_of_a_thick_tube(theta: float) -> None:
    """dw/ds = N + P pi (r^2 - bore^2), N the axial stress over the section of a tube under P that is free outside."""
    inner = 4e-3
    p = tube(inner, wall="thick")
    axial, bore, outer = faces(p, theta, inner / 2.0)
    at, weight = np.polynomial.legendre.leggauss(40)
    rho = bore + 0.5 * (outer - bore) * (1.0 + at)
    force = 0.0
    for radius, share in zip(rho, 0.5 * (outer - bore) * weight, strict=True):
        R = math.sqrt(16e-6 + (radius**2 - outer**2) * axial)
        around, through = radius / R, R / (radius * axial)
        borne = thick_tube(axial, radius, outer, R, 4e-3)  # by what is further out: less the radial stress here
        stress = 2e5 * (axial**2 - through**2) - 6e4 * (axial**-2 - through**-2) - borne
        assert around * through * axial == pytest.approx(1.0, rel=1e-14)
        force += 2.0 * math.pi * radius * share * stress
    pressure = thick_tube(axial, bore, outer, inner / 2.0, 4e-3)
    by_mesh = float(chamber_pull(Point.cylinder(theta), p))
    assert by_mesh == pytest.approx(force + pressure * math.pi * (outer**2 - bore**2), rel=2e-9)


def test_a_thin_wall_is_the_limit_of_a_thick_one() -> None:
    """mean = W - tau c1 (1 - 1/(h^4 a^2)) (1/a - h^2) + O(tau^2) for neo-Hookean rubber and tau = t/R."""
    c1, hoop, axial = 1e5, 1.3, 0.9
    slope = -c1 * (1.0 - 1.0 / (hoop**4 * axial**2)) * (1.0 / axial - hoop**2)
    left = []
    for tau in (1e-2, 1e-3, 1e-4):
        given = {"thickness": tau * R0, "lies": "inside", "law": mk.NeoHookean(c1=c1)}
        thin, thick = (float(mean_density(hoop, axial, made(**given, wall=way))) for way in ("thin", "thick"))
        left.append((thick - thin) / tau / slope - 1.0)
    assert (np.abs(left) < np.array([2e-2, 2e-3, 2e-4])).all()
    assert left[0] / left[1] == pytest.approx(10.0, rel=0.02)


@pytest.mark.parametrize(("inner", "error"), [(7e-3, 1e-15), (6e-3, 2e-15), (4e-3, 1e-11), (2e-3, 1e-7)])
def test_points_through_the_wall_suffice(monkeypatch: pytest.MonkeyPatch, inner: float, error: float) -> None:
    laws = (RUBBER, mk.Ogden(mu=["130 kPa", "9 kPa"], alpha=[1.3, 5.0]), mk.Gent(mu="90 kPa", Jm=60.0))
    for p in (tube(inner, wall="thick", law=law) for law in laws):
        few = [float(mean_density(h, a, p)) for h, a in ((1.0, 1.0), (1.2, 0.8), (0.9, 1.1))]
        with monkeypatch.context() as patch:
            patch.setattr(wall, "GAUSS", 40)
            many = [float(mean_density(h, a, p)) for h, a in ((1.0, 1.0), (1.2, 0.8), (0.9, 1.1))]
        assert np.abs(np.array(few) / np.array(many) - 1.0).max() < error


def test_a_thick_wall_outside_rides_on_its_inner_face() -> None:
    """It never collapses, and is closer to the paper's the thinner it is."""
    thin, thick = (made(thickness="0.05 mm", wall=way) for way in (None, "thick"))
    assert float(thick.tube.across) == pytest.approx(1.01**2, rel=1e-14)
    one, other = (float(mean_density(1.2, 0.9, p)) for p in (thin, thick))
    assert other == pytest.approx(one, rel=0.02)
    assert other < one  # the outer part is stretched less


def test_a_closed_bore_is_no_number() -> None:
    p = tube(2e-3, wall="thick")
    closing = math.sqrt(0.9375 / (H0 / 90e-3)) / 1.25  # hoop stretch of the mesh at which the bore closes
    assert math.isfinite(float(mean_density(1.001 * closing, 1.0, p)))
    for function in (mean_density, jax.grad(mean_density), jax.grad(jax.grad(mean_density))):
        assert math.isnan(float(function(0.999 * closing, 1.0, p)))


@pytest.mark.parametrize("theta", ANGLES)
def test_the_papers_chamber_is_computed_as_ever(theta: float) -> None:
    """To the last bit: compiled, as it is used."""
    p = made(thickness="1 mm")
    assert p.tube is None
    assert math.pi * 1e-3 * (1e-3 + 2.0 * R0) == p.A0
    assert parameters(mk.Muscle(braid=BRAID, chamber=mk.Chamber(thickness="1 mm", law=RUBBER, lies="outside"))) == p

    def density(at: Point, p: Parameters) -> Any:
        return p.A0 * energy_density(*stretches(at, p), p.law)

    def pull(at: Point, p: Parameters) -> Any:
        hoop, axial, _ = stretches(at, p)
        return p.A0 * jax.grad(lambda a: energy_density(hoop, a, 1.0 / (hoop * a), p.law))(axial)

    at = Point(jnp.asarray(theta), jnp.asarray(0.2), jnp.asarray(10.0))
    for new, old in ((chamber_density, density), (chamber_pull, pull)):
        assert float(jax.jit(new)(at, p)) == float(jax.jit(old)(at, p))
        slopes = (jax.jit(jax.grad(function))(at, p) for function in (new, old))
        assert float(next(slopes).theta) == float(next(slopes).theta)


def test_wall_inside_has_less_rubber() -> None:
    outside, inside = made(thickness="1 mm"), made(thickness="1 mm", lies="inside")
    assert float(outside.A0) == pytest.approx(math.pi * (6e-3**2 - 5e-3**2), rel=1e-15)
    assert float(inside.A0) == pytest.approx(math.pi * (5e-3**2 - 4e-3**2), rel=1e-15)
    assert float(inside.tube.rubber) == pytest.approx(float(inside.A0) * H0, rel=1e-15)
    one, other = (float(mean_density(1.2, 0.9, p)) for p in (outside, inside))
    assert one == other


def test_a_tube_is_stretched_from_the_start() -> None:
    p = tube(6e-3)
    assert float(p.A0) * H0 == pytest.approx(math.pi * (4e-3**2 - 3e-3**2) * 90e-3, rel=1e-14)
    assert float(p.tube.rubber) == pytest.approx(float(p.A0) * H0, rel=1e-15)
    hoop, axial = 5.0 / 4.0, 100.0 / 90.0
    expected = energy_density(hoop, axial, 1.0 / (hoop * axial), p.law)
    assert float(mean_density(1.0, 1.0, p)) == pytest.approx(float(expected), rel=1e-14)


def test_pressure_on_the_mesh_is_what_virtual_work_says() -> None:
    """The energy of a wavy chamber pushed outwards by eta, against (P - p_contact) 2 pi r s eta, over a period."""
    for p in (tube(6e-3), tube(6e-3, wall="thick")):

        def theta(v: Any) -> Any:
            return 1.0 + 0.05 * jnp.cos(2.0 * jnp.pi * v / H0)

        def psi(v: Any, p: Parameters = p) -> Any:
            return jnp.arcsin(-R0 * jnp.tan(p.theta0) * jax.grad(theta)(v))

        def eta(v: Any) -> Any:
            return jnp.cos(4.0 * jnp.pi * v / H0) - 0.5 * jnp.sin(2.0 * jnp.pi * v / H0)

        def energy(v: Any, push: Any, p: Parameters = p) -> Any:
            def r(v: Any) -> Any:
                return R0 * jnp.cos(theta(v)) / jnp.cos(p.theta0) + push * eta(v) * jnp.cos(psi(v))

            down = jax.grad(lambda v: push * eta(v) * jnp.sin(psi(v)))(v)
            rise = jnp.sin(theta(v)) / jnp.sin(p.theta0) * jnp.cos(psi(v)) - down
            return p.A0 * mean_density(r(v) / R0, jnp.hypot(jax.grad(r)(v), rise), p)

        def borne(v: Any, p: Parameters = p) -> Any:
            at = Point(theta(v), psi(v), jax.grad(psi)(v))
            hoop, axial, _ = stretches(at, p)
            return -contact_pressure(at, 0.0, p) * 2.0 * jnp.pi * R0 * hoop * axial * eta(v)

        v = jnp.linspace(0.0, H0, 64, endpoint=False)
        work = jax.vmap(jax.grad(energy, argnums=1), (0, None))(v, 0.0)
        found = jax.vmap(borne)(v)
        assert float(found.sum()) == pytest.approx(float(work.sum()), rel=1e-11)
        assert abs(float(found.sum())) > 1e-3 * float(jnp.abs(found).sum())


def test_pressure_on_the_mesh_without_a_chamber_is_the_pressure() -> None:
    bare = parameters(mk.Muscle(braid=BRAID))
    assert float(contact_pressure(Point.cylinder(0.9), 2e5, bare)) == 2e5


def test_pressure_that_blows_the_tube_up_to_the_braid() -> None:
    """Thin: dW/dl1 A0/(2 pi R0^2), by hand; thick: the closed form. None where the wall is made on the braid."""
    hoop, axial = 5.0 / 4.0, 100.0 / 90.0
    by_hoop = 2e5 * (hoop - hoop**-3 * axial**-2) + 6e4 * (
        hoop * axial**2 - hoop**-3
    )  # of c1 (I1 - 3) + c2 (I2 - 3), at fixed axial stretch
    p = tube(6e-3)
    thin = by_hoop * hoop * float(p.A0) / (2.0 * math.pi * R0**2)
    assert float(touching_pressure(p)) == pytest.approx(thin, rel=1e-14)
    p = tube(6e-3, wall="thick")
    axial, bore, outer = faces(p, float(p.theta0), 3e-3)
    assert float(touching_pressure(p)) == pytest.approx(thick_tube(axial, bore, outer, 3e-3, 4e-3), rel=1e-12)
    for way in ("thin", "thick"):
        assert abs(float(touching_pressure(made(thickness="1 mm", lies="inside", wall=way)))) < 1e-8
