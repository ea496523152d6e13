"""Derivatives of results against central differences, identities of dimensions and closed forms."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from muscles import MAGIC, seeded

import mckibben as mk
from mckibben import spec
from mckibben.discretise.bspline import Spline
from mckibben.discretise.fields import place
from mckibben.discretise.spectral import Line
from mckibben.measure.peak import peak
from mckibben.measure.read import read
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.parameters import parameters
from mckibben.results.variables import OBSERVED
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import ROWS, Held, conditions, rows_of, units
from mckibben.solver.implicit import settle
from mckibben.solver.newton import bordered
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns, system

pytestmark = pytest.mark.derivatives

PAPER, REFERENCE = mk.presets.paper(), mk.presets.reference()
# Central differences, exact for polynomials of degree 6.
OFFSETS, WEIGHTS = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / 60.0
THIN = PAPER.replace("braid.fibre.diameter", "0.05 mm")
"""Its end layers are 0.05 mm wide."""
LENGTHS = {"m": 1, "m^3": 3, "N": 2, "Pa": 0, "N m^2": 4, "J": 3, "1": 0, "rad": 0}
STIFFNESSES = {"m": 0, "m^3": 0, "N": 1, "Pa": 1, "N m^2": 1, "J": 1, "1": 0, "rad": 0}
"""Powers of length and of stiffness in each unit."""


def held_near_magic(muscle: mk.Muscle, seed: int) -> dict[str, float]:
    """A length and a pressure at which a muscle is good."""
    random, bench = np.random.default_rng(1000 + seed), Bench.of(muscle)
    stretch = np.sin(MAGIC + random.uniform(-0.1, 0.15)) / np.sin(muscle.braid.angle)
    length = min(muscle.braid.length * stretch, 0.93 * bench.longest)
    return {"length": float(length), "pressure": float(random.uniform(0.5e5, 4e5))}


def state_of(muscle: mk.Muscle, held: dict[str, float]) -> Equilibrium:
    bench = Bench.of(muscle)
    found = find(bench.problem(48, bench.placement(Held.of(**held))), Held.of(**held))
    assert found.converged
    return found


def results(
    basis: Basis, tree: Any, anew: bool, which: jax.Array, at: jax.Array, share: jax.Array, b: Any, state: Unknowns
) -> Any:
    """Results where numbers and held values are changed to a share of theirs, at w: solved anew, or by `settle`.

    What is held is a number, so that all ways of holding share what is compiled.
    """
    numbers = at * share
    p = parameters(jax.tree.unflatten(tree, list(numbers[:-2])))
    on = place(basis, p, b)
    size, own = units(on.unit), ()
    targets, m = numbers[-2:] / jnp.stack([size[name] * jnp.ones(()) for name in ROWS])[which], basis.unknowns

    def newton(_: Any, state: Unknowns) -> Unknowns:
        s = system(basis, on, state)
        c = conditions(own, which, targets, on, s, state.loads)
        step = jnp.linalg.solve(bordered(s, c), jnp.concatenate([s.rest, c.miss]))
        return Unknowns(state.u - step[:m], state.loads - step[m:])

    state = jax.lax.fori_loop(0, 8, newton, state) if anew else settle((basis, own), state, p, b, which, targets)
    seen = read(basis, on, state).numbers
    return jnp.stack([seen[name] for name in OBSERVED])


exact_by = jax.jit(jax.jacfwd(results, argnums=5), static_argnums=(0, 1, 2))
solved_at = jax.jit(jax.vmap(results, in_axes=(None, None, None, None, None, 0, None, None)), static_argnums=(0, 1, 2))


def agree(muscle: mk.Muscle, names: tuple[str, ...], state: Equilibrium, tolerance: float = 1e-6) -> None:
    """All results by all numbers and by what is held: relative derivatives against central differences."""
    held = Held.of(**{name: getattr(state, name) for name in names})
    leaves, tree = jax.tree.flatten(muscle)
    at, n = np.array([*leaves, *held.values]), len(leaves) + 2
    known, static = (state.problem.b, state.state), (state.problem.basis, tree)
    which = jnp.asarray(rows_of(held.names, 2)[1])
    exact = np.asarray(exact_by(*static, False, which, at, np.ones(n), *known))
    value = np.asarray(solved_at(*static, True, which, at, np.ones((1, n)), *known))[0]
    size = np.abs(value)[:, None] + 1e-300
    steps = 2e-3 / np.maximum(
        1.0, np.max(np.abs(exact) / size, axis=0, where=np.abs(value)[:, None] > 1e-9, initial=1.0)
    )
    changed = 1.0 + np.einsum("o,kj->okj", OFFSETS, np.diag(steps))
    near = np.asarray(solved_at(*static, True, which, at, changed.reshape(-1, n), *known))
    near = np.einsum("o,okr->rk", WEIGHTS, near.reshape(len(OFFSETS), n, -1)) / steps
    error = np.abs(near - exact) / np.maximum(np.abs(exact), size)
    assert error.max() < tolerance, (error.max(), np.unravel_index(error.argmax(), error.shape))


CONTROLS = (
    ("length", "pressure"),
    ("force", "pressure"),
    ("volume", "pressure"),
    ("volume", "force"),
)
# Length and volume together: pinned, the volume hardly moves at a fixed length, and the differences are noise.
CASES = [(ends, names) for names in CONTROLS for ends in ("clamped", "pinned")] + [("clamped", ("length", "volume"))]


@pytest.mark.parametrize(("ends", "names"), CASES, ids=lambda x: x if isinstance(x, str) else " and ".join(x))
def test_central_differences_on_random_muscles(ends: str, names: tuple[str, str]) -> None:
    """Lengths, forces and volumes held, all results by all numbers; the state is the same, the control another one."""
    for seed in range(3):
        muscle = seeded(seed, ends).muscle()
        state = state_of(muscle, held_near_magic(muscle, seed))
        agree(muscle, names, state)


@pytest.mark.parametrize("names", CONTROLS[:2], ids=" and ".join)
def test_central_differences_at_thin_end_layers(names: tuple[str, str]) -> None:
    state = state_of(THIN, {"length": 0.110, "pressure": 1e5})
    assert state.problem.b > 3.0
    agree(THIN, names, state)


def weighed(found: mk.Sensitivity, powers: dict[str, int]) -> np.ndarray:
    """Sum over the numbers of power times value times derivative, over what it should be: power times result."""
    data = found.data
    power = np.array([powers[unit] for unit in data["number_unit"].values])
    got = (power * data["number_value"].values) @ data["absolute"].values
    return got - np.array([powers[unit] for unit in data["result_unit"].values]) * data["result_value"].values


@pytest.mark.parametrize(
    "test",
    [mk.Isometric(length="110 mm", pressure=[2e4, 1e5]), mk.Isotonic(force="5 N", pressure=[2e4, 1e5])],
    ids=lambda test: test.kind,
)
@pytest.mark.parametrize("muscle", [PAPER, REFERENCE], ids=["round fibres", "stiffnesses"])
def test_dimensions(muscle: mk.Muscle, test: mk.Isometric) -> None:
    """Longer by a share everywhere, or stiffer and more pressure by a share: every result follows by its dimension.

    By Euler's theorem the derivatives, weighed by the dimensions of the numbers, sum to the dimension of the result.
    """
    found = mk.sensitivity(muscle, test, of=tuple(OBSERVED))
    assert found.verdict == "stable"
    size = np.abs(found.data["result_value"].values) + 1e-12
    for powers in (LENGTHS, STIFFNESSES):
        assert (np.abs(weighed(found, powers)) / size).max() < 1e-8


def test_free_ends_of_thin_fibres_have_the_derivatives_of_the_cylinder() -> None:
    """The moment of the fibres bends a free end a little, less the thinner they are."""
    muscle, test = THIN.replace("ends", "free"), mk.Isometric(length="110 mm", pressure="1 bar")

    def force(muscle: mk.Muscle, length: Any, pressure: Any) -> Any:
        p = parameters(muscle)
        return cylinder_force(cylinder_angle(length, p), pressure, p)

    slopes = jax.tree.leaves(jax.jit(jax.grad(force, argnums=(0, 1, 2)))(muscle, 0.110, 1e5))
    names = [*(name for name, _, _ in spec.numbers(muscle)), "test.length", "test.pressure"]
    exact = dict(zip(names, map(float, slopes), strict=True))
    found = mk.sensitivity(muscle, test, of="force").absolute["force"]
    for name in ("braid.radius", "braid.length", "braid.angle", "chamber.thickness", "test.length", "test.pressure"):
        assert found[name] == pytest.approx(exact[name], rel=1e-6), name


def test_net_of_threads_in_a_long_muscle() -> None:
    """Without stiffness and pressure to spare F = pi R0^2 (3 sin^2 - 1)/cos^2 P: derivatives by hand, ends left out."""
    soft = PAPER.replace("chamber", None).replace("braid.fibre.diameter", "0.05 mm").replace("ends", "free")
    found = mk.sensitivity(soft, mk.Isometric(length="110 mm", pressure="1 bar"), of="force")
    sine = np.sin(soft.braid.angle) * 110.0 / 85.0
    by_length = 6.0 * sine**2 / (3.0 * sine**2 - 1.0)
    by_angle = by_length / np.tan(soft.braid.angle) + 2.0 * np.tan(soft.braid.angle)
    shares = found.relative["force"]
    assert shares["test.length"] == pytest.approx(by_length, rel=1e-3)
    assert shares["braid.length"] == pytest.approx(-by_length, rel=1e-3)
    assert shares["braid.angle"] == pytest.approx(by_angle * soft.braid.angle, rel=1e-3)
    assert shares["braid.radius"] == pytest.approx(2.0, rel=1e-3)
    assert shares["test.pressure"] == pytest.approx(1.0, rel=1e-3)


def test_peak_between_the_points() -> None:
    half, whole = Line(64), Line(64, modes="all")
    inner, over = half.operators().x, whole.operators().x

    def hill(place: Any) -> Any:
        return peak(jnp.exp(-40.0 * (inner + place) ** 2), half.harmonics())

    for top in (0.3, 0.501, 0.5 + 0.5 / 64, 0.999):
        value, slope = jax.value_and_grad(lambda at: (1.0 + at) * hill(at))(top)
        assert float(value) == pytest.approx(1.0 + top, abs=1e-11)
        assert float(slope) == pytest.approx(1.0, abs=1e-10)
    place = jax.grad(jax.grad(lambda at: peak(-((over - at) ** 2) + at * over, whole.harmonics())))(0.2)
    assert float(place) == pytest.approx(2.5, abs=1e-9)  # of the peak 5 at^2/4, at 3 at/2
    end = jax.value_and_grad(lambda a: peak(jnp.exp(-a * inner), half.harmonics()))(0.7)  # at the fitting
    np.testing.assert_allclose(np.array(end), np.exp(0.7), rtol=1e-12)
    middle = jax.value_and_grad(lambda a: peak(a - inner**2, half.harmonics()))(2.0)
    np.testing.assert_allclose(np.array(middle), [2.0, 1.0], rtol=1e-12)
    level = jax.value_and_grad(lambda a: peak(a + 0.0 * over, whole.harmonics()))(3.0)
    np.testing.assert_allclose(np.array(level), [3.0, 1.0], rtol=1e-12)


def test_peak_of_splines() -> None:
    spline = Spline()
    x = spline.operators().x
    found = jax.value_and_grad(lambda a: peak(jnp.exp(-10.0 * (x - a) ** 2) * (1.0 + a), spline.harmonics()))(0.333)
    np.testing.assert_allclose(np.array(found), [1.333, 1.0], rtol=1e-4)
