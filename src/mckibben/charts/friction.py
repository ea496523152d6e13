"""Friction on a map: its sliding branches and the stiffness of sticking crossings, of states solved over the range."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np
from numpy.polynomial import chebyshev

from mckibben.experiments.answer import answer
from mckibben.experiments.sliding import sliding_forces, sticking
from mckibben.potential.chart import Chart
from mckibben.potential.evaluate import across
from mckibben.potential.rubbing import Rubs, rubbing, variables_of
from mckibben.solver.bench import Bench
from mckibben.solver.held import Held
from mckibben.spec import Muscle, SpecError
from mckibben.spec.declared import evolved
from mckibben.spec.text import to_toml
from mckibben.units import show

__all__ = ["check_map", "with_friction"]

STATES = (13, 9)
"""Lengths and pressures of the states of which the series are made."""
TERMS = (10, 7)
"""Terms in length and in q."""
CHECKS = 6
"""Lengths, and as many pressures, of the states by which the error is measured."""
STATE = 1e-6
"""Tolerance of the states."""
LOST = 0.2
"""Share of states at which not all crossings need to slip."""


@attrs.frozen
class _Branches:
    """Points at which all crossings slip, and what the force is there, SI."""

    length: np.ndarray
    pressure: np.ndarray
    low: np.ndarray  #: as the muscle shortens
    high: np.ndarray  #: as it lengthens
    sticking: np.ndarray


def check_map(muscle: Muscle) -> None:
    """SpecError for friction that a map does not know."""
    if muscle.friction is not None and muscle.friction.chamber_coefficient is not None:
        said = "does not go with a map, whose rule of friction knows the crossings alone"
        advice = 'leave it out for the map: muscle.replace("friction.chamber_coefficient", None)'
        raise SpecError("friction.chamber_coefficient", muscle.friction.chamber_coefficient, said, advice)


def with_friction(muscle: Muscle, plain: Chart, watch: Callable[[int, int], None]) -> Chart:
    """The map of a muscle whose crossings rub, from that of the same muscle without friction.

    SpecError where friction is so large that states in which all crossings slip are not found.
    """
    total, done = STATES[0] * STATES[1] + CHECKS**2, 0

    def tell() -> None:
        nonlocal done
        done += 1
        watch(done, total)

    made, checks = (_seen(muscle, *_points(plain, *places), tell) for places in (_nodes(), _others()))
    rubs = _fitted(plain, made)
    found = rubbing(rubs, plain.table, checks.length, checks.pressure)
    middle = plain.force(checks.length, checks.pressure)
    off = np.maximum(np.abs(middle + found.friction - checks.high), np.abs(middle - found.friction - checks.low))
    half = 0.5 * (np.concatenate([made.high, checks.high]) - np.concatenate([made.low, checks.low]))
    error = float(off.max())
    said = f"friction at the crossings: up to {show(float(half.max()), 'N', 3)} to either side, branches good to "
    notes = [*plain.notes, f"{said}{show(error, 'N', 2)}; force and its slopes are those between, without friction"]
    about = plain.data.attrs | {
        "muscle": to_toml(muscle, allow_custom=True), "assumed": ", ".join(muscle.assumed), "notes": "\n".join(notes),
        "friction_error": error, "largest_friction": float(half.max()),
        "sticking_error": float(np.abs(found.sticking / checks.sticking - 1.0).max()),
    }  # fmt: skip
    seen = {f"check_branch_{name}": ("check_branch", getattr(checks, kept), {"units": unit})
            for name, kept, unit in (("length", "length", "m"), ("pressure", "pressure", "Pa"),
                                     ("shortening", "low", "N"), ("lengthening", "high", "N"))}  # fmt: skip
    data = plain.data.assign(variables_of(rubs) | seen)
    data.attrs = about
    return Chart(muscle, data)


def _nodes() -> tuple[np.ndarray, np.ndarray]:
    """Places from 0 to 1 along the lengths and from -1 to 1 on the axis of q, which crowd at the ends."""
    n, m = (np.cos(np.pi * np.arange(k) / (k - 1)) for k in STATES)
    return 0.5 - 0.5 * n, m


def _others() -> tuple[np.ndarray, np.ndarray]:
    """Others, even, both ends of each among them."""
    return np.linspace(0.0, 1.0, CHECKS), np.linspace(-1.0, 1.0, CHECKS)


def _points(plain: Chart, shares: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lengths and pressures of all pairs of places."""
    table = plain.table
    P = np.clip((table.q[0] + table.q[1] * y) ** 2 - table.soft + table.first, table.first, table.last)
    low, high = (np.broadcast_to(one, P.shape) for one in plain.lengths(P))
    lengths = low[:, None] + shares * (high - low)[:, None]
    return lengths.ravel(), np.repeat(P, len(shares))


def _seen(muscle: Muscle, lengths: np.ndarray, pressures: np.ndarray, tell: Callable[[], None]) -> _Branches:
    """What the muscle does at points."""
    free, rubs = Bench.of(evolved(muscle, friction=None)), Bench.of(muscle)
    rows, lost = [], 0
    for h, P in zip(lengths.tolist(), pressures.tolist(), strict=True):
        given = answer(free, Held.of(length=h, pressure=P), STATE).given
        forces = None if given is None else sliding_forces(rubs, given.state)
        stiffness = None if given is None or forces is None else sticking(rubs, given.state)
        if given is not None and forces is not None and stiffness is not None:
            rows.append((h, P, *forces, stiffness))
        else:
            lost += 1
        if lost > LOST * len(lengths):
            said = (
                f"is too much for a map: more than {100 * LOST:g} % of the states are none in which all crossings slip"
            )
            raise SpecError("friction", allowed=said, advice="use run(), a smaller range, or less friction")
        tell()
    return _Branches(*np.array(rows).T)


def _fitted(plain: Chart, seen: _Branches) -> Rubs:
    """Both series by least squares, each over its values."""
    table = plain.table
    x = (seen.length - table.length[0]) / table.length[1]
    X, Y = (chebyshev.chebvander(at, k - 1) for at, k in zip((x, across(table, seen.pressure)), TERMS, strict=True))
    rows = (X[:, :, None] * Y[:, None, :]).reshape(len(x), -1)
    found = [np.linalg.lstsq(rows / values.mean(), values / values.mean(), None)[0].reshape(TERMS)
             for values in (np.maximum(0.5 * (seen.high - seen.low), 1e-12), seen.sticking)]  # fmt: skip
    return Rubs(*found)
