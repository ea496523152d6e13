"""The matrix products of a discretisation: from numbers at the points to matrices over the unknowns.

Many muscles in step share tables of products, so that the work is a few large matrix products; a single muscle is
quicker, and needs less memory, without.
"""

from functools import lru_cache
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats

__all__ = ["pairs", "sandwich", "swept"]


def pairs(count: int) -> tuple[tuple[int, int], ...]:
    """Pairs of fields (i, j), i <= j, in the order that `sandwich` takes them."""
    return tuple((i, j) for i in range(count) for j in range(i, count))


def sandwich(basis: Any, numbers: list[Array], together: bool) -> Float[Array, "m m"]:
    """Sum over pairs of fields of O_i^T diag(number) O_j, and its transpose where i and j differ."""
    fields = basis.operators().fields
    if together:
        m = basis.unknowns
        return (jnp.concatenate(numbers) @ _squares(basis)).reshape(m, m)
    total: Any = 0.0
    for (i, j), number in zip(pairs(len(fields)), numbers, strict=True):
        part = jnp.asarray(fields[i]).T @ (number[:, None] * fields[j])
        total = total + (part if i == j else part + part.T)
    return total


def swept(basis: Any, turns: tuple[tuple[Array, ...], ...], jacobian: Array, together: bool) -> tuple[Array, ...]:
    """Derivatives (q, m) of the integrated variables by the unknowns; `turns` is J d(rate)/dx."""
    operators, form = basis.operators(), basis.form
    first, found = len(form.integrals), []
    for one, by, lift in zip(form.integrals, turns, operators.lifts, strict=True):
        if not one.by:
            found.append(jnp.asarray(lift))
            continue
        own = {k - first: turn for k, turn in zip(one.by, by, strict=True) if k >= first}
        own = {k: turn / jacobian ** form.orders[k] if form.orders[k] else turn for k, turn in own.items()}
        before = [turn[:, None] * found[k] for k, turn in zip(one.by, by, strict=True) if k < first]
        if together:
            table = sum(turn @ _sweeps(basis, k) for k, turn in own.items()).reshape(lift.shape)
            for part in before:
                table = table + jnp.asarray(operators.cumulate) @ part
        else:
            rate = sum([*(turn[:, None] * operators.fields[k] for k, turn in own.items()), *before])
            table = jnp.asarray(operators.cumulate) @ rate
        found.append(table + lift)
    return tuple(found)


@lru_cache(maxsize=16)
def _squares(basis: Any) -> Floats:
    """O_i O_j at the points (pairs q, m m), both ways round where i and j differ."""
    fields = basis.operators().fields
    parts = []
    for i, j in pairs(len(fields)):
        part = np.einsum("qa,qb->qab", fields[i], fields[j])
        parts.append(part if i == j else part + part.transpose(0, 2, 1))
    return np.concatenate(parts).reshape(-1, basis.unknowns**2)


@lru_cache(maxsize=16)
def _sweeps(basis: Any, k: int) -> Floats:
    """Integral up to each point of f O_k, by f at the points (q, q m)."""
    operators = basis.operators()
    q, m = operators.fields[k].shape
    return np.einsum("kj,jm->jkm", operators.cumulate, operators.fields[k]).reshape(q, q * m)
