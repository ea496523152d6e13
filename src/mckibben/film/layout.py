"""A rig and its frames as they are drawn, true to scale along the muscle; what every layout of a rig can do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, runtime_checkable

import attrs
import numpy as np

from mckibben.film.frames import Frames
from mckibben.film.pen import Pen, valve_word
from mckibben.film.silhouettes import Silhouette
from mckibben.spec.rig import Rig

__all__ = ["Layout", "Scene"]

FITTING = 0.05
"""Length of a fitting as drawn, over the length of the muscle as made."""


NAMES = ("agonist", "antagonist")


@attrs.frozen(eq=False)
class Scene:
    """What is drawn: a rig, its frames, and the silhouettes of its muscles."""

    rig: Rig
    frames: Frames
    silhouettes: Sequence[Sequence[Silhouette | None]]  #: of each muscle, one each frame
    colour: Callable[[float], Any]  #: of a gauge pressure [Pa]
    target: np.ndarray | None = None  #: of a PID, at each frame, SI

    @property
    def size(self) -> float:
        """The length of the muscles as made [m]."""
        return max(float(muscle.rest_length) for muscle in self.rig.muscles)

    @property
    def fitting(self) -> float:
        return FITTING * self.size

    @property
    def widest(self) -> float:
        """The largest radius of all [m]."""
        radii = [float(muscle.braid.radius) for muscle in self.rig.muscles]
        return max([*radii, *(float(one.r.max()) for some in self.silhouettes for one in some if one is not None)])

    def muscle(self, pen: Pen, k: int, which: int, x: float) -> None:
        """One muscle at a frame, with what its valve does."""
        made, frames = self.rig.muscles[which], self.frames
        length = float(frames.length[k, which])
        silhouette, colour = self.silhouettes[which][k], self.colour(float(frames.pressure[k, which]))
        pen.muscle(length, x, silhouette, float(made.braid.radius), self.fitting, colour, f"muscle {which}")

    def valve(self, pen: Pen, k: int, which: int, s: float, x: float, **look: Any) -> None:
        frames = self.frames
        word, colour = valve_word(float(frames.command[k, which]), bool(frames.switching[k, which]))
        name = f"{NAMES[which]}: " if len(self.rig.muscles) > 1 else ""
        pen.text(s, x, f"{name}valve {word}", **{"color": colour} | look)


@runtime_checkable
class Layout(Protocol):
    """How a rig is drawn; coordinates as a `Pen` has them, in m."""

    @property
    def scene(self) -> Scene: ...

    @property
    def way(self) -> str: ...

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """From where to where it goes along the muscle and across."""

    def still(self, pen: Pen) -> None:
        """Draw what does not move."""

    def draw(self, pen: Pen, k: int) -> None:
        """Draw what moves, at a frame."""
