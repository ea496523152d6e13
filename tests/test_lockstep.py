"""The equations arranged for many muscles against the ones for a single muscle, and angles whose sine is known."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from muscles import reference

from mckibben.discretise.line import Line
from mckibben.model.angle import Known, cos, sin, slope, tan
from mckibben.solver import lockstep
from mckibben.solver.problem import Space, bordered

SELECTS = {
    "length": [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    "force": [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    "volume": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
}


@pytest.mark.parametrize("held", SELECTS)
@pytest.mark.parametrize("ends", ["clamped", "pinned", "free"])
def test_newton_step_and_tangents_are_those_of_the_bordered_system(ends: str, held: str) -> None:
    p, law = reference()
    p = jax.tree.map(jnp.asarray, p)
    line, select = Line(8, ends), jnp.asarray(SELECTS[held])
    space = Space(line, law)
    w = jnp.asarray(np.random.default_rng(3).standard_normal(line.unknowns + 2) * 0.02).at[-1].set(0.4)
    targets = jnp.asarray([1.1 if held == "length" else 0.3, 0.5])

    @jax.jit
    def both(w: jax.Array) -> tuple[lockstep.Correction, jax.Array]:
        d = lockstep.design(line, law, p, 1.3)
        s = lockstep.system(line, law, d, w, lockstep.sample(line, d, w))
        system, miss, _ = bordered(space, p, 1.3, w, select, targets)
        sides = jnp.concatenate([-miss[:, None], jnp.eye(len(w))[:, -2:]], axis=1)
        return lockstep.correct(s, w, select, targets), jnp.linalg.solve(system, sides)

    found, expected = both(w)
    size = np.abs(expected).max()
    np.testing.assert_allclose(found.step, expected[:, 0], rtol=0.0, atol=1e-11 * size)
    np.testing.assert_allclose(found.tangents, expected[:, 1:], rtol=0.0, atol=1e-11 * size)


def test_stability_is_that_of_the_stiffness_on_what_is_left_free() -> None:
    K, gradients = jnp.diag(jnp.asarray([-1.0, 2.0, 3.0])), jnp.asarray([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    s = lockstep.System(K, jnp.zeros(3), gradients, jnp.zeros(2))
    for held, stable in (("length", True), ("force", False)):
        assert bool(lockstep.correct(s, jnp.zeros(5), jnp.asarray(SELECTS[held]), jnp.zeros(2)).stable) == stable


def test_known_angles_have_the_same_derivatives() -> None:
    angle = 0.7
    for function in (sin, cos, tan, lambda x: sin(x) ** 2 * cos(x) + tan(x)):
        known = Known.of(jnp.asarray(angle))
        assert float(function(known)) == pytest.approx(float(function(jnp.asarray(angle))), rel=1e-15)
        for f in (function, lambda x, function=function: slope(function, x)):
            assert float(slope(f, known)) == pytest.approx(float(slope(f, jnp.asarray(angle))), rel=1e-13)


@pytest.mark.parametrize("unknowns", [8, 12, 24, 48, 96])
def test_batches_stay_below_what_jaxlib_divides_among_threads(unknowns: int) -> None:
    size = lockstep.batch_size(unknowns)
    assert 1 <= size <= lockstep.MOST
    assert size * (unknowns**3 // 3) < lockstep.WORK or size == 1
