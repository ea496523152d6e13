"""The equations of motion on JAX arrays: those of `Regime`, with what it chooses by `if` chosen by selection."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import attrs
import jax
import jax.numpy as jnp
import numpy as np

from mckibben.motion.flow import LAMINAR, RHO, TEMPERATURE
from mckibben.motion.regime import Regime, Seen
from mckibben.potential.evaluate import Table, Values, evaluate

__all__ = ["TracedMap", "TracedMode", "TracedRegime"]


class _Numbers:
    """`jax.numpy` for maps: on an edge the slopes are those inside, not the mean of inside and outside."""

    def __getattr__(self, name: str) -> Any:
        return getattr(jnp, name)

    def chebyshev(self, x: Any, n: int) -> Any:
        return _chebyshev(x, n)

    def clip(self, x: Any, low: Any, high: Any) -> Any:
        return jnp.where(x < low, low, jnp.where(x > high, high, x))


@partial(jax.custom_jvp, nondiff_argnums=(1,))
def _chebyshev(x: Any, n: int) -> Any:
    """The first n Chebyshev polynomials, as (n, N), by T(k + j) = 2 T(k) T(j) - T(k - j)."""
    found = jnp.stack([jnp.ones_like(x), x])
    while len(found) < n:
        k = len(found) - 1
        found = jnp.concatenate([found, 2.0 * found[k] * found[1:] - found[k - 1 :: -1]])
    return found[:n]


@_chebyshev.defjvp
def _chebyshev_jvp(n: int, at: tuple[Any], by: tuple[Any]) -> tuple[Any, Any]:
    """Their slopes are sums of them."""
    found = _chebyshev(*at, n)
    return found, (_slopes(n) @ found) * by[0]


@cache
def _slopes(n: int) -> np.ndarray:
    """Slopes of Chebyshev polynomials as sums of the polynomials."""
    made = np.zeros((n, n))
    for k in range(1, n):
        made[k, k - 1 :: -2] = 2.0 * k
        if k % 2:
            made[k, 0] = k
    return made


class TracedMap(NamedTuple):
    """The map of a muscle inside of compiled functions."""

    table: Table
    apart: Any  #: air less volume of the braid [m^3]

    @property
    def pressures(self) -> tuple[Any, Any]:
        """The lowest and the highest pressure [Pa]."""
        return self.table.first, self.table.last

    def at(self, length: Any, pressure: Any) -> Values:
        """All that the map tells at one point."""
        found = evaluate(self.table, jnp.reshape(length, 1), jnp.reshape(pressure, 1), xp=_Numbers())
        return Values(*(one[0] for one in found))


class TracedMode(NamedTuple):
    """How a rig moves, in numbers."""

    moves: Any  #: whether it is free
    side: Any  #: 1 at the low stop, -1 at the high one
    sliding: Any
    slack: Any  #: of each muscle
    flows: Any  #: likewise, as `flows_of` has it


@attrs.frozen
class TracedRegime(Regime):
    """`Regime` whose numbers, mode and time may be traced."""

    mode: Any
    outer: Callable[[Any], Any] | None = None

    def outside(self, t: Any) -> Any:
        return 0.0 if self.outer is None else self.plant.sense * self.outer(t)

    def _speed(self, y: Any) -> Any:
        return 0.0 if self.plant.rig.fixed else jnp.where(self.mode.moves, y[1], 0.0)

    def _slid(self, v: Any) -> Any:
        return self.plant.friction * self.mode.sliding * v

    def _acceleration(self, push: Any) -> Any:
        plant, mode = self.plant, self.mode
        if plant.rig.fixed:
            return 0.0
        return jnp.where(mode.moves, (push - mode.sliding * plant.friction) / plant.mass, 0.0)

    def _on_edge(self, k: int, P: Any) -> Any:
        low, first, last, high = self.plant.edges[k]
        below, above = (low < P) & (first > P), (last < P) & (high > P)
        return jnp.where(below, first, jnp.where(above, last, P))

    def _muscle(self, k: int, u: Any, y: Any, x: Any, v: Any, slack: Any) -> tuple[list[Any], Seen, Any]:
        taut = Regime._muscle(self, k, u, y, x, v, False)
        if not self.plant.slackens:
            return taut
        loose = Regime._muscle(self, k, u, y, x, v, True)

        def chosen(a: Any, b: Any) -> Any:
            return jnp.where(slack, b, a)

        return (
            [chosen(a, b) for a, b in zip(taut[0], loose[0], strict=True)],
            Seen(*map(chosen, taut[1], loose[1])),
            chosen(taut[2], loose[2]),
        )

    def _air(self, k: int, u: Any, p: Any, T: Any) -> tuple[Any, Any, Any, Any]:
        plant, flows = self.plant, self.mode.flows[k]
        C, vent, b = plant.valves[k]
        fills, out = flows < 6, flows % 6 >= 3
        other, hot = jnp.where(fills, plant.supplied, plant.atmosphere), self._warmth(k, T)
        before, after = jnp.where(out, p, other), jnp.where(out, other, p)
        flowing = _flow(jnp.where(fills, C, -vent) * u, b, before, hot, after, flows % 3)
        net = jnp.where(out, -flowing, flowing)
        inflow, outflow = jnp.where(fills, net, 0.0), jnp.where(fills, 0.0, -net)
        if plant.isothermal:
            return inflow, outflow, net * T, 0.0
        return inflow, outflow, net * hot, self._from_wall(T)

    def _warmth(self, k: int, T: Any) -> Any:
        """The temperature of air that flows."""
        flows = self.mode.flows[k]
        return jnp.where(flows % 6 >= 3, T, jnp.where(flows < 6, self.plant.source, self.plant.around))

    def _carried(self, k: int, inflow: Any, outflow: Any, T: Any) -> Any:
        return (inflow - outflow) * self._warmth(k, T)


def _flow(C: Any, b: Any, before: Any, temperature: Any, after: Any, how: Any) -> Any:
    """`mass_flow` on arrays: 0 choked, 1 subsonic, 2 laminar; every branch of it is finite, with its slopes."""
    choked = C * RHO * before * jnp.sqrt(TEMPERATURE / temperature)
    edge = jnp.maximum(LAMINAR, b)
    ratio = after / before
    share = jnp.where(how == 0, 0.0, (jnp.where(how == 1, ratio, edge) - b) / (1.0 - b))
    root = jnp.sqrt(1.0 - share**2)
    return choked * jnp.where(how == 2, root * (1.0 - ratio) / (1.0 - edge), root)
