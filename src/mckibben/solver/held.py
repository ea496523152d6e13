"""What is held: rows g(h, V, F, P, M; t) = 0 that close the equations of equilibrium.

A row is a function of what a state reads and of a target t. Lengths, forces, volumes and pressures are rows, and so is
the gas sealed in; a spring in series or a ratio is one more function. There are as many rows as loads.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import attrs
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Placed
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.system import System
from mckibben.spec.constants import ATMOSPHERE, HEAT_RATIO

__all__ = ["GASES", "NAMES", "Conditions", "Held", "Now", "conditions", "read_rows"]

NAMES = ("length", "volume", "force", "pressure")
"""What a lab can hold by itself: two of these at a time."""


class Now(NamedTuple):
    """What a state reads, in SI units: what loads do work on, and the loads."""

    length: Number  #: distance between the fittings [m]
    volume: Number  #: inside the braid [m^3]
    force: Number  #: axial [N], positive in tension
    pressure: Number  #: gauge [Pa]
    closure: Number = 0.0  #: theta at the last end less that at the first [rad]
    moment: Number = 0.0  #: its multiplier, the closing moment [N m]
    rubber: Number = 0.0  #: volume of the rubber that lies inside [m^3]

    @property
    def air(self) -> Number:
        """What of the volume is not rubber [m^3]."""
        return self.volume - self.rubber


Row = Callable[[Now, Number], Number]


def _sealed(exponent: float) -> Row:
    """(P + atmosphere) V^n, with V of the air, is that of the gas sealed in; t is its logarithm."""
    return lambda now, t: jnp.log(now.pressure + ATMOSPHERE) + exponent * jnp.log(now.air) - t


ROWS: dict[str, Row] = {
    "length": lambda now, t: now.length - t,
    "volume": lambda now, t: now.volume - t,
    "force": lambda now, t: now.force - t,
    "pressure": lambda now, t: now.pressure - t,
    "closure": lambda now, t: now.closure - t,
    "isothermal": _sealed(1.0),
    "adiabatic": _sealed(HEAT_RATIO),
}
"""Rows by name: slow enough to exchange heat, or too fast to (air), for the sealed ones."""
GASES = ("isothermal", "adiabatic")


def units(unit: Any) -> dict[str, Any]:
    """The size of each row's target, from the units of the quantities."""
    energy, length, volume, closure = unit
    return {
        "length": length, "volume": volume, "force": energy / length, "pressure": energy / volume, "closure": closure,
        "isothermal": 1.0, "adiabatic": 1.0,
    }  # fmt: skip


@attrs.frozen
class Held:
    """Two things held at values in SI units, each by the name of a row or by a row of one's own."""

    names: tuple[Any, ...]
    values: tuple[float, ...]

    @classmethod
    def of(cls, **values: float | None) -> "Held":
        """`Held.of(length=0.1, pressure=1e5)`; exactly two are not None."""
        given = [(name, float(values[name])) for name in ROWS if values.get(name) is not None]  # type: ignore[arg-type]
        (first, a), (second, b) = given
        return cls((first, second), (a, b))

    def get(self, name: str, default: Any = None) -> Any:
        """Value of what is held by name."""
        return dict(zip(self.names, self.values, strict=True)).get(name, default)

    def towards(self, other: "Held", share: float) -> "Held":
        """The same held on the straight way to other values."""
        values = (a + share * (b - a) for a, b in zip(self.values, other.values, strict=True))
        return Held(self.names, tuple(values))

    @property
    def is_minimum(self) -> bool:
        """Whether the state is a minimum of the energy with some totals held: one of each conjugate pair is."""
        return set(self.names) <= set(NAMES) and set(self.names) not in ({"length", "force"}, {"volume", "pressure"})


def rows_of(names: tuple[Any, ...], loads: int) -> tuple[tuple[Row, ...], np.ndarray]:
    """The rows of one's own among `names`, and which rows hold: one for each load, equal end radii where none is said.

    Which of the named rows hold is a number, so that it takes no other compilation; a row of one's own is static.
    """
    names = (*names, "closure")[:loads] if len(names) < loads else names
    own = tuple(name for name in names if callable(name))
    known: list[Any] = [*ROWS, *own]
    return own, np.array([known.index(name) for name in names])


def targets_of(path: Sequence[Held], unit: Any, loads: int) -> np.ndarray:
    """Targets (n, loads) of n holdings of the same rows, each over its size; equal end radii where none are said."""
    size, names = units(unit), path[0].names
    values = np.array([held.values for held in path]) / [1.0 if callable(name) else size[name] for name in names]
    return values if values.shape[1] == loads else np.concatenate([values, np.zeros((len(path), 1))], axis=1)


class Conditions(NamedTuple):
    """Rows at a state, each divided by the size of its gradient: r rows, l loads."""

    miss: Float[Array, " r"]
    by_totals: Float[Array, "r l"]  #: derivatives by length, volume (and closure)
    by_loads: Float[Array, "r l"]  #: derivatives by force, pressure (and moment)
    by_target: Float[Array, " r"]


def read_rows(unit: Array, values: Array, loads: Array, p: Parameters) -> Now:
    """What a state of a muscle reads, of dimensionless totals (l) and loads (l)."""
    parts = [values[k] * unit[1 + k] for k in range(len(values))]
    pulls = [loads[k] * unit[0] / unit[1 + k] for k in range(len(loads))]
    now = Now(parts[0], parts[1], pulls[0], pulls[1], *(one[2] for one in (parts, pulls) if len(values) > 2))
    return now if p.tube is None else now._replace(rubber=p.tube.rubber)


def conditions(own: tuple[Row, ...], which: Array, targets: Array, on: Placed, s: System, loads: Array) -> Conditions:
    """The rows that hold, with their derivatives; `own` and `which` are those of `rows_of`.

    What a load changes of the totals while the shape stays counts as its own.
    """
    unit, values, count = on.unit, s.values, len(loads)
    one = jnp.ones_like(unit[0])
    known = [(row, units(unit)[name] * one) for name, row in ROWS.items()] + [(row, one) for row in own]

    def held(which: Array, target: Array) -> tuple[Array, Array]:
        def row(x: Array) -> tuple[Array, Array]:
            now = read_rows(unit, x[:count], x[count : 2 * count], on.p)
            found = jnp.stack([row(now, x[2 * count] * size) for row, size in known])[which]
            return found, found

        slope, miss = jax.jacfwd(row, has_aux=True)(jnp.concatenate([values, loads, target[None]]))
        return miss, slope

    miss, slope = jax.vmap(held)(which, targets)
    size = jnp.linalg.norm(slope[:, : 2 * count], axis=1)
    miss, slope = miss / size, slope / size[:, None]
    by_totals, by_loads = slope[:, :count], slope[:, count : 2 * count]
    by_loads = by_loads if s.by_loads is None else by_loads + by_totals @ s.by_loads
    return Conditions(miss, by_totals, by_loads, slope[:, 2 * count])
