"""The chamber's laws: rest, linear limit, stress in three homogeneous tests, and what they have in common."""

import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

import mckibben as mk
from mckibben import spec
from mckibben.model.chamber import EIGHT_CHAINS, LAWS, energy_density
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_density

pytestmark = pytest.mark.model

STRETCHES = np.linspace(0.6, 2.5, 39)

# How a material is stretched: three principal stretches of one stretch x, with product 1.
LOADS: dict[str, Callable[[jax.Array], tuple[jax.Array, jax.Array, jax.Array]]] = {
    "uniaxial": lambda x: (x, x**-0.5, x**-0.5),
    "equibiaxial": lambda x: (x, x, x**-2),
    "pure shear": lambda x: (x, jnp.ones_like(x), 1.0 / x),
}
DRIVEN = {"uniaxial": 1, "equibiaxial": 2, "pure shear": 1}
"""How many of the stretches are driven: the work of a unit of x is that many times the stress."""

CASES = [
    spec.MooneyRivlin(c1=50e3, c2=12e3),
    spec.MooneyRivlin(c1=50e3, c2=-7e3),
    spec.NeoHookean(c1=80e3),
    spec.Yeoh(c1=60e3, c2=-2e3, c3=300.0),
    spec.Ogden(mu=(130e3, 9e3, -15e3), alpha=(1.3, 5.0, -2.0)),
    spec.Gent(mu=90e3, Jm=12.0),
    spec.ArrudaBoyce(mu=90e3, lambda_m=2.8),
    spec.Rubber(E="0.4 MPa"),
    spec.Rubber(shore="30A"),
]
cases = pytest.mark.parametrize("law", CASES, ids=lambda law: law.name)
loads = pytest.mark.parametrize("load", LOADS)


def made_of(law: spec.Law) -> spec.Muscle:
    braid = spec.Braid(
        radius=12.5e-3, length=85e-3, angle=0.65, fibres=56, fibre=spec.Fibre(diameter=0.25e-3, E=3e9, nu=0.4)
    )
    return spec.Muscle(braid=braid, chamber=spec.Chamber(thickness=1e-3, law=law))


def energy(law: spec.Law, load: str) -> Callable[[jax.Array], jax.Array]:
    """Energy density [Pa] as the muscle's chamber computes it, of the stretch in a test."""
    numbers = parameters(made_of(law)).law
    return lambda x: energy_density(*LOADS[load](x), numbers)


def stress(law: spec.Law, load: str, stretch: np.ndarray = STRETCHES) -> np.ndarray:
    """Nominal stress [Pa] by automatic differentiation of the law."""
    return np.asarray(jax.vmap(jax.grad(energy(law, load)))(stretch)) / DRIVEN[load]


def written_by_hand(law: spec.Law, load: str) -> np.ndarray:
    """Nominal stress [Pa] as textbooks write it, with W1 and W2 the derivatives by I1 and I2; W2 = 0 but for Mooney."""
    x = STRETCHES
    if isinstance(law, spec.Ogden):
        power = {"uniaxial": -0.5, "equibiaxial": -2.0, "pure shear": -1.0}[load]
        return sum(mu * (x ** (a - 1.0) - x ** (power * a - 1.0)) for mu, a in zip(law.mu, law.alpha, strict=True))
    first = {"uniaxial": x**2 + 2.0 / x, "equibiaxial": 2.0 * x**2 + x**-4, "pure shear": x**2 + x**-2 + 1.0}[load] - 3
    match law:
        case spec.MooneyRivlin():
            w1, w2 = law.c1, law.c2
        case spec.NeoHookean() | spec.Rubber():
            w1, w2 = law.c1, 0.0
        case spec.Yeoh():
            w1, w2 = law.c1 + 2.0 * law.c2 * first + 3.0 * law.c3 * first**2, 0.0
        case spec.Gent():
            w1, w2 = law.mu / 2.0 * law.Jm / (law.Jm - first), 0.0
        case spec.ArrudaBoyce():
            L = law.lambda_m
            terms = [1 / 2, 1 / 10 / L**2, 11 / 350 / L**4, 19 / 1750 / L**6, 519 / 134750 / L**8]
            w1, w2 = law.mu * np.polynomial.polynomial.polyval(first + 3.0, terms), 0.0
    match load:
        case "uniaxial":
            return 2.0 * (x - x**-2) * (w1 + w2 / x)
        case "equibiaxial":
            return 2.0 * (x - x**-5) * (w1 + w2 * x**2)
    return 2.0 * (x - x**-3) * (w1 + w2)


def assert_same(found: np.ndarray, expected: np.ndarray, relative: float) -> None:
    """Difference relative to the largest: stresses pass through zero at rest."""
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=relative * float(np.abs(expected).max()))


def test_every_law_is_tested() -> None:
    assert {type(law) for law in CASES} == set(spec.LAWS.values()) - {spec.CustomLaw, spec.Bellows}
    assert set(LAWS) == set(spec.LAWS.values()) - {
        spec.Rubber,
        spec.Bellows,
    }  # the one neo-Hookean by then, the other none of stretches


@cases
@loads
def test_rest(law: spec.Law, load: str) -> None:
    """No energy and no stress, to rounding."""
    assert float(energy(law, load)(jnp.array(1.0))) == 0.0
    assert abs(stress(law, load, np.ones(1))[0]) <= 1e-15 * law.shear_modulus


@cases
@loads
def test_linear_limit(law: spec.Law, load: str) -> None:
    """Near rest the energy is that of an incompressible linear solid of the declared shear modulus: mu tr(e^2)."""
    strains = [float(jax.grad(lambda x, i=i: LOADS[load](x)[i])(1.0)) for i in range(3)]
    curvature = float(jax.grad(jax.grad(energy(law, load)))(1.0))
    assert curvature == pytest.approx(2.0 * law.shear_modulus * sum(e * e for e in strains), rel=1e-15, abs=0.0)


@cases
@loads
def test_stress(law: spec.Law, load: str) -> None:
    assert_same(stress(law, load), written_by_hand(law, load), 2e-15)


@loads
def test_ogden_contains_mooney_rivlin(load: str) -> None:
    one, both = spec.NeoHookean(c1=50e3), spec.MooneyRivlin(c1=50e3, c2=12e3)
    for ogden, other in (
        (spec.Ogden(mu=(100e3,), alpha=(2.0,)), one),
        (spec.Ogden(mu=(100e3, -24e3), alpha=(2.0, -2.0)), both),
    ):
        assert_same(jax.vmap(energy(ogden, load))(STRETCHES), jax.vmap(energy(other, load))(STRETCHES), 5e-16)
        assert_same(stress(ogden, load), stress(other, load), 5e-16)


@loads
def test_yeoh_and_mooney_rivlin_contain_neo_hookean(load: str) -> None:
    for law in (spec.Yeoh(c1=50e3), spec.MooneyRivlin(c1=50e3)):
        assert_same(stress(law, load), stress(spec.NeoHookean(c1=50e3), load), 1e-15)


@loads
def test_gent_tends_to_neo_hookean(load: str) -> None:
    """The difference falls like 1/Jm: the energies differ by mu x^2/(4 Jm), x = I1 - 3, and smaller terms."""
    neo = jax.vmap(energy(spec.NeoHookean(c1=45e3), load))(STRETCHES)
    first = neo / 45e3
    for Jm in (1e4, 1e6):
        gent = jax.vmap(energy(spec.Gent(mu=90e3, Jm=Jm), load))(STRETCHES)
        assert_same(gent - neo, 90e3 * first**2 / (4.0 * Jm), 7.0 / Jm)


@loads
def test_arruda_boyce_tends_to_neo_hookean(load: str) -> None:
    """The energies differ by mu (I1^2 - 9)/(20 lambda_m^2) and smaller terms, E by 9/5 mu/lambda_m^2."""
    neo = jax.vmap(energy(spec.NeoHookean(c1=45e3), load))(STRETCHES)
    first = neo / 45e3 + 3.0
    for limit in (1e2, 1e3):
        law = spec.ArrudaBoyce(mu=90e3, lambda_m=limit)
        chains = jax.vmap(energy(law, load))(STRETCHES)
        assert_same(chains - neo, 90e3 * (first**2 - 9.0) / (20.0 * limit**2), 5.0 / limit**2)
        slope = float(jax.grad(jax.grad(energy(law, "uniaxial")))(1.0))
        assert slope == pytest.approx(3.0 * 90e3 * (1.0 + 0.6 / limit**2), rel=2.0 / limit**4 + 1e-15, abs=0.0)


def test_arruda_boyce_is_the_series_of_eight_chains() -> None:
    """Against chains of freely jointed links, whose force is the inverse Langevin function of their stretch.

    The energy's derivative by I1 is mu b/(6 q) with coth(b) - 1/b = q, the chain stretch over lambda_m. Five terms
    leave an error like q^10, and the one that the docstring states.
    """

    def missing(q: float) -> float:
        b = brentq(lambda b: 1.0 / math.tanh(b) - 1.0 / b - q, 1e-3, 1e3, xtol=1e-13, rtol=1e-15)
        series = sum((k + 1) * factor * (3.0 * q * q) ** k for k, factor in enumerate(EIGHT_CHAINS))
        return 1.0 - series / (b / (6.0 * q))

    assert missing(0.3) == pytest.approx(missing(0.15) * 2.0**10, rel=0.2)
    assert [round(missing(q), 3) for q in (0.6, 0.8, 0.9)] == [0.005, 0.1, 0.342]


@cases
@loads
def test_stress_is_the_slope_of_the_energy(law: spec.Law, load: str) -> None:
    """Automatic differentiation against central differences of sixth order."""
    offsets, weights = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / 60.0
    step, density = 2e-3, jax.vmap(energy(law, load))
    slope = sum(w * np.asarray(density(STRETCHES + k * step)) for k, w in zip(offsets, weights, strict=True)) / step
    assert_same(slope / DRIVEN[load], stress(law, load), 1e-6)


def test_gent_has_no_energy_beyond_its_limit() -> None:
    inside, beyond = energy(spec.Gent(mu=90e3, Jm=3.0), "uniaxial")(jnp.array([2.2, 2.4]))
    assert math.isfinite(inside)
    assert math.isnan(beyond)


def test_a_law_of_the_users_own() -> None:
    """Gent's law written by a user in the invariant, its constants by name: same energy, same stress."""

    def mine(l1: jax.Array, l2: jax.Array, l3: jax.Array, given: dict[str, jax.Array]) -> jax.Array:
        left = given["limit"] + 3.0 - (l1 * l1 + l2 * l2 + l3 * l3)
        return given["modulus"] * given["limit"] / 2.0 * (jnp.log(given["limit"]) - jnp.log(left))

    own = made_of(spec.CustomLaw(function=mine, constants={"modulus": 90e3, "limit": 12.0}))
    built_in = made_of(spec.Gent(mu=90e3, Jm=12.0))
    angles = np.radians(np.linspace(20.0, 60.0, 9))
    found, expected = ([chamber_density(Point.cylinder(t), parameters(m)) for t in angles] for m in (own, built_in))
    assert_same(np.array(found), np.array(expected), 1e-14)
    for load in LOADS:
        assert_same(stress(own.chamber.law, load), stress(built_in.chamber.law, load), 2e-15)


@pytest.mark.parametrize(("body", "said"), [(lambda l1: 1.0 if l1 > 1.0 else 0.0, "TracerBool"), (None, "TypeError")])
def test_a_function_that_fails_is_one_message(body: Any, said: str) -> None:
    law = spec.CustomLaw(function=lambda l1, l2, l3, constants: body(l1))
    muscle = mk.presets.paper().replace("chamber.law", law)
    with pytest.raises(spec.SpecError, match=f"chamber.law.function: fails with {said}.* write it with jax.numpy"):
        mk.solve(muscle, length="115 mm", pressure="1 bar")


def test_density_is_that_of_the_wall() -> None:
    """Energy per unit v: the law at hoop, axial and thickness stretch times the wall's area pi t0 (t0 + 2 R0)."""
    law, theta = spec.MooneyRivlin(c1=50e3, c2=12e3), 0.8
    muscle = made_of(law)
    hoop, axial = math.cos(theta) / math.cos(0.65), math.sin(theta) / math.sin(0.65)
    one = hoop**2 + axial**2 + (hoop * axial) ** -2 - 3.0
    two = hoop**-2 + axial**-2 + (hoop * axial) ** 2 - 3.0
    found = float(chamber_density(Point.cylinder(theta), parameters(muscle)))
    assert found == pytest.approx(
        math.pi * ((13.5e-3) ** 2 - (12.5e-3) ** 2) * (50e3 * one + 12e3 * two), rel=1e-14, abs=0.0
    )


def test_a_bare_braid_has_no_chamber_energy() -> None:
    bare = spec.Muscle(braid=made_of(CASES[0]).braid)
    p = parameters(bare)
    assert float(energy_density(1.2, 1.1, 1.0 / (1.2 * 1.1), p.law)) == 0.0
    assert float(p.A0) == 0.0
    assert float(chamber_density(Point.cylinder(0.8), p)) == 0.0
