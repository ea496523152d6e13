"""What is seen of a motion at times that are evenly spread: one frame each."""

from __future__ import annotations

import tomllib

import attrs
import numpy as np

from mckibben.results.motion import Motion
from mckibben.spec.errors import SpecError
from mckibben.spec.rig import Rig
from mckibben.spec.rigtext import rig_from_mapping
from mckibben.units import show

__all__ = ["MOST", "Frames", "frames_of", "rig_of"]

MOST = 1500
"""Frames at most: more take long, and few programs show such a file."""
SWITCHES = 0.5
"""Jump of a command from which a valve switches; where it does so repeatedly in a frame, the mean says what it does."""
HUNDREDTH = 0.01
"""A GIF counts in hundredths of a second."""


@attrs.frozen
class Frames:
    """The frames; numbers of a muscle are arrays (frames, muscles), SI units."""

    time: np.ndarray  #: in the motion [s]
    shown: float  #: how long each is shown [s]
    length: np.ndarray
    pressure: np.ndarray  #: gauge
    command: np.ndarray  #: where it switches to and fro, the mean over the time that a frame stands for
    switching: np.ndarray  #: whether it jumps to and fro within that time
    slack: np.ndarray
    inside: np.ndarray  #: whether the map is good there
    place: np.ndarray  #: length at which the load is [m], or angle of the pulley [rad]; (frames)

    def __len__(self) -> int:
        return len(self.time)


def rig_of(motion: Motion) -> Rig:
    """The rig of a motion but its commands, which may be Python functions that no motion keeps."""
    mapping = tomllib.loads(str(motion.data.attrs["rig"]))
    return rig_from_mapping({name: value for name, value in mapping.items() if not name.endswith("command")})


def frames_of(motion: Motion, fps: float, speed: float, whole: bool) -> Frames:
    """Frames `fps` a second at `speed` times real time; `whole`: each is shown for whole hundredths of a second.

    Lengths, pressures and angles are straight between the times of the motion. SpecError for too many frames.
    """
    time = motion.time
    shown = max(round(1.0 / (fps * HUNDREDTH)), 1) * HUNDREDTH if whole else 1.0 / fps
    step = shown * speed
    span = float(time[-1] - time[0])
    count = int(np.floor(span / step * (1.0 + 1e-12))) + 1
    if count > MOST:
        least = span / ((MOST - 1) * shown)
        said = f"makes {count} frames of {show(span, 's', 4)}, and there may be {MOST}"
        raise SpecError(
            "animate.speed", speed, said, f"ask for a speed of at least {least:.2g}, or fewer frames a second"
        )
    at = time[0] + step * np.arange(count)
    length, pressure = (_between(at, time, _columns(motion, name)) for name in ("length", "pressure"))
    command, switching = _commands(at, step, time, _columns(motion, "command"))
    slack, inside = (_nearest(at, time, _columns(motion, name)) for name in ("slack", "inside"))
    own = "angle" if "angle" in motion.data else "position" if "position" in motion.data else "length"
    place = _between(at, time, _columns(motion, own))[:, 0]
    return Frames(at, shown, length, pressure, command, switching, slack, inside, place)


def _columns(motion: Motion, name: str) -> np.ndarray:
    return motion.of(name).reshape(len(motion.time), -1)


def _between(at: np.ndarray, time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(at, time, column) for column in values.T], axis=1)


def _nearest(at: np.ndarray, time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.asarray(values[np.abs(time[:, None] - at).argmin(axis=0)])


def _commands(at: np.ndarray, step: float, time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The commands at each frame; of valves that switch repeatedly within its time the mean, and which those are."""
    now = values[np.maximum(np.searchsorted(time, at * (1.0 + 1e-12), "right") - 1, 0)]
    many = np.zeros(now.shape, bool)
    for k, t in enumerate(at):
        first, last = np.searchsorted(time, [t - 0.5 * step, t + 0.5 * step])
        some = values[first:last]
        many[k] = (np.abs(np.diff(some, axis=0)) > SWITCHES).sum(axis=0) > 1
        now[k] = np.where(many[k], some.mean(axis=0) if len(some) else now[k], now[k])
    return now, many
