"""How a pulley is drawn that one muscle or two turn by cables."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.film.layout import Scene
from mckibben.film.pen import METAL, Pen
from mckibben.view import style

__all__ = ["Turning"]

CIRCLE = np.linspace(0.0, 2.0 * np.pi, 73)


@attrs.frozen(eq=False)
class Turning:
    """One or two muscles that turn a pulley; the first one lies above, and turns it against the clock."""

    scene: Scene
    way: str = "right"

    @property
    def aside(self) -> float:
        """How far the muscles lie from the middle."""
        return max(float(self.scene.rig.load.radius), 1.4 * self.scene.widest)

    @property
    def centre(self) -> float:
        """Where the pulley is."""
        scene = self.scene
        straight = [float(self.straight(which).max()) for which in range(len(scene.rig.muscles))]
        return max(float(scene.frames.length.max()), *straight) + 0.2 * scene.size + float(scene.rig.load.radius)

    @property
    def arm(self) -> float:
        """The length of the arm that turns with the pulley."""
        return max(2.2 * float(self.scene.rig.load.radius), 0.35 * self.scene.size)

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """From where to where it goes."""
        f, arm = self.scene.fitting, 1.25 * self.arm
        high = max(self.aside + 1.9 * self.scene.widest, arm)
        low = -high if self.scene.rig.antagonist is not None else -max(arm, 1.3 * self.aside)
        return (-3.0 * f, self.centre + arm), (low, high)

    def straight(self, which: int) -> np.ndarray:
        """The length that a straight cable would give a muscle, at each frame."""
        load, muscle = self.scene.rig.load, self.scene.rig.muscles[which]
        given = load.length if which == 0 or load.antagonist_length is None else load.antagonist_length
        middle = float(muscle.rest_length) if given is None else given
        turned = load.radius * self.scene.frames.place
        return np.asarray(middle - turned if which == 0 else middle + turned)

    def still(self, pen: Pen) -> None:
        """Draw what does not move."""
        scene, load = self.scene, self.scene.rig.load
        low = -1.5 * self.aside if scene.rig.antagonist is not None else 0.3 * self.aside
        pen.wall(-scene.fitting, (low, 1.5 * self.aside), -scene.fitting)
        for stop in (load.stop_low, load.stop_high):
            if stop is not None:
                reach = np.array([0.75, 1.05]) * self.arm
                pen.line(
                    self.centre + reach * np.cos(stop), reach * np.sin(stop), color=style.VERMILLION, linewidth=2.0
                )

    def draw(self, pen: Pen, k: int) -> None:
        """Draw what moves, at a frame."""
        self._muscles(pen, k)
        scene, load, centre = self.scene, self.scene.rig.load, self.centre
        R, q = float(load.radius), float(scene.frames.place[k])
        if scene.target is not None:
            aim, far = float(scene.target[k]), 1.2 * self.arm
            pen.line([centre, centre + far * np.cos(aim)], [0.0, far * np.sin(aim)], color=style.GREY, linestyle="--")
        pen.area(centre + R * np.cos(CIRCLE), R * np.sin(CIRCLE), zorder=3)
        if load.spring > 0.0:
            t = np.linspace(0.0, 1.0, 121)
            turn, reach = q * (1.0 - t) - 4.5 * np.pi * t, R * (0.15 + 0.7 * t)
            pen.line(centre + reach * np.cos(turn), reach * np.sin(turn), color=style.GREY, zorder=4, linewidth=0.8)
        arm = self.arm
        pen.line([centre, centre + arm * np.cos(q)], [0.0, arm * np.sin(q)], linewidth=2.2, zorder=5, gid="arm")
        pen.area(centre + 0.12 * R * np.cos(CIRCLE), 0.12 * R * np.sin(CIRCLE), facecolor=METAL, zorder=6)
        torque = 0.0 if load.torque is None else float(load.torque(float(scene.frames.time[k])))
        if torque:
            pen.text(centre, -1.25 * R, f"torque {torque:.3g} N m", ha="left", va="top")

    def _muscles(self, pen: Pen, k: int) -> None:
        """The muscles with their cables and what their valves do."""
        scene, f = self.scene, self.scene.fitting
        for which in range(len(scene.rig.muscles)):
            side = 1.0 if which == 0 else -1.0
            x, length = side * self.aside, float(scene.frames.length[k, which])
            scene.muscle(pen, k, which, x)
            slack = max(length - float(self.straight(which)[k]), 0.0)
            end = _tangent(length + f, self.aside, self.centre, float(scene.rig.load.radius))
            pen.cable((length + f, x), (end[0], side * end[1]), slack, linewidth=0.9)
            edge = x + side * 1.15 * scene.widest
            scene.valve(pen, k, which, 0.0, edge, ha="left", va="bottom" if side > 0.0 else "top")


def _tangent(s: float, x: float, centre: float, radius: float) -> tuple[float, float]:
    """Where the straight line from (s, x) touches a circle about (centre, 0), on the side of x."""
    away = float(np.hypot(centre - s, x))
    turn = np.arctan2(x, s - centre) - np.arccos(min(radius / away, 1.0))
    return float(centre + radius * np.cos(turn)), float(radius * np.sin(turn))
