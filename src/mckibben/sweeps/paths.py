"""The designs of a group along their paths, in batches: from rest to a first state, and on from state to state."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import attrs
import jax
import numpy as np

from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place
from mckibben.discretise.placement import crowdings, crowdings_at
from mckibben.discretise.spectral import Line
from mckibben.measure.many import polished
from mckibben.model.parameters import Parameters
from mckibben.solver.batch import march
from mckibben.solver.follow import padded
from mckibben.solver.held import rows_of, units
from mckibben.solver.newton import MOST, batch_size
from mckibben.solver.system import Unknowns
from mckibben.sweeps.groups import Group

__all__ = ["Paths", "finer", "followed", "on_line"]

BETWEEN = 16
"""Parts of a step where a path is followed once more."""
LOW = 0.25
"""Share of its higher pressure below which the lower one of a step counts as low: near it, the parts are shorter."""
SYSTEMS, PATIENT = 40, 200
"""Systems solved at most on the way to the first state: at first, and once more."""


@attrs.frozen
class Paths:
    """Designs of a group on one space, each along its path: d designs, N rows of which the first n are states."""

    group: Group
    b: np.ndarray  #: (d)
    line: Line
    turned: np.ndarray  #: (d) whether the path is followed from its last state to its first
    targets: np.ndarray  #: (d, N, l) dimensionless
    state: Unknowns  #: (d, N, m) and (d, N, l)
    change: np.ndarray  #: (d, N) largest change of psi [rad] in the last Newton step
    good: np.ndarray  #: (d) whether every state was reached

    @property
    def states(self) -> int:
        """Number n of states."""
        return int(self.group.wanted.shape[1])

    @property
    def which(self) -> np.ndarray:
        """Which rows hold."""
        return rows_of(self.group.held, self.loads)[1]

    @property
    def loads(self) -> int:
        """How many loads are unknowns."""
        return 3 if self.line.closes else 2

    def on(self, some: np.ndarray) -> Placed:
        """Some of the designs on the space, as many as a batch takes."""
        return on_line(self.group.take(some), self.b[some], self.line)

    def rows(self, values: np.ndarray, some: np.ndarray) -> np.ndarray:
        """Rows (d, N, ...) of some of the designs, as (N, batch, ...)."""
        return np.moveaxis(_filled(values[some], batch_size(self.line.unknowns)), 0, 1)

    def parts(self, some: np.ndarray) -> list[np.ndarray]:
        """Designs in parts, each a batch."""
        size = batch_size(self.line.unknowns)
        return [some[at : at + size] for at in range(0, len(some), size)]


def followed(pool: ThreadPoolExecutor, group: Group, line: Line, close: float, limit: int = SYSTEMS) -> Paths:
    """The designs along their paths, from rest, each state to a last Newton step that is `close`."""
    (count, n), m, size = group.wanted.shape[:2], line.unknowns, batch_size(line.unknowns)
    # pressure stretches the fibres: the path is followed from its end of higher pressure
    turned = np.abs(group.wanted[:, -1, 1]) > np.abs(group.wanted[:, 0, 1])
    wanted = np.where(turned[:, None, None], group.wanted[:, ::-1], group.wanted)
    targets = np.moveaxis(padded(np.moveaxis(wanted, 1, 0)), 0, 1)  # few lengths are compiled
    rows, names = targets.shape[1], (*group.held, *(["closure"] if line.closes else []))
    targets = np.concatenate([targets, np.zeros((count, rows, len(names) - 2))], axis=2)
    blank = Unknowns(np.zeros((count, rows, m)), np.zeros((count, rows, len(names))))
    paths = Paths(group, np.zeros(count), line, turned, targets, blank, np.zeros((count, rows)), np.zeros(count, bool))
    rest = np.tile([1.0 if group.held[0] == "length" else 0.0, *[0.0] * (len(names) - 1)], (size, 1))

    def one(some: np.ndarray) -> None:
        paths.b[some] = _placement(group.take(some))
        on = paths.on(some)
        sizes = units(np.asarray(on.unit).T)
        scaled = _filled(targets[some], size) / np.stack([sizes[name] for name in names], axis=1)[:, None]
        path = march(line, on, paths.which, rest, scaled, np.asarray(n), np.asarray(limit))
        targets[some] = scaled[: len(some)]
        _put(paths.state, some, path.rows.state)
        paths.change[some] = np.asarray(path.rows.change)[: len(some)]
        paths.good[some] = (np.asarray(path.reached) & np.asarray(path.rows.good)[:, :n].all(axis=1))[: len(some)]

    list(pool.map(one, paths.parts(np.arange(count))))
    return _closer(pool, paths, close)


def finer(pool: ThreadPoolExecutor, paths: Paths, close: float) -> Paths:
    """Those that were not followed, once more with states in between, which are then left out."""
    lost = np.flatnonzero(~paths.good)
    n = paths.states
    if not len(lost) or n == 1:
        return paths
    wanted = paths.group.wanted[lost]
    begin, end = wanted[:, :-1, None], wanted[:, 1:, None]
    steps = (begin + (end - begin) * _shares(begin[..., 1:], end[..., 1:])).reshape(len(lost), -1, 2)
    dense = attrs.evolve(paths.group.take(lost), wanted=np.concatenate([steps, wanted[:, -1:]], axis=1))
    again = followed(pool, dense, paths.line, close, PATIENT)
    rows = slice(0, BETWEEN * (n - 1) + 1, BETWEEN)
    for mine, other in (
        (paths.state.u, again.state.u),
        (paths.state.loads, again.state.loads),
        (paths.change, again.change),
    ):
        mine[lost, :n] = other[:, rows]
    paths.b[lost], paths.good[lost] = again.b, again.good
    return paths


def _shares(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Where the parts of steps between two pressures (..., 1, 1) begin (..., BETWEEN, 1), over the steps.

    A soft muscle without much pressure changes most, so the parts become shorter towards a low one.
    """
    even = np.arange(BETWEEN)[:, None] / BETWEEN
    up, down = np.abs(begin) < LOW * np.abs(end), np.abs(end) < LOW * np.abs(begin)
    return np.where(up, even**2, np.where(down, 1.0 - (1.0 - even) ** 2, even))


def _closer(pool: ThreadPoolExecutor, paths: Paths, close: float) -> Paths:
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


def _put(state: Unknowns, some: np.ndarray, rows: Unknowns) -> None:
    """States of a batch (batch, N, ...) into those of all designs."""
    state.u[some], state.loads[some] = (np.asarray(part)[: len(some)] for part in rows[:2])


def on_line(group: Group, b: np.ndarray, line: Line) -> Placed:
    """Designs on a space, as many as a batch takes; the last is repeated where there are fewer."""
    size = batch_size(line.unknowns)
    placed: Placed = _placed(line, _stacked(group, size), _filled(b, size))
    return placed


def _placement(group: Group) -> np.ndarray:
    """Crowding of points for each design, as a single run places them."""
    rows = _filled(group.corners, MOST)
    length, force, pressure = np.moveaxis(rows, 2, 0)
    p, held = _stacked(group, MOST), group.held[0] == "length"
    found = np.asarray(_crowded_at(p, length, pressure) if held else _crowded(p, length, force, pressure))
    return np.asarray(found.max(axis=1)[: len(group)])


@partial(kernel, static_argnums=())
def _crowded(p: Parameters, length: Any, force: Any, pressure: Any) -> Any:
    return jax.vmap(crowdings)(p, length, force, pressure)


@partial(kernel, static_argnums=())
def _crowded_at(p: Parameters, length: Any, pressure: Any) -> Any:
    return jax.vmap(crowdings_at)(p, length, pressure)


@kernel
def _placed(basis: Line, p: Parameters, b: Any) -> Placed:
    return jax.vmap(partial(place, basis))(p, b)


def _stacked(group: Group, size: int) -> Parameters:
    """Numbers of the designs as arrays (size), the last repeated where there are fewer."""
    made: Parameters = jax.tree.map(lambda values: _filled(values, size), group.p)
    return made


def _filled(rows: np.ndarray, size: int) -> np.ndarray:
    return np.concatenate([rows, np.repeat(rows[-1:], size - len(rows), axis=0)]) if len(rows) < size else rows
