"""How rigs in a line are drawn: a muscle between two walls, or with a load that it moves."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.film.layout import Scene
from mckibben.film.pen import Pen
from mckibben.units import show
from mckibben.view import style

__all__ = ["BetweenWalls", "OnLine"]


@attrs.frozen(eq=False)
class BetweenWalls:
    """A muscle between two walls."""

    scene: Scene
    way: str = "right"

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        far = float(self.scene.frames.length.max()) + 3.0 * self.scene.fitting
        return (-3.0 * self.scene.fitting, far), (-1.6 * self.scene.widest, 2.2 * self.scene.widest)

    def still(self, pen: Pen) -> None:
        f, w = self.scene.fitting, 1.6 * self.scene.widest
        pen.wall(-f, (-w, w), -f)
        pen.wall(float(self.scene.frames.length[0, 0]) + f, (-w, w), f)

    def draw(self, pen: Pen, k: int) -> None:
        self.scene.muscle(pen, k, 0, 0.0)
        self.scene.valve(pen, k, 0, 0.0, 1.7 * self.scene.widest, ha="left", va="bottom")


@attrs.frozen(eq=False)
class OnLine:
    """A mass that hangs from a muscle, stands on it (gravity below 0), or slides with it on a table (no gravity)."""

    scene: Scene

    @property
    def way(self) -> str:
        gravity = self.scene.rig.load.gravity
        return "down" if gravity > 0.0 else "up" if gravity < 0.0 else "right"

    @property
    def rod(self) -> float:
        """Between muscle and mass; as long as the cable is slack at most, within reason, and some more."""
        return 0.12 * self.scene.size + min(float(self._slack().max(initial=0.0)), 0.5 * self.scene.size)

    @property
    def block(self) -> tuple[float, float]:
        """The mass as drawn: its length along the muscle, and half of its width."""
        load, size, widest = self.scene.rig.load, self.scene.size, self.scene.widest
        beside = load.spring > 0.0 or load.damping > 0.0
        return 0.2 * size, widest + (0.22 if beside else 0.06) * size

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        (tall, wide), f = self.block, self.scene.fitting
        stop = self.scene.rig.load.stop_high
        far = max(float(self.scene.frames.place.max()), stop or 0.0) + f + self.rod + tall
        return (-5.0 * f, far + 3.0 * f), (-1.5 * wide, 1.5 * wide)

    def _slack(self) -> np.ndarray:
        return np.asarray(np.maximum(self.scene.frames.length[:, 0] - self.scene.frames.place, 0.0))

    def still(self, pen: Pen) -> None:
        scene, load = self.scene, self.scene.rig.load
        (tall, wide), f = self.block, scene.fitting
        pen.wall(-f, (-1.1 * wide, 1.1 * wide), -f)
        for stop, at, out in ((load.stop_low, 0.0, -0.5 * f), (load.stop_high, tall, 0.5 * f)):
            if stop is None:
                continue
            s = stop + f + self.rod + at
            sides = (
                ((-1.45 * wide, -0.95 * wide), (0.95 * wide, 1.45 * wide))
                if at == 0.0
                else ((-1.45 * wide, 1.45 * wide),)
            )
            for side in sides:
                pen.wall(s, side, out, color=style.VERMILLION, gid="stop")
            look = {"fontsize": style.NOTE + 0.5, "color": style.VERMILLION}
            if self.way == "right":
                pen.text(s + 2.0 * out, -1.45 * wide, f"stop {show(stop, 'm', 4)}", va="top", **look)
            else:
                pen.text(s + 3.0 * out, 1.5 * wide, f"stop {show(stop, 'm', 4)}", ha="right", **look)
        if self.way == "right":  # the table
            far = self.extent[0][1]
            pen.line([0.0, far], [-1.02 * wide, -1.02 * wide], linewidth=1.0)

    def draw(self, pen: Pen, k: int) -> None:
        scene, load, (tall, wide) = self.scene, self.scene.rig.load, self.block
        f, place, length = scene.fitting, float(scene.frames.place[k]), float(scene.frames.length[k, 0])
        near = place + f + self.rod
        if load.spring > 0.0:
            pen.spring((-f, near), -0.72 * wide, 0.05 * scene.size)
        if load.damping > 0.0:
            low, high = (float(one(scene.frames.place)) + f + self.rod for one in (np.min, np.max))
            margin = 0.06 * scene.size
            rod = 0.55 * (low + f)
            cup = low - rod - margin, high - rod + margin
            pen.damper((-f, near), 0.72 * wide, 0.05 * scene.size, cup, rod)
        scene.muscle(pen, k, 0, 0.0)
        if self.way != "right":  # to the ruler
            pen.line(
                [length, length], [self.extent[1][0], 0.0], color=style.GREY, linewidth=0.6, linestyle=":", zorder=1
            )
        slack = float(self._slack()[k])
        pen.cable((length + f, 0.0), (near, 0.0), slack, linewidth=0.9 if load.slack else 1.8)
        pen.box((near, near + tall), (-wide, wide), zorder=5, gid="mass")
        push = 0.0 if load.push is None else float(load.push(float(scene.frames.time[k])))
        pushed = f"\npush {push:.3g} N" if push else ""
        pen.text(near + 0.5 * tall, 0.0, show(load.mass, "kg", 4) + pushed, zorder=6)
        if self.way == "right":
            scene.valve(pen, k, 0, 0.0, 1.05 * wide, ha="left", va="bottom")
        else:
            scene.valve(pen, k, 0, -3.6 * f, 0.0)
