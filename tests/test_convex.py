"""States that are convex at every point: what may be concluded from it, and when it is."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from muscles import seeded

import mckibben as mk
from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Placed, place
from mckibben.discretise.spectral import Line
from mckibben.measure.read import read_many
from mckibben.model.angle import Known
from mckibben.model.parameters import parameters
from mckibben.solver.system import Unknowns, convex, localise, stiffness

pytestmark = pytest.mark.solver

WHOLE = mk.presets.paper().replace("end_radii", ["12.5 mm", "11 mm"])
STRETCHING = mk.presets.paper().replace("braid.fibre.stretch", True).replace("ends", "pinned")
COUNT, CROWDED = 160, 1.5


@partial(jax.jit, static_argnums=0)
def looked_at(line: Line, on: Placed, states: Unknowns) -> tuple[Array, ...]:
    """Of each state whether it is convex, and its stiffness for disturbances of its own symmetry and of the other."""

    def one(state: Unknowns) -> tuple[Array, ...]:
        local = localise(line, on, state)
        spaces = (line, line.even()) if line.half else (line,)
        return convex(line, local), *(stiffness(space, on, local) for space in spaces)

    return jax.vmap(one)(states)


def shapes(line: Line, count: int = COUNT) -> Unknowns:
    """Gentle and rough ones under all kinds of loads, not in equilibrium."""
    rng = np.random.default_rng(1)
    size = 10.0 ** rng.uniform(-3.0, -0.3, (count, 1))
    u = size * rng.normal(size=(count, line.unknowns)) / (1.0 + np.arange(line.unknowns)) ** 2
    loads = rng.uniform(-1.0, 3.0, (count, 3 if line.closes else 2)) * 10.0 ** rng.uniform(-2.0, 0.5, (count, 1))
    return Unknowns(jnp.asarray(u), jnp.asarray(loads))


@pytest.mark.parametrize(
    "muscle", [seeded(3).muscle(), seeded(8, "pinned").muscle(), WHOLE, STRETCHING], ids=["3", "8", "whole", "stretch"]
)
def test_what_is_convex_at_every_point_has_no_negative_mode(muscle: mk.Muscle) -> None:
    line = Line.of(muscle, 8)
    sure, *matrices = looked_at(line, place(line, parameters(muscle), CROWDED), shapes(line))
    least = np.array([np.linalg.eigvalsh(K)[:, 0] for K in matrices]).min(axis=0)
    assert (least[np.asarray(sure)] > 0.0).all()
    assert (least < 0.0).sum() > COUNT // 20
    if muscle is not STRETCHING:  # whose stretch and turn at the fittings enter together only
        assert np.asarray(sure).sum() > COUNT // 20


def test_where_one_is_not_all_are_counted() -> None:
    """States are read some at a time: those of both kinds, and those that are all convex."""
    muscle = seeded(3).muscle()
    line, p = Line.of(muscle, 8), parameters(muscle)
    states = shapes(line)
    sure, own, _ = (np.asarray(one) for one in looked_at(line, place(line, p, CROWDED), states))
    least = np.linalg.eigvalsh(own)[:, 0]
    told = [np.flatnonzero(which)[:4] for which in (sure, least < 0.0)]
    for some in (np.concatenate(told), np.flatnonzero(sure)[:8]):
        chosen = jax.tree.map(lambda rows, some=some: rows[some], states)
        _, under, _ = read_many(line, p, CROWDED, chosen, np.array(False), np.asarray(8))
        np.testing.assert_array_equal(under.force, least[some] > 0.0)
        assert np.asarray(under.length)[least[some] > 0.0].all()


def test_a_sign_by_division_is_exact() -> None:
    """All four quarters, either side of zero and far from it."""
    angle = np.concatenate([np.linspace(-20.0, 20.0, 4001), [0.0, 1e-300, 1e3, -1e4]])
    known = Known.of(jnp.asarray(angle))
    np.testing.assert_allclose(known.sine, np.sin(angle), rtol=0.0, atol=2.3e-16)
    np.testing.assert_allclose(known.cosine, np.cos(angle), rtol=0.0, atol=2.3e-16)
