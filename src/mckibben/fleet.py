"""Many muscles through one test each, in batches: the quick way of a sweep, which knows when it is not enough.

The same discretisations and point placements as `experiment.run`, so the same numbers. A design whose path is not
followed cleanly, state by state, is left to `run`.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import groupby
from typing import Any, TypeVar

import attrs
import numpy as np

from .appraise import appraised
from .discretise.line import Line
from .experiment import corners, sizes_for
from .kernel import jitted
from .lazy import jax, jnp
from .model.chamber import law_of
from .model.parameters import Law, Parameters, numbers
from .recover import ENERGIES
from .solver.equilibrium import NAMES, selection
from .solver.follow import padded
from .solver.lockstep import MOST, Design, batch_size, design
from .solver.march import march
from .solver.placement import crowdings
from .solver.problem import LENGTH, VOLUME
from .spec import Along, Ends, Muscle, Test
from .survey import error_of

T = TypeVar("T")

LARGEST = 48
"""Half-length unknowns up to which a batch goes; what needs more is solved singly."""
POLISH = 3
"""Newton steps for all states at once, at most."""
PLAIN_SLOPE = 1.5
"""Slope [rad] of the meridian below which no shape is anything but ordinary."""
NEAR_EXTENSION = 0.98
"""Fraction of the longest possible length from which on a design is solved singly."""


@attrs.frozen
class Ask:
    """One design that a batch can take: its numbers and what is held in each state."""

    p: Parameters  #: floats
    law: Law
    ends: str
    held: tuple[str, str]
    wanted: np.ndarray  #: (n, 2) in SI units
    corners: list[tuple[float, float, float]]  #: for the placement of points

    @property
    def kind(self) -> tuple[Any, ...]:
        """What a batch must have in common."""
        return self.law, self.ends, self.held, len(self.wanted), len(self.corners)


@attrs.frozen
class Curve:
    """One design as solved in a batch, n states in SI units."""

    line: Line
    b: float
    held: tuple[str, str]
    w: np.ndarray  #: (n, unknowns + 2) dimensionless
    numbers: dict[str, np.ndarray]  #: (n), by the names of a result's variables
    plain: np.ndarray  #: (n) whether a state is stable in every way and of ordinary shape
    stable_loads: np.ndarray  #: (n) whether it is stable with the force held


def ask(muscle: Muscle, test: Test) -> Ask | None:
    """The design as a batch takes it; None where only `run` will do (several steps, gas, branches, volumes)."""
    steps = test.as_steps(muscle)
    step, p = steps[0], numbers(muscle)
    held = tuple(str(name) for name in step.controls)
    if len(steps) > 1 or step.gas is not None or step.along != Along.VALUES or held[1:] != ("pressure",):
        return None
    if muscle.ends == Ends.FREE and held[0] == "force":  # nearly singular: Newton without a search does not settle
        return None
    shortest = _surely_reached(p, str(muscle.ends))
    present = dict(zip(NAMES, (p.H0, np.nan, 0.0, 0.0), strict=True))
    wanted = np.stack([getattr(step, name).sample(step.points, present[name]) for name in held], axis=1)
    if held[0] == "length" and wanted[:, 0].max() > NEAR_EXTENSION * shortest:
        return None
    return Ask(p, law_of(muscle), str(muscle.ends), (held[0], held[1]), wanted, corners(step, p.H0, np.inf))


def _surely_reached(p: Parameters, ends: str) -> float:
    """A length [m] below full extension (theory page): that of a long muscle less what its two ends take."""
    fibre = p.H0 / np.sin(p.theta0)
    if ends == Ends.FREE:
        return float(fibre)
    return float(max(fibre - 2.0 * p.R0 / np.cos(p.theta0) * (1.0 - np.sin(p.theta0)), p.H0))


def solve_together(
    asks: Sequence[Ask | None], tolerance: float, watch: Callable[[int], None] = lambda done: None, threads: int = 1
) -> list[Curve | None]:
    """A curve for each design, or None where only the single solver will do.

    With several threads some batches are solved at a time; the numbers are the same.
    """
    found: list[Curve | None] = [None] * len(asks)
    known = [(k, one) for k, one in enumerate(asks) if one is not None]
    known.sort(key=lambda pair: (repr(pair[1].kind[1:]), id(pair[1].law), pair[0]))
    for _, group in groupby(known, key=lambda pair: pair[1].kind):
        pairs = list(group)
        for (k, _), curve in zip(pairs, _alike([one for _, one in pairs], tolerance, watch, threads), strict=True):
            found[k] = curve
    return found


def _alike(asks: list[Ask], tolerance: float, watch: Callable[[int], None], threads: int) -> list[Curve | None]:
    """Designs of one kind, on as many unknowns as the tolerance needs."""
    found: list[Curve | None] = [None] * len(asks)
    b = np.concatenate([_placement(some) for some in _split(asks, MOST)])
    left, sizes = list(range(len(asks))), [size for size in sizes_for("spectral", tolerance) if size <= LARGEST]
    for size in sizes:
        line = Line(size, asks[0].ends)
        curves: list[Curve | None] = []
        with ThreadPoolExecutor(threads) as pool:
            batches = _split(left, batch_size(line.unknowns))
            tasks = [pool.submit(_on, [asks[k] for k in some], b[some], line, tolerance) for some in batches]
            for task in tasks:
                curves += task.result()
                watch(len(curves))
        coarse = []
        for k, curve in zip(left, curves, strict=True):
            if curve is None:
                continue  # a finer space would not help
            found[k] = curve if curve.numbers["error_estimate"].max() <= tolerance else None
            if found[k] is None:
                coarse.append(k)
        left = coarse
        if not left:
            break
    return found


def _placement(asks: list[Ask]) -> np.ndarray:
    """Crowding of points for each design, as `run` places them."""
    rows = _filled(np.array([one.corners for one in asks]), MOST)  # (designs, corners, 3)
    found = np.asarray(_crowded(asks[0].law, _stack(asks, MOST), *np.moveaxis(rows, 2, 0)))
    return np.asarray(found.max(axis=1)[: len(asks)])


@partial(jitted, static_argnums=0)
def _crowded(law: Law, p: Parameters, length: Any, force: Any, pressure: Any) -> Any:
    return jax.vmap(lambda *one: crowdings(law, *one))(p, length, force, pressure)


@partial(jitted, static_argnums=(0, 1))
def _designs(line: Line, law: Law, p: Parameters, b: Any) -> Design:
    return jax.vmap(partial(design, line, law))(p, b)


def _split(items: list[T], size: int) -> list[list[T]]:
    return [items[at : at + size] for at in range(0, len(items), size)]


def _stack(asks: list[Ask], size: int) -> Parameters:
    """Numbers of the designs as arrays (size), the last repeated where there are fewer."""
    return jax.tree.map(lambda *each: _filled(np.array(each, float), size), *(one.p for one in asks))


def _filled(rows: np.ndarray, size: int) -> np.ndarray:
    return np.concatenate([rows, np.repeat(rows[-1:], size - len(rows), axis=0)]) if len(rows) < size else rows


def _on(asks: list[Ask], b: np.ndarray, line: Line, tolerance: float) -> list[Curve | None]:
    """The designs on one space; None for one that was not followed cleanly."""
    law, held, n = asks[0].law, asks[0].held, len(asks[0].wanted)
    size = batch_size(line.unknowns)
    b = _filled(b, size)
    d = _designs(line, law, _stack(asks, size), b)
    unit = np.asarray(d.unit)
    scales = (unit[:, LENGTH], unit[:, VOLUME], unit[:, 0] / unit[:, LENGTH], unit[:, 0] / unit[:, VOLUME])
    scale = np.stack([scales[NAMES.index(name)] for name in held], axis=1)
    targets = _filled(np.stack([one.wanted for one in asks]), size) / scale[:, None]
    # pressure stretches the fibres: the path is followed from its end of higher pressure
    turned = np.abs(targets[:, -1, 1]) > np.abs(targets[:, 0, 1])
    targets = np.where(turned[:, None, None], targets[:, ::-1], targets)
    rest = np.tile([1.0 if held[0] == "length" else 0.0, 0.0], (size, 1))
    select = selection(held)
    targets, count = np.moveaxis(padded(np.moveaxis(targets, 1, 0)), 0, 1), np.asarray(n)  # few lengths are compiled
    path = march(line, law, d, select, rest, targets, count)
    good = np.asarray(path.reached) & np.asarray(path.rows.good)[:, :n].all(axis=1)
    w, close = path.rows.w, 1e-2 * np.sqrt(tolerance)
    for _ in range(POLISH):
        found = appraised(line, law, d, b, w, select, targets, count)
        w = jnp.moveaxis(found.w, 0, 1)
        seen = jax.tree.map(lambda leaf: np.asarray(leaf)[:n], found)
        settled = (seen.change <= close).all(axis=0)
        if settled[good].all():
            break
    good &= settled & seen.held.all(axis=0) & np.isfinite(seen.w).all(axis=(0, 2))
    order = [slice(None, None, -1) if back else slice(None) for back in turned]
    return [_curve(asks[k], line, float(b[k]), seen, k, order[k]) if good[k] else None for k in range(len(asks))]


def _curve(one: Ask, line: Line, b: float, seen: Any, k: int, order: slice) -> Curve:
    fields = {name: values[order, k] for name, values in seen.fields.items()}
    energies = fields.pop("energies")
    slope = fields.pop("largest_slope")
    found = fields | {f"energy_{name}": energies[:, i] for i, name in enumerate(ENERGIES)}
    found |= {
        "energy": energies.sum(axis=1), "contraction": 1.0 - fields["length"] / one.p.H0,
        "residual": seen.residual[order, k],
        "error_estimate": error_of(fields["conserved_variation"], fields["coefficient_tail"]),
    }  # fmt: skip
    loads = seen.loads[order, k]
    plain = seen.antisymmetric[order, k] & (slope < PLAIN_SLOPE) & (loads | (one.held[0] == "length"))
    return Curve(line, b, one.held, seen.w[order, k], found, plain, loads)
