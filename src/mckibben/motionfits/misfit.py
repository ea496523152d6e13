"""What a rig in motion differs from a measured motion by, over the size of an error of each quantity."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from mckibben.data.recording import Recording
from mckibben.fitting.differences import by_differences
from mckibben.fitting.free import Free, OfFree
from mckibben.fitting.misfit import Seen
from mckibben.motion.commands import Commands
from mckibben.motion.drive import drive
from mckibben.motion.plant import Plant
from mckibben.motion.record import recorded
from mckibben.motion.start import at_rest
from mckibben.spec.change import changed
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.rig import Rig

__all__ = ["MotionMisfit", "Sized"]


@attrs.frozen(eq=False)
class Sized:
    """What is compared: values over their sizes, one quantity after the other."""

    force: np.ndarray  #: (n), in the word of `Points`
    weights: np.ndarray  #: (n) ones


@attrs.define(eq=False)
class MotionMisfit(OfFree):
    """A rig against a recording, for a search."""

    rig: Rig
    free: tuple[Free, ...]
    recording: Recording
    charts: tuple[Any, ...]
    tolerance: float
    sizes: dict[str, float]  #: standard deviation of a measured value of each quantity, SI
    last: tuple[bytes, np.ndarray] | None = attrs.field(init=False, default=None)
    inside: bool = attrs.field(init=False, default=True)  #: whether the last motion lay in the range of its map
    tried: int = attrs.field(init=False, default=0)

    @property
    def measured(self) -> Sized:
        """Measured values over their sizes."""
        force = np.concatenate([values / self.sizes[name] for name, values in self.recording.values.items()])
        return Sized(force, np.ones(len(force)))

    def rig_at(self, x: np.ndarray) -> Rig:
        """The rig with the numbers at x."""
        with trusted():
            names = (one.name for one in self.free)
            made: Rig = changed(self.rig, dict(zip(names, self.values(x).tolist(), strict=True)))
        return made

    def __call__(self, x: np.ndarray) -> Seen:
        """Values of the rig over their sizes, and derivatives where they are asked for."""
        x = np.asarray(x, float)
        here = self.moved(x) / self._each_size()
        return Seen(here, lambda: by_differences(lambda x: self.moved(x) / self._each_size(), self.free, x, here))

    def _each_size(self) -> np.ndarray:
        return np.repeat([self.sizes[name] for name in self.recording.values], len(self.recording))

    def moved(self, x: np.ndarray) -> np.ndarray:
        """What is measured of the rig at x, SI, one quantity after the other; NaN from where a motion stops."""
        key = x.tobytes()
        if self.last is None or self.last[0] != key:
            self.last = key, self._moved(x)
        return self.last[1]

    def _moved(self, x: np.ndarray) -> np.ndarray:
        time, count = self.recording.time, len(self.recording)
        found = np.full((len(self.recording.values), count), np.nan)
        self.tried += 1
        try:
            rig = self.rig_at(x)
            begun = at_rest(Plant.of(rig, self.charts))
            done = drive(begun, Commands(rig, float(time[-1])), time, "LSODA", self.tolerance, lambda k, n: None)
        except SpecError:  # numbers that do not go together, or no equilibrium at the start
            return found.ravel()
        motion = recorded(begun.plant, done, "LSODA", self.tolerance)
        self.inside, reached = motion.inside, len(motion.time)
        for row, name in zip(found, self.recording.values, strict=True):
            values = motion.of(name)
            row[:reached] = values if values.ndim == 1 else values[:, 0]
        return found.ravel()
