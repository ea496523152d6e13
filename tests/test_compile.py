"""Changing a number compiles nothing, changing a choice does; and every number can be differentiated."""

import logging
from typing import Any

import jax
import numpy as np
import pytest

import mckibben as mk
from mckibben.compiled.kernel import keeping
from mckibben.discretise.placement import crowdings_at
from mckibben.measure.read import read_many
from mckibben.measure.survey import survey
from mckibben.model.cylinder import cylinder_force
from mckibben.model.parameters import parameters
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.follow import follow
from mckibben.solver.held import Held
from mckibben.solver.path import trace
from mckibben.solver.problem import balance, curvature, setting

pytestmark = pytest.mark.compiled

COMPILED = (setting, balance, curvature, follow, read_many, crowdings_at)
REFERENCE = mk.presets.reference()
SIZE, OWN = 24, 7
"""Unknowns: the usual number, and one of these tests' own that no other test has compiled before."""


def counts() -> list[int]:
    """Compilations held for each function."""
    return [function._cache_size() for function in COMPILED]


def chain(muscle: mk.Muscle) -> None:
    """Everything a test on the bench calls: placement, set-up, search, following, modes and fields."""
    bench, length = Bench.of(muscle), float(muscle.braid.length)
    path = [Held.of(length=length * stretch, pressure=5e4) for stretch in (1.0, 1.02, 1.04)]
    problem = bench.problem(SIZE, bench.placement(path[0]))
    assert find(problem, path[0]).converged
    found = trace(problem, path, tolerance=1e-4)
    assert found.reached == 3
    survey(problem, found.u, found.loads, path[0].names)


def test_a_number_compiles_nothing(caplog: pytest.LogCaptureFixture) -> None:
    chain(REFERENCE)
    before = counts()
    assert min(before) >= 1
    numbers = {
        "braid.radius": "10 mm", "braid.length": 0.06, "braid.angle": "50 deg", "braid.fibres": 48,
        "braid.fibre.B1": 1e-6, "braid.fibre": mk.Fibre(diameter="0.3 mm", E="3 GPa", nu=0.3),
        "braid.fibre.natural": "straight", "chamber.thickness": "0.5 mm", "chamber.law.c2": 1e4,
    }  # fmt: skip
    with jax.log_compiles(), caplog.at_level(logging.WARNING):
        for field, value in numbers.items():
            chain(REFERENCE.replace(field, value))
            assert counts() == before, field
            assert not caplog.messages, field  # nor anything smaller


@pytest.mark.parametrize("choice", ["ends", "law"])
def test_a_choice_compiles_anew(choice: str, caplog: pytest.LogCaptureFixture) -> None:
    """Ends, or another law, even of the same energy; the cylinder that places points has no ends."""
    law = mk.CustomLaw(function=lambda l1, l2, l3, c: 5e4 * (l1**2 + l2**2 + l3**2 - 3.0))
    muscle = REFERENCE.replace("ends", "pinned") if choice == "ends" else REFERENCE.replace("chamber.law", law)
    for function in COMPILED:  # what other tests compiled in this process must not count
        function.clear_cache()
    bench, other, held = Bench.of(REFERENCE), Bench.of(muscle), Held.of(length=0.09, pressure=5e4)
    with keeping(None):  # nor what an earlier run left on the disk
        assert find(bench.problem(OWN, bench.placement(held)), held).converged
        before = counts()
        with jax.log_compiles(), caplog.at_level(logging.WARNING):
            assert find(other.problem(OWN, other.placement(held)), held).converged
    grown = {function for function, a, b in zip(COMPILED, before, counts(), strict=True) if b > a}
    assert grown == {setting, balance, curvature, crowdings_at} - ({crowdings_at} if choice == "ends" else set())
    assert any("curvature" in message for message in caplog.messages)


@pytest.mark.parametrize(
    "field",
    ["braid.radius", "braid.angle", "braid.fibre.diameter", "braid.fibre.E", "braid.fibre.nu", "chamber.thickness",
     "chamber.law.c1"],
)  # fmt: skip
def test_every_number_can_be_differentiated(field: str) -> None:
    """Through the specification itself, which takes traced numbers."""
    paper = mk.presets.paper()
    value: Any = paper
    for name in field.split("."):
        value = getattr(value, name)

    def force(share: Any) -> Any:
        muscle = paper.replace(field, share * value)
        return cylinder_force(0.8, 1e5, parameters(muscle))

    offsets, weights = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / 60.0
    near = jax.jit(jax.vmap(force))(1.0 + 3e-3 * offsets)
    slope, terms = float(weights @ near) / 3e-3, float(np.abs(weights) @ np.abs(near)) / 3e-3
    found = float(jax.jit(jax.grad(force))(1.0))
    assert found == pytest.approx(slope, abs=1e-15 * terms)
    assert abs(found) > 1e-13 * terms
