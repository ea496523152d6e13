"""A motion simulated at the numbers themselves, before it is gone along once more with derivatives.

Inside `jit` and `vmap` the numbers are not there yet while JAX traces: the simulation is called back when they are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import numpy as np

from mckibben.motion.commands import Commands
from mckibben.motion.drive import drive
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER
from mckibben.motion.start import Begun, at_rest
from mckibben.motiongradients.along import Pattern
from mckibben.motiongradients.moments import commanding, outer_of
from mckibben.motiongradients.rows import Begin, Rows, blank_rows, table_of
from mckibben.spec.controls import PID
from mckibben.spec.errors import SpecError
from mckibben.spec.rig import Rig
from mckibben.spec.signal import TINY

__all__ = ["Beforehand", "Request", "concrete", "kept_by", "simulated_at"]

LEAST = 64
"""Fewest rows of a table. Tables come in few sizes, so that little is compiled anew."""


class Request(NamedTuple):
    """What is asked of a simulation."""

    until: float
    points: int
    tolerance: float
    room: int  #: rows inside `jit` and `vmap`

    @property
    def times(self) -> np.ndarray:
        """Times of the answer [s]."""
        return np.linspace(0.0, self.until, self.points)


class Beforehand(NamedTuple):
    """What derivatives need to know of a motion."""

    begin: Begin
    rows: Rows
    at: Any  #: the row at whose end each time of the answer is; -1 where it was not reached


def concrete(rig: Rig) -> Rig | None:
    """The rig with plain numbers; None where they are not there yet."""
    leaves, tree = jax.tree.flatten(jax.tree.map(jax.lax.stop_gradient, rig))
    if any(isinstance(leaf, jax.core.Tracer) for leaf in leaves):
        return None
    return jax.tree.unflatten(tree, [float(leaf) for leaf in leaves])


def kept_by(rig: Rig) -> int:
    """How many commands of a controller may be on their way through the dead time of a valve, up to a power of two."""
    most = 1
    for k, valve in enumerate(rig.valves):
        command = commanding(rig, k)[0]
        if isinstance(command, PID):
            most = max(most, math.floor(valve.delay / command.every + TINY) + 2)
    return int(1 << (most - 1).bit_length())


def simulated_at(rig: Rig, charts: Sequence[Any], way: Pattern, asked: Request) -> Beforehand:
    """A motion of a rig whose numbers may be traced."""
    plain = concrete(rig)
    if plain is not None:
        return _simulated(plain, charts, way, asked, 0)
    leaves, tree = jax.tree.flatten(jax.tree.map(jax.lax.stop_gradient, rig))

    def called(numbers: list[Any]) -> Beforehand:
        again = jax.tree.unflatten(tree, [float(number) for number in numbers])
        return _simulated(again, charts, way, asked, asked.room)

    n = len(rig.muscles)
    begin = Begin(np.zeros(()), np.zeros((), int), np.zeros((), int), np.zeros(n, bool), np.zeros(n))
    form = Beforehand(begin, blank_rows(asked.room, len(way.sources), n), np.zeros(asked.points, int))
    shapes = jax.tree.map(lambda one: jax.ShapeDtypeStruct(one.shape, one.dtype), form)
    return jax.pure_callback(called, shapes, leaves, vmap_method="sequential")


def _simulated(rig: Rig, charts: Sequence[Any], way: Pattern, asked: Request, room: int) -> Beforehand:
    """The motion of a rig whose numbers are known; in as many rows as there is room for, where that is said."""
    begun = at_rest(Plant.of(rig, charts))
    if kept_by(rig) > way.kept:
        said = f"holds back more than {way.kept} commands of the controller, more than there is room for inside jit"
        raise SpecError("valve.delay", allowed=said, advice="give it outside of what is compiled")
    done = drive(begun, Commands(rig, asked.until), asked.times, "RK45", asked.tolerance, _unwatched, kinks=True)
    rows, at = table_of(begun.plant, begun.mode, done, asked.until, asked.times, way.sources, way.kinds)
    count = len(rows.a)
    if room and count > room:
        said = f"is too small: the motion takes {count} steps"
        raise SpecError("motion_response.room", room, said, f"give room={_size(count)}")
    return Beforehand(_begin(begun), _padded(rows, room or _size(count)), at)


def _unwatched(done: int, total: int) -> None: ...


def _begin(begun: Begun) -> Begin:
    plant, y = begun.plant, begun.state
    outer = outer_of(plant.rig)
    return Begin(
        np.array(y[0]), np.array(next((k for k, stop in enumerate(plant.stops, 1) if stop == y[0]), 0)),
        np.array(0 if outer is None else sum(t <= TINY for t in outer.breaks(TINY))),
        np.array(begun.mode.slack[: plant.n]), np.array([y[FIRST + PER * k + 2] for k in range(plant.n)]),
    )  # fmt: skip


def _size(count: int) -> int:
    """The next power of two, or one and a half of the one before."""
    size = LEAST
    while size < count:
        size = size * 3 // 2 if size & (size - 1) == 0 else size // 3 * 4
    return size


def _padded(rows: Rows, size: int) -> Rows:
    """Further rows after the last one, in which nothing happens."""
    spare = blank_rows(size - len(rows.a), rows.piece.shape[1], rows.target.shape[1])
    spare = spare._replace(time=spare.time + rows.time[-1])
    return Rows(*(np.concatenate(pair) for pair in zip(rows, spare, strict=True)))
