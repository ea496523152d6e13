"""Many muscles through one test each, in batches: the quick way of a sweep, which knows when it is not enough.

The same discretisations and point placements as for a single run, so the same numbers. A design whose path is not
followed cleanly, state by state, is left to `run`.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import attrs
import jax
import jax.numpy as jnp
import numpy as np

from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place
from mckibben.discretise.placement import crowdings
from mckibben.discretise.spectral import Line
from mckibben.measure.many import appraised, polished
from mckibben.measure.survey import PLAIN_SLOPE, error_of
from mckibben.model.parameters import Parameters
from mckibben.solver.batch import march
from mckibben.solver.bench import sizes_for
from mckibben.solver.follow import padded
from mckibben.solver.held import rows_of, units
from mckibben.solver.newton import MOST, batch_size
from mckibben.solver.system import State
from mckibben.sweeps.groups import Group

__all__ = ["Solved", "solve"]

LARGEST = 48
"""Half-length unknowns up to which a batch goes; what needs more is solved singly."""
CLOSE = 1e-3
"""Last Newton step [rad] of every state over the square root of the tolerance: the error left is about its square."""


@attrs.frozen
class Solved:
    """Designs of a group that were followed cleanly on one discretisation; d designs, n states, SI units."""

    group: Group
    line: Line
    b: np.ndarray  #: (d) crowding of points
    state: State  #: (d, n, m) and (d, n, 2), dimensionless
    numbers: dict[str, np.ndarray]  #: (d, n), by the names of a sweep's variables
    plain: np.ndarray  #: (d, n) whether a state is stable in every way and of ordinary shape
    stable_loads: np.ndarray  #: (d, n) whether it is stable with the force held


def solve(
    group: Group, tolerance: float, watch: Callable[[int], None] = lambda done: None, threads: int = 1
) -> list[Solved]:
    """The designs of a group that batches can do, on as many unknowns as the tolerance needs.

    With several threads some batches are solved at a time; the numbers are the same.
    """
    found: list[Solved] = []
    b = np.concatenate([_placement(part) for part in _split(group, MOST)])
    left = np.arange(len(group))
    for size in (size for size in sizes_for("spectral", tolerance) if size <= LARGEST):
        line = Line(size, group.ends)
        batch = batch_size(line.unknowns)
        with ThreadPoolExecutor(threads) as pool:
            parts = [left[at : at + batch] for at in range(0, len(left), batch)]
            tasks = [pool.submit(_on, group.take(part), b[part], line, tolerance) for part in parts]
            coarse = []
            for part, task in zip(parts, tasks, strict=True):
                solved, where = task.result()
                good = solved.numbers["error_estimate"].max(axis=1, initial=0.0) <= tolerance
                found.append(_some(solved, good))
                coarse.append(part[where[~good]])  # a finer space would not help those that were not followed
                watch(sum(len(one.group) for one in found))
        left = np.concatenate(coarse)
        if not len(left):
            break
    return [one for one in found if len(one.group)]


def _some(solved: Solved, which: np.ndarray) -> Solved:
    """Some of the designs."""
    where = np.flatnonzero(which)
    return Solved(
        solved.group.take(where), solved.line, solved.b[where], State(*(part[where] for part in solved.state[:2])),
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


def _split(group: Group, size: int) -> list[Group]:
    places = np.arange(len(group))
    return [group.take(places[at : at + size]) for at in range(0, len(group), size)]


def _stacked(group: Group, size: int) -> Parameters:
    """Numbers of the designs as arrays (size), the last repeated where there are fewer."""
    made: Parameters = jax.tree.map(lambda values: _filled(values, size), group.p)
    return made


def _filled(rows: np.ndarray, size: int) -> np.ndarray:
    return np.concatenate([rows, np.repeat(rows[-1:], size - len(rows), axis=0)]) if len(rows) < size else rows


def _on(group: Group, b: np.ndarray, line: Line, tolerance: float) -> tuple[Solved, np.ndarray]:
    """The designs on one space that were followed cleanly, and which of the group's they are."""
    held, (count, n) = group.held, group.wanted.shape[:2]
    size = batch_size(line.unknowns)
    on = _placed(line, _stacked(group, size), _filled(b, size))
    sizes = units(np.asarray(on.unit).T)
    scale = np.stack([sizes[name] for name in held], axis=1)
    targets = _filled(group.wanted, size) / scale[:, None]
    # pressure stretches the fibres: the path is followed from its end of higher pressure
    turned = np.abs(targets[:, -1, 1]) > np.abs(targets[:, 0, 1])
    targets = np.where(turned[:, None, None], targets[:, ::-1], targets)
    rest = np.tile([1.0 if held[0] == "length" else 0.0, 0.0], (size, 1))
    which = rows_of(held, 2)[1]
    targets = np.moveaxis(padded(np.moveaxis(targets, 1, 0)), 0, 1)  # few lengths are compiled
    steps = np.asarray(n)
    path = march(line, on, which, rest, targets, steps)
    good = np.asarray(path.reached) & np.asarray(path.rows.good)[:, :n].all(axis=1)
    close, by_state = CLOSE * np.sqrt(tolerance), partial(jnp.moveaxis, source=0, destination=1)
    states, targets = jax.tree.map(by_state, path.rows.state), by_state(targets)
    done = polished(line, on, states, by_state(path.rows.change), which, targets, steps, np.asarray(close), good)
    found = appraised(line, on, done.states, steps)
    good &= (np.asarray(done.change)[:n] <= close).all(axis=0) & np.asarray(getattr(found, held[0]))[:n].all(axis=0)
    good &= np.isfinite(np.asarray(done.states.u)[:n]).all(axis=(0, 2))
    where = np.flatnonzero(good[:count])
    return _read(group, b, line, found, done.states, turned, where), where


def _read(
    group: Group, b: np.ndarray, line: Line, found: Any, states: State, turned: np.ndarray, where: np.ndarray
) -> Solved:
    """Some of the designs of a batch, each in the order in which its states were asked for."""
    n = group.wanted.shape[1]
    order = np.where(turned[where, None], np.arange(n)[::-1], np.arange(n))

    def sorted_rows(rows: Any) -> np.ndarray:
        values = np.moveaxis(np.asarray(rows)[:n], 0, 1)[where]
        at = order.reshape(*order.shape, *(1,) * (values.ndim - 2))
        return np.take_along_axis(values, at, axis=1)

    seen = {name: sorted_rows(values) for name, values in found.numbers.items()}
    seen["error_estimate"] = error_of(seen["conserved_variation"], seen["coefficient_tail"])
    loads, slope, sideways = (sorted_rows(rows) for rows in (found.force, found.largest_slope, found.antisymmetric))
    plain = sideways & (slope < PLAIN_SLOPE) & (loads | (group.held[0] == "length"))
    state = State(sorted_rows(states.u), sorted_rows(states.loads))
    return Solved(group.take(where), line, b[where], state, seen, plain, loads)
