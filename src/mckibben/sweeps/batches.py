"""Many muscles through one test each, in batches: the quick way of a sweep, which knows when it is not enough.

The same discretisations and point placements as for a single run, so the same numbers. A design whose path is not
followed cleanly, state by state, is left to `run`.
"""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place
from mckibben.discretise.placement import crowdings
from mckibben.discretise.spectral import Line
from mckibben.measure.many import Appraised, appraised, polished
from mckibben.measure.survey import PLAIN_SLOPE, error_bound
from mckibben.model.parameters import Parameters
from mckibben.solver.batch import march
from mckibben.solver.bench import sizes_for
from mckibben.solver.follow import padded
from mckibben.solver.held import rows_of, units
from mckibben.solver.newton import MOST, batch_size
from mckibben.solver.system import Unknowns
from mckibben.sweeps.groups import Group

__all__ = ["Solved", "solve_together"]

LARGEST = 48
"""Half-length unknowns up to which a batch goes; what needs more is solved singly."""
BETWEEN = 16
"""Parts of a step where a path is followed once more."""
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
    group: Group, tolerance: float, watch: Callable[[int], None] = lambda done: None, threads: int = 1
) -> list[Solved]:
    """The designs of a group that batches can do, on as many unknowns as the tolerance needs.

    With several threads some batches are solved at a time; the numbers are the same.
    """
    found: list[Solved] = []
    left = np.arange(len(group))
    with ThreadPoolExecutor(threads) as pool:
        close = CLOSE * math.sqrt(tolerance)
        for size in (size for size in sizes_for("spectral", tolerance) if size <= LARGEST):
            line = Line(size, group.ends)
            paths = _finer(pool, _followed(pool, group.take(left), line, close), close)
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


def _placement(group: Group) -> np.ndarray:
    """Crowding of points for each design, as a single run places them."""
    rows = _filled(group.corners, MOST)
    found = np.asarray(_crowded(_stacked(group, MOST), *np.moveaxis(rows, 2, 0)))
    return np.asarray(found.max(axis=1)[: len(group)])


@partial(kernel, static_argnums=())
def _crowded(p: Parameters, length: Any, force: Any, pressure: Any) -> Any:
    return jax.vmap(crowdings)(p, length, force, pressure)


@kernel
def _placed(basis: Line, p: Parameters, b: Any) -> Placed:
    return jax.vmap(partial(place, basis))(p, b)


def _stacked(group: Group, size: int) -> Parameters:
    """Numbers of the designs as arrays (size), the last repeated where there are fewer."""
    made: Parameters = jax.tree.map(lambda values: _filled(values, size), group.p)
    return made


def _filled(rows: np.ndarray, size: int) -> np.ndarray:
    return np.concatenate([rows, np.repeat(rows[-1:], size - len(rows), axis=0)]) if len(rows) < size else rows


@attrs.frozen
class _Paths:
    """Designs of a group on one space, each along its path: d designs, N rows of which the first n are states."""

    group: Group
    b: np.ndarray  #: (d)
    line: Line
    turned: np.ndarray  #: (d) whether the path is followed from its last state to its first
    targets: np.ndarray  #: (d, N, 2) dimensionless
    state: Unknowns  #: (d, N, m) and (d, N, 2)
    change: np.ndarray  #: (d, N) largest change of psi [rad] in the last Newton step
    good: np.ndarray  #: (d) whether every state was reached

    @property
    def states(self) -> int:
        """Number n of states."""
        return int(self.group.wanted.shape[1])

    @property
    def which(self) -> np.ndarray:
        """Which rows hold."""
        return rows_of(self.group.held, 2)[1]

    def on(self, some: np.ndarray) -> Placed:
        """Some of the designs on the space, as many as a batch takes."""
        return _on(self.group.take(some), self.b[some], self.line)

    def rows(self, values: np.ndarray, some: np.ndarray) -> np.ndarray:
        """Rows (d, N, ...) of some of the designs, as (N, batch, ...)."""
        return np.moveaxis(_filled(values[some], batch_size(self.line.unknowns)), 0, 1)

    def parts(self, some: np.ndarray) -> list[np.ndarray]:
        """Designs in parts, each a batch."""
        size = batch_size(self.line.unknowns)
        return [some[at : at + size] for at in range(0, len(some), size)]


def _on(group: Group, b: np.ndarray, line: Line) -> Placed:
    size = batch_size(line.unknowns)
    placed: Placed = _placed(line, _stacked(group, size), _filled(b, size))
    return placed


def _followed(pool: ThreadPoolExecutor, group: Group, line: Line, close: float) -> _Paths:
    """The designs along their paths, from rest, each state to a last Newton step that is `close`."""
    (count, n), m, size = group.wanted.shape[:2], line.unknowns, batch_size(line.unknowns)
    # pressure stretches the fibres: the path is followed from its end of higher pressure
    turned = np.abs(group.wanted[:, -1, 1]) > np.abs(group.wanted[:, 0, 1])
    wanted = np.where(turned[:, None, None], group.wanted[:, ::-1], group.wanted)
    targets = np.moveaxis(padded(np.moveaxis(wanted, 1, 0)), 0, 1)  # few lengths are compiled
    rows = targets.shape[1]
    blank = Unknowns(np.zeros((count, rows, m)), np.zeros((count, rows, 2)))
    paths = _Paths(group, np.zeros(count), line, turned, targets, blank, np.zeros((count, rows)), np.zeros(count, bool))
    rest = np.tile([1.0 if group.held[0] == "length" else 0.0, 0.0], (size, 1))

    def one(some: np.ndarray) -> None:
        paths.b[some] = _placement(group.take(some))
        on = paths.on(some)
        sizes = units(np.asarray(on.unit).T)
        scaled = _filled(targets[some], size) / np.stack([sizes[name] for name in group.held], axis=1)[:, None]
        path = march(line, on, paths.which, rest, scaled, np.asarray(n))
        targets[some] = scaled[: len(some)]
        _put(paths.state, some, path.rows.state)
        paths.change[some] = np.asarray(path.rows.change)[: len(some)]
        paths.good[some] = (np.asarray(path.reached) & np.asarray(path.rows.good)[:, :n].all(axis=1))[: len(some)]

    list(pool.map(one, paths.parts(np.arange(count))))
    return _closer(pool, paths, close)


def _finer(pool: ThreadPoolExecutor, paths: _Paths, close: float) -> _Paths:
    """Those that were not followed, once more with states in between, which are then left out."""
    lost = np.flatnonzero(~paths.good)
    n = paths.states
    if not len(lost) or n == 1:
        return paths
    wanted, share = paths.group.wanted[lost], np.arange(BETWEEN) / BETWEEN
    begin, end = wanted[:, :-1, None], wanted[:, 1:, None]
    steps = (begin + (end - begin) * share[:, None]).reshape(len(lost), -1, 2)
    dense = attrs.evolve(paths.group.take(lost), wanted=np.concatenate([steps, wanted[:, -1:]], axis=1))
    again = _followed(pool, dense, paths.line, close)
    rows = slice(0, BETWEEN * (n - 1) + 1, BETWEEN)
    for mine, other in (
        (paths.state.u, again.state.u),
        (paths.state.loads, again.state.loads),
        (paths.change, again.change),
    ):
        mine[lost, :n] = other[:, rows]
    paths.b[lost], paths.good[lost] = again.b, again.good
    return paths


def _put(state: Unknowns, some: np.ndarray, rows: Unknowns) -> None:
    """States of a batch (batch, N, ...) into those of all designs."""
    state.u[some], state.loads[some] = (np.asarray(part)[: len(some)] for part in rows[:2])


def _closer(pool: ThreadPoolExecutor, paths: _Paths, close: float) -> _Paths:
    """Those whose last Newton step was too large polished, together; they alone, since a batch is as slow as one."""
    n = paths.states
    loose = np.flatnonzero(paths.good & (paths.change[:, :n].max(axis=1) > close))

    def one(some: np.ndarray) -> None:
        states, change, targets = (
            jax.tree.map(lambda values: paths.rows(values, some), part)
            for part in (paths.state, paths.change, paths.targets)
        )
        good = np.ones(len(change[0]), bool)
        on = paths.on(some)
        done = polished(paths.line, on, states, change, paths.which, targets, np.asarray(n), np.asarray(close), good)
        _put(paths.state, some, jax.tree.map(lambda rows: np.moveaxis(np.asarray(rows), 0, 1), done.states))
        paths.change[some] = np.moveaxis(np.asarray(done.change), 0, 1)[: len(some)]

    list(pool.map(one, paths.parts(loose)))
    finite = np.isfinite(paths.state.u[:, :n]).all(axis=(1, 2))
    return attrs.evolve(paths, good=paths.good & (paths.change[:, :n] <= close).all(axis=1) & finite)


def _read(pool: ThreadPoolExecutor, paths: _Paths) -> list[tuple[Solved, np.ndarray]]:
    """What the states are, by batches, of the designs that were followed cleanly; and which these are."""

    def one(some: np.ndarray) -> tuple[Solved, np.ndarray]:
        states = jax.tree.map(lambda values: paths.rows(values, some), paths.state)
        found = appraised(paths.line, paths.on(some), states, np.asarray(paths.states))
        held = np.asarray(getattr(found, paths.group.held[0]))[: paths.states, : len(some)].all(axis=0)
        good = np.flatnonzero(held & paths.good[some])
        return _arranged(paths, found, some, good), some[good]

    return list(pool.map(one, paths.parts(np.arange(len(paths.group)))))


def _arranged(paths: _Paths, found: Appraised, some: np.ndarray, good: np.ndarray) -> Solved:
    """The good ones of some designs, each in the order in which its states were asked for."""
    n, where = paths.states, some[good]
    order = np.where(paths.turned[where, None], np.arange(n)[::-1], np.arange(n))

    def in_order(values: np.ndarray) -> np.ndarray:
        return np.take_along_axis(values, order.reshape(*order.shape, *(1,) * (values.ndim - 2)), axis=1)

    def by_design(rows: Any) -> np.ndarray:
        return in_order(np.moveaxis(np.asarray(rows)[:n], 0, 1)[good])

    seen = {name: by_design(values) for name, values in found.numbers.items()}
    seen["error_estimate"] = error_bound(seen["conserved_variation"], seen["coefficient_tail"])
    loads, slope, sideways = (by_design(rows) for rows in (found.force, found.largest_slope, found.antisymmetric))
    plain = sideways & (slope < PLAIN_SLOPE) & (loads | (paths.group.held[0] == "length"))
    state = Unknowns(in_order(paths.state.u[where, :n]), in_order(paths.state.loads[where, :n]))
    return Solved(paths.group.take(where), paths.line, paths.b[where], state, seen, plain, loads)
