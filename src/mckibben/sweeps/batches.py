"""Many muscles through one test each, in batches: the quick way of a sweep, which knows when it is not enough.

The same discretisations and point placements as for a single run, so the same numbers. A design whose path is not
followed cleanly, state by state, is left to `run`.
"""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.discretise.spectral import Line
from mckibben.measure.many import Appraised, appraised
from mckibben.measure.survey import PLAIN_SLOPE, STRETCHED, error_bound, unresolved_bound
from mckibben.measure.unresolved import asks_for_step
from mckibben.solver.bench import sizes_for
from mckibben.solver.system import Unknowns
from mckibben.sweeps.groups import Group, surely_reached
from mckibben.sweeps.paths import Paths, finer, followed

__all__ = ["Solved", "solve_together"]

LARGEST = 48
"""Half-length unknowns up to which a batch goes; what needs more is solved singly."""
CLOSE = 2e-3
"""Last Newton step [rad] of every state over the square root of the tolerance: the error left is about its square."""


@attrs.frozen
class Solved:
    """Designs of a group that were followed cleanly on one discretisation; d designs, n states, SI units."""

    group: Group
    line: Line
    b: np.ndarray  #: (d) crowding of points
    state: Unknowns  #: (d, n, m) and (d, n, 2), dimensionless
    numbers: dict[str, np.ndarray]  #: (d, n), by the names of a sweep's variables
    plain: np.ndarray  #: (d, n) whether a state is stable in every way and of ordinary shape
    stable_loads: np.ndarray  #: (d, n) whether it is stable with the force held


def solve_together(
    group: Group,
    tolerance: float,
    watch: Callable[[int], None] = lambda done: None,
    threads: int = 1,
    left_out: float = 0.0,
) -> list[Solved]:
    """The designs of a group that batches can do, on as many unknowns as the tolerance needs.

    With several threads some batches are solved at a time; the numbers are the same. Where no more than a share
    `left_out` of the designs is not followed cleanly, no second and longer way is tried for these.
    """
    found: list[Solved] = []
    left = np.arange(len(group))
    with ThreadPoolExecutor(threads) as pool:
        close = CLOSE * math.sqrt(tolerance)
        for size in (size for size in sizes_for("spectral", tolerance) if size <= LARGEST):
            line = attrs.evolve(group.line, size=size * group.line.size)
            paths = followed(pool, group.take(left), line, close)
            if (~paths.good).sum() > left_out * len(paths.good):
                paths = finer(pool, paths, close)
            coarse = []
            for solved, where in _read(pool, paths):
                good = solved.numbers["error_estimate"].max(axis=1, initial=0.0) <= tolerance
                found.append(_some(solved, good))
                coarse.append(left[where[~good]])  # a finer space would not help those that were not followed
                watch(sum(len(one.group) for one in found))
            left = np.concatenate(coarse)
            if not len(left):
                break
    return [one for one in found if len(one.group)]


def _some(solved: Solved, which: np.ndarray) -> Solved:
    """Some of the designs."""
    where = np.flatnonzero(which)
    return Solved(
        solved.group.take(where), solved.line, solved.b[where], Unknowns(*(part[where] for part in solved.state[:2])),
        {name: values[where] for name, values in solved.numbers.items()}, solved.plain[where],
        solved.stable_loads[where],
    )  # fmt: skip


def _read(pool: ThreadPoolExecutor, paths: Paths) -> list[tuple[Solved, np.ndarray]]:
    """What the states are, by batches, of the designs that were followed cleanly; and which these are."""

    def one(some: np.ndarray) -> tuple[Solved, np.ndarray]:
        states = jax.tree.map(lambda values: paths.rows(values, some), paths.state)
        found = appraised(paths.line, paths.on(some), states, np.asarray(paths.states))
        held = np.asarray(getattr(found, paths.group.held[0]))[: paths.states, : len(some)].all(axis=0)
        good = np.flatnonzero(held & paths.good[some])
        return _arranged(paths, found, some, good), some[good]

    return list(pool.map(one, paths.parts(np.arange(len(paths.group)))))


def _arranged(paths: Paths, found: Appraised, some: np.ndarray, good: np.ndarray) -> Solved:
    """The good ones of some designs, each in the order in which its states were asked for."""
    n, where = paths.states, some[good]
    order = np.where(paths.turned[where, None], np.arange(n)[::-1], np.arange(n))

    def in_order(values: np.ndarray) -> np.ndarray:
        return np.take_along_axis(values, order.reshape(*order.shape, *(1,) * (values.ndim - 2)), axis=1)

    def by_design(rows: Any) -> np.ndarray:
        return in_order(np.moveaxis(np.asarray(rows)[:n], 0, 1)[good])

    seen = {name: by_design(values) for name, values in found.numbers.items()}
    group = paths.group.take(where)
    missed = 0.0 if found.missed is None else by_design(found.missed.under(group.held))
    if not asks_for_step(group.line, group.p):
        stretched = seen["length"] > STRETCHED * surely_reached(group.p, group.line.ends)[:, None]
        bound = error_bound(seen["conserved_variation"], seen["coefficient_tail"], stretched, missed)
    else:
        bound = unresolved_bound(missed)
    seen["error_estimate"] = bound
    loads, slope, sideways = (by_design(rows) for rows in (found.force, found.largest_slope, found.antisymmetric))
    plain = sideways & (slope < PLAIN_SLOPE) & (loads | (paths.group.held[0] == "length"))
    state = Unknowns(in_order(paths.state.u[where, :n]), in_order(paths.state.loads[where, :n]))
    return Solved(group, paths.line, paths.b[where], state, seen, plain, loads)
