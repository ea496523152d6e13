"""The matrix products of a discretisation: from numbers at the points to matrices over the unknowns.

Many muscles in step share tables of products, so that the work is a few large matrix products; a single muscle is
quicker, and needs less memory, without. So are many whose tables would be large: they are part of what is compiled.
Each field has unknowns of its own, so products are made block by block: three quarters of the matrix of a muscle whose
fibres stretch and roll would be multiplied by zeros otherwise.
"""

from functools import lru_cache
from itertools import pairwise
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Floats

__all__ = ["pairs", "sandwich", "swept"]

Ways = dict[int, tuple[tuple[int, int], ...]]
"""By the number of a pair of fields: (i, j), (j, i) or both, as O_i^T diag(number) O_j contributes to a block."""

LARGEST = 2_000_000
"""Numbers in a table above which products are made without one."""


def pairs(count: int) -> tuple[tuple[int, int], ...]:
    """Pairs of fields (i, j), i <= j, in the order that `sandwich` takes them."""
    return tuple((i, j) for i in range(count) for j in range(i, count))


def sandwich(basis: Any, numbers: list[Array], together: bool) -> Float[Array, "m m"]:
    """Sum over pairs of fields of O_i^T diag(number) O_j, and its transpose where i and j differ."""
    blocks = {place: _block(basis, place, within, numbers, together) for place, within in _places(basis).items()}
    blocks |= {(b, a): block.T for (a, b), block in blocks.items() if a != b}
    spans = _spans(basis)
    if len(spans) == 1:
        return blocks[0, 0]
    widths = [b - a for a, b in spans]
    empty = [[jnp.zeros((a, b)) for b in widths] for a in widths]
    rows = [[blocks.get((a, b), empty[a][b]) for b in range(len(spans))] for a in range(len(spans))]
    return jnp.concatenate([jnp.concatenate(row, axis=1) for row in rows])


def _block(basis: Any, place: tuple[int, int], within: Ways, numbers: list[Array], together: bool) -> Array:
    """The block of a matrix at `place`, to which the pairs `within` contribute."""
    (first, last), (left, right) = (_spans(basis)[k] for k in place)
    fields, size = basis.operators().fields, (last - first) * (right - left)
    if together and len(within) * len(fields[0]) * size <= LARGEST:
        return (jnp.concatenate([numbers[k] for k in within]) @ _squares(basis, place)).reshape(last - first, -1)
    total: Any = 0.0
    for k, ways in within.items():
        (i, j), *other = ways
        part = jnp.asarray(fields[i][:, first:last]).T @ (numbers[k][:, None] * fields[j][:, left:right])
        if other and place[0] == place[1]:
            part = part + part.T
        elif other:
            part = part + fields[j][:, first:last].T @ (numbers[k][:, None] * fields[i][:, left:right])
        total = total + part
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
        if together and lift.size * len(lift) <= LARGEST:
            table = sum(turn @ _sweeps(basis, k) for k, turn in own.items()).reshape(lift.shape)
            for part in before:
                table = table + jnp.asarray(operators.cumulate) @ part
        else:
            rate = sum([*(turn[:, None] * operators.fields[k] for k, turn in own.items()), *before])
            table = jnp.asarray(operators.cumulate) @ rate
        found.append(table + lift)
    return tuple(found)


@lru_cache(maxsize=16)
def _spans(basis: Any) -> tuple[tuple[int, int], ...]:
    """The unknowns in parts, from and to: each field is by all of some of them, and by none of the others."""
    used = np.array([np.any(part != 0.0, axis=0) for part in basis.operators().fields])
    edges = np.flatnonzero(np.any(used[:, 1:] != used[:, :-1], axis=0)) + 1
    return tuple(pairwise([0, *edges.tolist(), used.shape[1]]))


@lru_cache(maxsize=16)
def _places(basis: Any) -> dict[tuple[int, int], Ways]:
    """The blocks (part, part) of the upper triangle that are not zero, and what contributes to them."""
    fields, spans = basis.operators().fields, _spans(basis)
    has = [[bool(np.any(part[:, a:b])) for a, b in spans] for part in fields]
    both = {k: {(i, j), (j, i)} for k, (i, j) in enumerate(pairs(len(fields)))}
    found: dict[tuple[int, int], Ways] = {}
    for a in range(len(spans)):
        for b in range(a, len(spans)):
            ways = {k: tuple(sorted((i, j) for i, j in ways if has[i][a] and has[j][b])) for k, ways in both.items()}
            found[a, b] = {k: some for k, some in ways.items() if some}
    return {place: ways for place, ways in found.items() if ways}


@lru_cache(maxsize=64)
def _squares(basis: Any, place: tuple[int, int]) -> Floats:
    """O_i O_j at the points in a block (pairs q, a b), both ways round where i and j differ."""
    fields = basis.operators().fields
    (first, last), (left, right) = (_spans(basis)[k] for k in place)
    parts = [
        sum(np.einsum("qa,qb->qab", fields[i][:, first:last], fields[j][:, left:right]) for i, j in ways)
        for ways in _places(basis)[place].values()
    ]
    return np.concatenate(parts).reshape(-1, (last - first) * (right - left))


@lru_cache(maxsize=16)
def _sweeps(basis: Any, k: int) -> Floats:
    """Integral up to each point of f O_k, by f at the points (q, q m)."""
    operators = basis.operators()
    q, m = operators.fields[k].shape
    return np.einsum("kj,jm->jkm", operators.cumulate, operators.fields[k]).reshape(q, q * m)
