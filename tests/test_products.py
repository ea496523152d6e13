"""Matrix products made block by block: against the plain sums that they stand for."""

import numpy as np
import pytest
from jax import numpy as jnp
from numpy.testing import assert_allclose

from mckibben.discretise import products
from mckibben.discretise.products import pairs, sandwich, swept
from mckibben.discretise.spectral import Line

pytestmark = pytest.mark.solver

EVERYTHING = {"stretch": True, "roll": True, "give": True}
LINES = [
    Line(8, "pinned"),
    Line(8, "free"),
    Line(8, "clamped", **EVERYTHING),
    Line(8, "free", **EVERYTHING),
    Line(8, "pinned", modes="even", **EVERYTHING),
    Line(9, "clamped", modes="all", **EVERYTHING),
]


@pytest.mark.parametrize("together", [False, True])
@pytest.mark.parametrize("line", LINES, ids=str)
def test_sums_over_pairs_of_fields(line: Line, together: bool) -> None:
    """Whichever unknowns each field has."""
    fields = line.operators().fields
    numbers = np.random.default_rng(3).normal(size=(len(pairs(len(fields))), line.points))
    expected = np.zeros((line.unknowns, line.unknowns))
    for (i, j), number in zip(pairs(len(fields)), numbers, strict=True):
        part = np.einsum("qa,q,qb->ab", fields[i], number, fields[j])
        expected += part if i == j else part + part.T
    found = sandwich(line, [jnp.asarray(number) for number in numbers], together)
    assert_allclose(found, expected, rtol=0.0, atol=1e-14 * np.abs(expected).max())


def test_large_tables_are_done_without(monkeypatch: pytest.MonkeyPatch) -> None:
    """They would be part of what is compiled: the numbers are the same without."""
    line = LINES[2]
    rng, fields, integrals = np.random.default_rng(4), len(line.form.orders), line.form.integrals
    numbers = [jnp.asarray(rng.normal(size=line.points)) for _ in pairs(fields)]
    turns = tuple(tuple(jnp.asarray(rng.normal(size=line.points)) for _ in one.by) for one in integrals)
    jacobian = jnp.asarray(rng.uniform(0.5, 1.0, line.points))
    with_tables = sandwich(line, numbers, True), *swept(line, turns, jacobian, True)
    monkeypatch.setattr(products, "LARGEST", 0)
    monkeypatch.setattr(products, "_squares", None)
    monkeypatch.setattr(products, "_sweeps", None)
    without = sandwich(line, numbers, True), *swept(line, turns, jacobian, True)
    for one, other in zip(with_tables, without, strict=True):
        assert_allclose(one, other, rtol=0.0, atol=1e-14 * float(jnp.abs(one).max()))
