"""Where the viewer stands: a parallel projection, the same for drawings in the plane and for scenes."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
MM = 1e3
"""mm per m."""


@attrs.frozen
class View:
    """A parallel projection: the axis lies "horizontal" or "vertical", tilted so that its far end leaves the viewer.

    With tilt > 0 the viewer looks onto the end z = h; `turn` turns the muscle about its axis. Angles in degrees.
    """

    axis: str = "horizontal"
    tilt: float = 18.0
    turn: float = 0.0
    at: tuple[float, float] = (0.0, 0.0)  #: where the origin stands on the screen [mm]

    def project(self, points: Any) -> tuple[Floats, Floats]:
        """Screen directions (..., 2) and depths (...) towards the viewer of vectors (..., 3)."""
        points, t, a = np.asarray(points, float), np.deg2rad(self.tilt), np.deg2rad(self.turn)
        x = np.cos(a) * points[..., 0] - np.sin(a) * points[..., 1]
        y = np.sin(a) * points[..., 0] + np.cos(a) * points[..., 1]
        z = points[..., 2]
        along, depth = np.cos(t) * z - np.sin(t) * x, np.cos(t) * x + np.sin(t) * z
        screen = (along, -y) if self.axis == "horizontal" else (y, along)
        return np.stack(screen, axis=-1), np.asarray(depth)

    def place(self, points: Any) -> Floats:
        """Positions on the screen [mm] of points (..., 3) [m]."""
        return self.project(MM * np.asarray(points))[0] + np.array(self.at)
