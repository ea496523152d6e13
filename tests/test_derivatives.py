"""What the assembler gives (totals, gradients, tangents) against another quadrature and central differences."""

from typing import Any

import attrs
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from readings import profile
from scipy.interpolate import CubicSpline

import mckibben as mk
from mckibben.discretise.bspline import Spline
from mckibben.discretise.fields import place, variables
from mckibben.discretise.spectral import Line
from mckibben.model.energy import lagrangian, stored, works
from mckibben.model.parameters import Parameters
from mckibben.model.point import Point
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.held import Held
from mckibben.solver.problem import CLOSURE, Problem
from mckibben.solver.stability import null_space, of_states
from mckibben.solver.system import Unknowns, assemble, localise

pytestmark = pytest.mark.solver

REFERENCE = mk.presets.reference()
GENT = REFERENCE.replace("chamber.law", mk.Gent(mu="0.1 MPa", Jm=8.0))
FIBRE = attrs.evolve(REFERENCE.braid.fibre, stretch=True, axial_stiffness="150 N")
STRETCHING = REFERENCE.replace("braid.fibre", FIBRE)
ALL = STRETCHING.replace("braid.joint", "pin").replace("fittings", mk.Fittings(compliance="0.01 mm/N"))
CASES = {
    "clamped": (REFERENCE, Line(24, "clamped")),
    "pinned": (REFERENCE, Line(24, "pinned")),
    "free": (REFERENCE, Line(24, "free")),
    "full length": (REFERENCE, Line(48, "clamped", "all")),
    "spline": (REFERENCE, Spline(23, "clamped")),
    "clamped, gent": (GENT, Line(24, "clamped")),
    "spline, gent": (GENT, Spline(23, "clamped")),
    "all effects, full length": (ALL, Line(24, "clamped", "all", stretch=True, roll=True, give=True)),
}
EVERY = pytest.mark.parametrize("case", CASES)
PAPERS = pytest.mark.parametrize("case", [name for name, (muscle, _) in CASES.items() if muscle in (REFERENCE, GENT)])
CROWDING, STEP = 2.0, 2e-3
# Central differences, exact for polynomials of degree 6.
OFFSETS, WEIGHTS = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / 60.0


def problem_of(muscle: mk.Muscle, basis: Line | Spline) -> Problem:
    bench = Bench.of(muscle)
    return Problem.of(basis, bench.p, CROWDING)


def change(problem: Problem, du: np.ndarray) -> float:
    """Largest change of the slope and of the braid angle [rad] about the cylinder."""
    theta, psi, _ = profile(problem, du, 101)
    return max(float(np.abs(psi).max()), float(np.abs(theta - problem.p.theta0).max()))


def wave(problem: Problem, seed: int, power: int = 1) -> np.ndarray:
    """Random unknowns, short waves less, that change slope or angle by 0.4 rad: far from straight and flat."""
    random = np.random.default_rng(seed)
    m = problem.basis.unknowns
    u = 1e-4 * random.normal(size=m) / (1.0 + np.arange(m)) ** power
    for _ in range(8):  # slopes of splines are not quite linear in the unknowns
        u = u * 0.4 / change(problem, u)
    return u


@EVERY
def test_gradients_and_tangents(case: str) -> None:
    problem = problem_of(*CASES[case])
    for seed in range(3):
        u, du = wave(problem, seed), wave(problem, 10 + seed)
        gradients = np.asarray(problem.balance(u).gradients)
        tangents = np.stack([problem.curvature(u, share) for share in np.eye(4)])
        np.testing.assert_allclose(tangents, np.swapaxes(tangents, 1, 2), rtol=0.0, atol=2e-15 * np.abs(tangents).max())
        near = [problem.balance(u + k * STEP * du) for k in OFFSETS]
        slope = sum(w * np.asarray(a.totals) for w, a in zip(WEIGHTS, near, strict=True)) / STEP
        bend = sum(w * np.asarray(a.gradients) for w, a in zip(WEIGHTS, near, strict=True)) / STEP
        first, second = (np.abs(array) @ np.abs(du) for array in (gradients, tangents))
        np.testing.assert_allclose(slope, gradients @ du, rtol=0.0, atol=1e-11 * first.max())
        np.testing.assert_allclose(bend, tangents @ du, rtol=0.0, atol=2e-11 * second.max())


@EVERY
def test_a_search_sees_what_others_see(case: str) -> None:
    """Differentiated as they stand, or by the assembler of all other equations."""
    problem = problem_of(*CASES[case])
    basis, u = problem.basis, wave(problem, 0)
    look = problem.balance(u)

    @jax.jit
    def assembled(p: Parameters, u: Any) -> tuple[Any, Any]:
        on = place(basis, p, problem.b)
        local = localise(basis, on, Unknowns(u, jnp.zeros(3)))
        s = assemble(basis, on, local, 3)
        return jnp.append(local.value.sum(), s.values), jnp.stack([s.rest, *s.gradients])

    for found, expected in zip((look.totals, look.gradients), assembled(problem.p, u), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-14 * np.abs(expected).max())


@PAPERS
def test_totals(case: str) -> None:
    """Energy, length, volume and closure again, from the profile at many output points."""
    muscle, basis = CASES[case]
    problem = problem_of(muscle, basis)
    p, half = problem.p, basis.half
    density = jax.vmap(lambda *x: jnp.stack([stored(Point(*x), p), *works(Point(*x), p)]))
    for seed in range(3):
        u = wave(problem, seed, power=3)
        x = basis.sampling(1001).x
        v = np.asarray(basis.coordinate(x, p, problem.b))
        densities = density(*profile(problem, u, 1001))
        expected = CubicSpline(v, np.asarray(densities)).integrate(0.0, v[-1]) * (2.0 if half else 1.0) / problem.unit
        found = np.asarray(problem.balance(u).totals)
        # the half line's own closure means nothing: odd slopes close by themselves
        n = CLOSURE if isinstance(basis, Line) and basis.half else CLOSURE + 1
        # three Gauss points per element see a wave of 20 elements to 1e-5
        np.testing.assert_allclose(found[:n], expected[:n], rtol=0.0, atol=1e-10 if isinstance(basis, Line) else 2e-5)


@pytest.mark.parametrize(("muscle", "ends"), [(REFERENCE, "clamped"), (REFERENCE, "free"), (STRETCHING, "clamped")])
def test_antisymmetric_tangent_is_the_even_block_of_the_full_line(muscle: mk.Muscle, ends: str) -> None:
    """At a symmetric state, among disturbances that keep the end radii equal (or turn both free ends by as much)."""
    muscle = muscle.replace("ends", ends)
    line = Line.of(muscle, 24)
    half, full = problem_of(muscle, line), problem_of(muscle, attrs.evolve(line, size=48, modes="all"))
    held = Held.of(length=0.100, pressure=1e5)
    one, two = find(half, held), find(full, held)
    small = of_states(half, one.u[None], one.loads[None])
    big = full.balance(two.u)
    places = np.arange(full.basis.unknowns)
    parts = [places[part] for part in full.basis.series.values()]
    last = places[parts[-1][-1] + 1 :]  # what the ends do
    odd, even = (np.concatenate([*(part[first::2] for part in parts), last]) for first in (1, 0))
    stretching = muscle.braid.fibre.EA is not None
    if ends == "clamped" and not stretching:
        np.testing.assert_allclose(big.gradients[CLOSURE, even], 2.0 * small.closure[0, 0], atol=1e-13)
    np.testing.assert_allclose(two.u[odd], one.u, atol=1e-12)
    signs = np.concatenate([[1.0], -two.loads, np.zeros(3 - len(two.loads))])
    keep, K = null_space(np.asarray(small.closure[0])), full.curvature(two.u, signs)
    if ends == "clamped":  # disturbances that leave the radius and the angle of mid-length as they are
        np.testing.assert_allclose(big.gradients[CLOSURE, even] @ keep, 0.0, atol=1e-11)
    close = 5e-9 if stretching else 5e-11  # the shortest waves of fibres that stretch see the two quadratures
    antisymmetric = keep.T @ np.asarray(small.antisymmetric[0]) @ keep
    found = keep.T @ K[np.ix_(even, even)] @ keep
    np.testing.assert_allclose(found, antisymmetric, rtol=0.0, atol=close * np.abs(antisymmetric).max())
    symmetric = np.asarray(small.stiffness[0])
    np.testing.assert_allclose(K[np.ix_(odd, odd)], symmetric, rtol=0.0, atol=close * np.abs(symmetric).max())
    assert np.abs(keep.T @ K[np.ix_(even, odd)]).max() < (1e-13 if stretching else 1e-14) * np.abs(K).max()


def test_closing_moment_is_the_costate_at_the_fitting() -> None:
    """Zero at mid-length, the costate of a symmetric state grows to what holds the radii of the full line equal."""
    half, full = problem_of(REFERENCE, Line(24)), problem_of(REFERENCE, Line(48, modes="all"))
    held = Held.of(length=0.100, pressure=1e5)
    state = find(half, held)
    on = place(half.basis, half.p, half.b)
    theta, psi, kappa = (getattr(part, "value", part) for part in variables(half.basis, on, state.u))

    def density(theta: jax.Array, psi: jax.Array, kappa: jax.Array) -> jax.Array:
        return lagrangian(Point(theta, psi, kappa), half.p, state.force, state.pressure)

    slope = jax.vmap(jax.grad(density))(theta, psi, kappa)
    costate = 0.5 * float(slope @ (half.basis.operators().weights * on.jacobian))
    assert costate / float(half.unit[0]) == pytest.approx(find(full, held).loads[2], rel=1e-12)
