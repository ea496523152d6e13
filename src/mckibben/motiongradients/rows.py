"""A motion that was simulated, as a table of steps: what its derivatives go along.

Each row is a step of the integration. Steps end at marks: the times of the answer, jumps, samples of a controller, and
what ends a mode. Where a mark is, and what happens there, is in the rows; how it moves with the numbers of the rig is
found when the rows are gone through again.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mckibben.motion.drive import Driven, Stretch
from mckibben.motion.modes import Ended
from mckibben.motion.plant import Plant
from mckibben.motion.regime import Mode
from mckibben.motiongradients.moments import Source, commanding, moments
from mckibben.spec.controls import PID
from mckibben.spec.signal import TINY

__all__ = ["Begin", "Rows", "blank_rows", "kinds_of", "table_of"]

CLOSE = 1e-12
"""Part of the whole time by which a mark may miss another one that it is meant to be."""


class Begin(NamedTuple):
    """Where a motion began: an equilibrium that was found, or what holds it."""

    x: Any  #: place, m or rad
    at: Any  #: 0 where it is free, 1 on the low stop, 2 on the high one
    outer: Any  #: at which piece the push or torque is then
    slack: Any  #: (muscles) which are slack
    own: Any  #: (muscles) their own lengths [m]


class Rows(NamedTuple):
    """The table: arrays over rows, or (rows, sources) and (rows, muscles)."""

    a: Any  #: part of the way from the last mark to the next at which a step begins
    b: Any  #: and ends
    time: Any  #: of the next mark [s], where nothing moves it
    source: Any  #: what moves it; -1 nothing
    number: Any  #: which break of that source
    inner: Any  #: piece of the duty of a PWM there
    piece: Any  #: at which piece each source is
    target: Any  #: of each muscle, at which piece the target of its controller is
    moves: Any  #: whether the rig is free
    side: Any  #: 1 at the low stop, -1 at the high one
    sliding: Any
    slack: Any  #: (rows, muscles)
    flows: Any  #: (rows, muscles) how air flows, as `flows_of` has it
    ends: Any  #: what happens at the end of a row: number in `kinds_of`, counted from 1; 0 nothing
    seeks: Any  #: likewise what ends a mode when the state says so: by one step of Newton's a row goes to where it does
    rate: Any  #: how fast its margin falls there


def kinds_of(plant: Plant, frictional: bool) -> tuple[Ended, ...]:
    """All that may end a mode of a rig."""
    found: list[Ended] = []
    if plant.stops[0] is not None:
        found += [("low", 0)]
    if plant.stops[1] is not None:
        found += [("high", 0)]
    if found:
        found += [("leave", 0)]
    if frictional:
        found += [("turn", 0), ("slip", 0)]
    if plant.slackens:
        found += [(what, k) for k in range(plant.n) for what in ("slack", "tight")]
    return tuple(found)


def blank_rows(count: int, sources: int, muscles: int) -> Rows:
    """Rows in which nothing happens."""
    whole, number, flag = np.zeros(count, np.int64), np.zeros(count), np.zeros(count, bool)
    return Rows(
        a=number, b=number.copy(), time=number.copy(), source=whole - 1, number=whole.copy(), inner=whole.copy(),
        piece=np.zeros((count, sources), np.int64), target=np.zeros((count, muscles), np.int64), moves=flag,
        side=number.copy(), sliding=number.copy(), slack=np.zeros((count, muscles), bool),
        flows=np.zeros((count, muscles), np.int64), ends=whole.copy(),
        seeks=whole.copy(), rate=number + 1.0,
    )  # fmt: skip


class _Writer:
    """Writes rows from mark to mark."""

    def __init__(self, plant: Plant, sources: tuple[Source, ...], until: float, times: np.ndarray) -> None:
        self.plant, self.sources, self.until = plant, sources, until
        self.coming = moments(plant.rig, self.sources, until)
        self.asked, self.at = times.tolist(), np.full(len(times), -1)
        self.told, self.next, self.mark = 0, 0, 0.0
        self.piece = [0] * len(self.sources)
        self.rows: list[tuple[Any, ...]] = []

    def go(
        self, stretch: Stretch, time: float, about: tuple[int, int, int] = (-1, 0, 0), ends: int = 0, seeks: int = 0
    ) -> None:
        """On to the next mark, by the steps of a stretch that end before it."""
        mode, way, near = stretch.mode, time - self.mark, CLOSE * self.until
        ends_at, flows = stretch.times[1:], stretch.flows or [(0,) * self.plant.n] * len(stretch.times)
        parts = [(t, k) for k, t in enumerate(ends_at) if self.mark + near < t < time - near]
        last = next((k for k, t in enumerate(ends_at) if t >= time - near), len(flows) - 1)
        steps = [((t - self.mark) / way, flows[k]) for t, k in parts] + [(1.0, flows[last])]
        flags = (mode.moves == "free", {"low": 1.0, "high": -1.0}.get(mode.moves, 0.0), mode.sliding,
                 mode.slack[: self.plant.n])  # fmt: skip
        targets, a = [self._target(k, time) for k in range(self.plant.n)], 0.0
        for b, flow in steps:
            what = (ends, seeks, stretch.rate or 1.0) if b == 1.0 else (0, 0, 1.0)
            self.rows.append((a, b, time, *about, list(self.piece), targets, *flags, flow, *what))
            a = b
        self.mark = time

    def _target(self, k: int, time: float) -> int:
        command = commanding(self.plant.rig, k)[0]
        if not isinstance(command, PID):
            return 0
        return sum(one <= time + TINY for one in command.target.breaks(time + TINY))

    def answers(self, stretch: Stretch, time: float) -> None:
        """All times of the answer up to a mark."""
        while self.told < len(self.asked) and self.asked[self.told] <= time + CLOSE * self.until:
            self.go(stretch, self.asked[self.told])
            self.at[self.told] = len(self.rows) - 1
            self.told += 1

    def jumps(self, stretch: Stretch, time: float) -> None:
        """All jumps up to a time, each a row of its own; at the first of them the steps from the last mark end."""
        while self.next < len(self.coming) and self.coming[self.next].time <= time:
            moment = self.coming[self.next]
            self.go(stretch, moment.time, (moment.source, moment.number, moment.inner))
            self.piece[moment.source] += 1
            self.next += 1


def table_of(
    plant: Plant, begun: Mode, done: Driven, until: float, times: np.ndarray, sources: tuple[Source, ...],
    kinds: tuple[Ended, ...],
) -> tuple[Rows, np.ndarray]:  # fmt: skip
    """The table of a motion, and the row at whose end each time of the answer is; -1 where it was not reached."""
    writer, near = _Writer(plant, sources, until, times), 2.0 * TINY * max(1.0, until)
    writer.jumps(Stretch(begun, [0.0, 0.0], done.stretches[0].flows[:1]), near)
    for stretch in done.stretches:
        end = stretch.times[-1]
        woken = stretch.ended is not None and len(stretch.times) == 2 and stretch.times[0] == end
        if not woken:
            writer.answers(stretch, end)
        if stretch.ended is not None:
            kind = 1 + kinds.index(stretch.ended)
            if not stretch.rate:
                writer.go(stretch, end, ends=kind)
            else:
                writer.go(stretch, end)
                writer.go(stretch, end, seeks=kind)
                writer.go(stretch, end, seeks=kind, ends=kind)
        if not woken:
            writer.jumps(stretch, end + near)
    columns = list(zip(*writer.rows, strict=True))
    made = blank_rows(len(writer.rows), len(writer.sources), plant.n)
    filled = [np.array(column, like.dtype).reshape(like.shape) for column, like in zip(columns, made, strict=True)]
    return Rows(*filled), writer.at
