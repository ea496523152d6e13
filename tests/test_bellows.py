"""Bellows: a chamber that stores energy by its length alone."""

import math
from typing import Any

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk
from mckibben.discretise.fields import place, states
from mckibben.measure.mass import mass_of
from mckibben.model.cylinder import cylinder_force
from mckibben.model.energy import stored
from mckibben.model.kinematics import meridian_stretch, radius
from mckibben.model.parameters import parameters
from mckibben.model.point import Point
from mckibben.model.wall import chamber_density, chamber_pull, chamber_stretches, contact_pressure
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.spec.text import muscle_from_mapping, to_mapping

pytestmark = pytest.mark.effects

K = 5.0
PAPER = mk.presets.paper()
BARE = PAPER.replace("chamber", None)


def folded(k: float = K, **chamber: Any) -> mk.Muscle:
    return PAPER.replace("chamber", mk.Chamber(law=mk.Bellows(axial_stiffness=k), **chamber))


MUSCLE = folded()


@pytest.mark.parametrize("length", [None, 0.07])
def test_a_spring_along_the_cylinder(length: float | None) -> None:
    """They add k times their strain to the force, at every radius and pressure, and nothing to the pressure."""
    p, bare = parameters(folded(length=length)), parameters(BARE)
    for theta in (0.4, p.theta0, 1.0):
        stretch = math.sin(theta) / math.sin(p.theta0) * (1.0 if length is None else 0.085 / length)
        for P in (0.0, 1e5):
            more = cylinder_force(theta, P, p) - cylinder_force(theta, P, bare)
            assert_allclose(more, K * (stretch - 1.0), rtol=1e-11, atol=1e-12)
        at = Point.cylinder(theta)
        assert_allclose(contact_pressure(at, 1e5, p), 1e5, rtol=1e-15)
        as_made = (0.085 if length is None else length) / 0.085
        energy = stored(at, p) - stored(at, bare)
        assert_allclose(energy, as_made * 0.5 * K * (stretch - 1.0) ** 2, rtol=1e-10, atol=1e-15)


def test_where_the_meridian_bends() -> None:
    p, at = parameters(MUSCLE), Point(0.8, 0.3, 20.0)
    pull, s = float(chamber_pull(at, p)), float(meridian_stretch(at, p))
    assert pull == pytest.approx(K * (s - 1.0), rel=1e-13)
    borne = -20.0 * pull / (2.0 * math.pi * float(radius(at, p)) * s)
    assert float(contact_pressure(at, 1e4, p)) == pytest.approx(1e4 - borne, rel=1e-13)
    assert float(chamber_stretches(at, p)[2]) == 1.0


def test_a_law_of_the_users_own() -> None:
    """The same as a wall of the paper's kind whose law knows the axial stretch alone."""
    area = math.pi * 1e-3 * (1e-3 + 25e-3)
    law = mk.CustomLaw(lambda l1, l2, l3, c: 0.5 * c["k"] / area * (l2 - 1.0) ** 2, constants={"k": K})
    one, two = parameters(folded(thickness=1e-3)), parameters(PAPER.replace("chamber.law", law))
    at = Point(0.9, -0.4, 15.0)
    for of in (chamber_density, chamber_pull):
        assert float(of(at, one)) == pytest.approx(float(of(at, two)), rel=1e-13)
    assert float(contact_pressure(at, 1e4, one)) == pytest.approx(float(contact_pressure(at, 1e4, two)), rel=1e-13)


def test_a_tube_at_a_fixed_radius() -> None:
    """Near its length a neo-Hookean tube is 8 c1 A (1 - t^2 + t^4) stiff, t = tan(theta0): the flatter the fibres, the
    more like bellows of 8 c1 A."""
    c1, area = 50e3, math.pi * 1e-3 * (1e-3 + 25e-3)
    for degrees in (20.0, 5.0, 1.0):
        braid = {"braid.angle": math.radians(degrees), "braid.fibre": mk.Fibre(diameter="10 um", E="3 GPa", nu=0.4)}
        tube = PAPER.replace("braid.fibre", braid["braid.fibre"]).replace("braid.angle", braid["braid.angle"])
        stiff = []
        for chamber in (
            mk.Chamber(thickness="1 mm", law=mk.NeoHookean(c1=c1)),
            mk.Chamber(law=mk.Bellows(axial_stiffness=8.0 * c1 * area)),
            None,
        ):
            p = parameters(tube.replace("chamber", chamber))
            by_angle = jax.grad(lambda theta, p=p: cylinder_force(theta, 0.0, p))(p.theta0)
            stiff.append(float(by_angle) * math.tan(math.radians(degrees)))  # dF/ds
        t = math.tan(math.radians(degrees))
        assert (stiff[0] - stiff[2]) / (stiff[1] - stiff[2]) == pytest.approx(1.0 - t**2 + t**4, rel=1e-9)


def state_of(k: float, length: float, pressure: float) -> Equilibrium:
    held, bench = Held.of(length=length, pressure=pressure), Bench.of(folded(k))
    state = find(bench.problem(48, 2.0), held)
    assert state.converged
    return state


def potential(k: float, length: float, pressure: float) -> float:
    """W = U - P V [J]."""
    state = state_of(k, length, pressure)
    return float(state.totals[0] * state.problem.unit[0]) - pressure * state.volume


def test_states_are_the_slopes_of_one_potential() -> None:
    """dW = F dh - V dP, and by k it is what the bellows store for each unit of k."""
    h, P = 0.112, 1e5
    state = state_of(K, h, P)
    along = (potential(K, h + 1e-5, P) - potential(K, h - 1e-5, P)) / 2e-5
    across = (potential(K, h, P + 1e2) - potential(K, h, P - 1e2)) / 2e2
    assert_allclose(along, state.force, rtol=1e-6)
    assert_allclose(-across, state.volume, rtol=1e-6)
    by_stiffness = (potential(K + 1e-3, h, P) - potential(K - 1e-3, h, P)) / 2e-3
    problem = state.problem
    on = place(problem.basis, problem.p, problem.b)
    stretch = meridian_stretch(states(problem.basis, on, state.u), problem.p)
    each = problem.basis.operators().weights * on.jacobian @ (0.5 * (stretch - 1.0) ** 2)
    assert_allclose(by_stiffness, each, rtol=1e-6)


def test_a_wall_that_is_told() -> None:
    """It weighs something and takes its part of the volume, and changes no force."""
    inside = folded(thickness="0.3 mm", lies="inside")
    rubber = math.pi * 0.3e-3 * (25e-3 - 0.3e-3) * 0.085
    assert_allclose(parameters(inside).tube.rubber, rubber, rtol=1e-12)
    assert parameters(MUSCLE).tube is None
    at = Point(0.9, -0.4, 15.0)
    assert float(stored(at, parameters(inside))) == pytest.approx(float(stored(at, parameters(MUSCLE))), rel=1e-14)
    fibres = mass_of(BARE, 1380.0, None)
    assert_allclose(mass_of(inside, 1380.0, 1000.0) - fibres, 1000.0 * rubber, rtol=1e-12)
    assert np.isnan(mass_of(MUSCLE, 1380.0, 1000.0))


def test_in_files() -> None:
    assert muscle_from_mapping(to_mapping(MUSCLE)) == MUSCLE
    table = {"preset": "paper", "chamber": {"law": {"name": "bellows", "axial_stiffness": "5 N"}}}
    assert muscle_from_mapping(table).chamber == folded(thickness=1e-3).chamber


@pytest.mark.parametrize(
    ("chamber", "said"),
    [
        ({"thickness": "1 mm", "wall": "thick"}, r"chamber\.wall = thick: does not go with bellows"),
        ({"thickness": "1 mm", "lies": "inside", "gap": True}, r"chamber\.gap = true: does not go with bellows"),
        ({"thickness": "1 mm", "outer_diameter": "20 mm", "inner_diameter": "18 mm"}, "both thickness and"),
        ({"k": "-1 N"}, r"chamber\.law\.axial_stiffness = -1 N: must be above 0 N"),
        ({"k": "3 mm"}, "axial_stiffness"),
    ],
)
def test_wrong_input(chamber: dict[str, Any], said: str) -> None:
    with pytest.raises(mk.SpecError, match=said):
        folded(**chamber)
