"""Newton's step on the equations and what is held, against the bordered system; rows of one's own; known angles."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from muscles import reference

import mckibben as mk
from mckibben.discretise.bspline import Spline
from mckibben.discretise.fields import place
from mckibben.discretise.spectral import Line
from mckibben.model.angle import Known, cos, sin, slope, tan
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.follow import follow
from mckibben.solver.held import Conditions, Held, conditions, rows_of
from mckibben.solver.implicit import settle
from mckibben.solver.newton import MOST, WORK, batch_size, bordered, correct
from mckibben.solver.path import trace
from mckibben.solver.system import System, Unknowns, system

pytestmark = pytest.mark.solver

HOLDINGS = {
    "length": ("length", "pressure"), "force": ("force", "pressure"), "volume": ("length", "volume"),
    "both": ("length", "force"), "gas": ("length", "isothermal"), "gas and weight": ("force", "adiabatic"),
}  # fmt: skip
BASES = (Line(8), Line(8, "pinned"), Line(8, "free"), Line(8, modes="all"), Spline(13))


@pytest.mark.parametrize("held", HOLDINGS)
@pytest.mark.parametrize("basis", BASES, ids=repr)
def test_newton_step_and_tangents_are_those_of_the_bordered_system(basis: Any, held: str) -> None:
    p = jax.tree.map(jnp.asarray, reference())
    count = 3 if basis.closes else 2
    own, which = rows_of(HOLDINGS[held], count)
    random = np.random.default_rng(3)
    u = jnp.asarray(random.standard_normal(basis.unknowns) * (0.002 if isinstance(basis, Spline) else 0.02))
    state = Unknowns(u, jnp.asarray([0.02, 0.4, 0.01][:count]))
    targets = jnp.asarray([1.1 if held == "length" else 0.3, -2.0 if "gas" in held else 0.5, 0.0][:count])

    @jax.jit
    def both(state: Unknowns) -> tuple[Any, jax.Array, System, System]:
        on = place(basis, p, 1.3)
        s, together = system(basis, on, state), system(basis, on, state, together=True)
        c = conditions(own, which, targets, on, s, state.loads)
        sides = jnp.concatenate([
            -jnp.concatenate([s.rest, c.miss])[:, None],
            -jnp.concatenate([jnp.zeros((len(u), count)), jnp.diag(c.by_target)]),
        ], axis=1)  # fmt: skip
        return correct(s, c), jnp.linalg.solve(bordered(s, c), sides), s, together

    found, expected, s, together = both(state)
    size = np.abs(expected).max()
    np.testing.assert_allclose(jnp.concatenate(found.step[:2]), expected[:, 0], rtol=0.0, atol=1e-11 * size)
    np.testing.assert_allclose(jnp.concatenate(found.tangents[:2]), expected[:, 1:], rtol=0.0, atol=1e-11 * size)
    for one, other in zip(s[:4], together[:4], strict=True):  # arranged for many at once
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-13 * np.abs(one).max())


def test_stability_is_that_of_the_stiffness_on_what_is_left_free() -> None:
    """Stiffness -1 along the length: held it does no harm, nor where a spring stiffer than 1 is in series."""
    K, gradients = jnp.diag(jnp.asarray([-1.0, 2.0, 3.0])), jnp.asarray([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    s, pressure = System(K, jnp.zeros(3), gradients, jnp.zeros(2)), [0.0, 1.0]
    for compliance, stable in ((0.0, True), (0.9, True), (1.1, False), (None, False)):
        total, load = (0.0, 1.0) if compliance is None else (1.0, compliance)
        c = Conditions(
            jnp.zeros(2), jnp.asarray([[total, 0.0], [0.0, 0.0]]), jnp.asarray([[load, 0.0], pressure]), -jnp.ones(2)
        )
        assert bool(correct(s, c).stable) == stable


def test_a_row_of_ones_own_spring_in_series() -> None:
    """h + C F = t: found, followed and differentiated like a length; the force then answers the spring."""
    muscle, compliance = mk.presets.reference(), 2e-4

    def spring(now: Any, t: Any) -> Any:
        return now.length + compliance * now.force - t

    bench = Bench.of(muscle)
    names = (spring, "pressure")
    problem = bench.problem(24, 2.0)
    path = [Held(names, (0.105, P)) for P in (2e4, 6e4, 1e5)]
    found = trace(problem, path, tolerance=1e-6)
    assert found.reached == 3
    last = found.state(2)
    assert last.length + compliance * last.force == pytest.approx(0.105, rel=1e-12)
    alone = mk.solve(muscle, length=last.length, pressure="1 bar")
    assert alone.force == pytest.approx(last.force, rel=1e-9)
    own, which = rows_of(names, 2)
    unit = problem.unit

    def force(t: Any) -> Any:
        targets = jnp.stack([t, jnp.asarray(1e5 / (unit[0] / unit[2]))])
        given = Unknowns(jnp.asarray(last.u), jnp.asarray(last.loads))
        settled = settle((problem.basis, own), given, bench.p, 2.0, jnp.asarray(which), targets)
        return settled.loads[0] * unit[0] / unit[1]

    step = 1e-5
    ends = [find(problem, Held(names, (0.105 + k * step, 1e5)), last).force for k in (-1, 1)]
    assert float(jax.grad(force)(0.105)) == pytest.approx((ends[1] - ends[0]) / (2.0 * step), rel=1e-7)


def test_unequal_end_radii_need_a_closing_moment() -> None:
    """On the full line the closure is a row like any other: the angle differs from end to end by what is asked."""
    bench = Bench.of(mk.presets.reference().replace("ends", "pinned"))
    problem = bench.problem(48, 2.0, modes="all")
    path = [Held(("length", "pressure", "closure"), (0.100, 1e5, share * 0.05)) for share in np.linspace(0.0, 1.0, 6)]
    start = find(problem, Held.of(length=0.100, pressure=1e5))
    found = trace(problem, path, start, tolerance=1e-7)
    assert found.reached == 6
    assert found.state(0).now.moment == pytest.approx(start.now.moment, rel=1e-9)
    assert found.state(5).now.closure == pytest.approx(0.05, rel=1e-10)
    moments = np.array([found.state(k).now.moment for k in range(6)])
    energy = np.array([
        state.totals[0] - state.loads[:2] @ state.totals[1:3] for state in map(found.state, range(6))
    ]) * problem.unit[0]  # fmt: skip
    gained = np.trapezoid(moments, dx=0.01)  # the moment does the work on the closure, at the same length
    held_back = sum(np.trapezoid(part, dx=1.0) for part in _work_of_loads(found))
    assert energy[-1] - energy[0] + held_back == pytest.approx(gained, rel=1e-3)


def _work_of_loads(found: Any) -> list[np.ndarray]:
    """h dF + V dP along the states, what the potential gives up as loads change."""
    states = [found.state(k) for k in range(6)]
    return [
        np.array([state.length for state in states]) * np.gradient([state.force for state in states]),
        np.array([state.volume for state in states]) * np.gradient([state.pressure for state in states]),
    ]


def test_known_angles_have_the_same_derivatives() -> None:
    angle = 0.7
    for function in (sin, cos, tan, lambda x: sin(x) ** 2 * cos(x) + tan(x)):
        known = Known.of(jnp.asarray(angle))
        assert float(function(known)) == pytest.approx(float(function(jnp.asarray(angle))), rel=1e-15)
        for f in (function, lambda x, function=function: slope(function, x)):
            assert float(slope(f, known)) == pytest.approx(float(slope(f, jnp.asarray(angle))), rel=1e-13)


@pytest.mark.parametrize("unknowns", [8, 12, 24, 48, 96])
def test_batches_stay_below_what_jaxlib_divides_among_threads(unknowns: int) -> None:
    size = batch_size(unknowns)
    assert 1 <= size <= MOST
    assert size * (unknowns**3 // 3) < WORK or size == 1


def test_a_path_keeps_what_its_points_remember() -> None:
    """Nothing changes a memory yet: every step hands it on, and the states are the same as without."""
    problem = Bench.of(mk.presets.paper()).problem(12, 1.0)
    first = find(problem, Held.of(length=0.1, pressure=5e4))
    targets = np.linspace([0.1 / 0.085, 1.0], [0.11 / 0.085, 1.0], 32) * np.array([1.0, first.loads[1]])
    memory = {"slip": np.arange(float(problem.basis.points)), "back": np.ones(problem.basis.points, bool)}
    own, which = rows_of(("length", "pressure"), 2)
    tracks = [
        follow((problem.basis, own), problem.p, problem.b, state, which, targets, np.asarray(5), np.asarray(1e-6))
        for state in (first.state, first.state._replace(memory=memory))
    ]
    assert [int(track.good) for track in tracks] == [5, 5]
    np.testing.assert_allclose(tracks[0].state.u, tracks[1].state.u, rtol=0.0, atol=1e-14)
    for name, values in memory.items():
        np.testing.assert_array_equal(tracks[1].state.memory[name][:5], np.tile(values, (5, 1)))
