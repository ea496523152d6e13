"""What a drawing of a rig is made of: muscle, wall, mass, spring, damper, cable, in the plane of a picture."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from matplotlib.axes import Axes

from mckibben.film.silhouettes import Silhouette
from mckibben.view import style

__all__ = ["INK", "METAL", "Pen", "valve_word"]

INK = "0.15"
METAL = "0.72"
"""Fittings, pulleys and masses."""
HATCH = 12
TURNS = 7
"""Of a spring as drawn."""


@attrs.frozen
class Pen:
    """Draws on axes in mm by two coordinates in m: s along the muscle from its fixed end, x across.

    `way` says where the muscle goes from its fixed end: "down" (s grows downwards), "up" or "right".
    """

    axes: Axes
    way: str
    made: list[Any] = attrs.field(factory=list)  #: what was drawn

    def at(self, s: Any, x: Any) -> tuple[Any, Any]:
        """Data coordinates."""
        s, x = np.broadcast_arrays(1e3 * np.asarray(s, float), 1e3 * np.asarray(x, float))
        return (s, x) if self.way == "right" else (x, s)

    def clear(self) -> None:
        """Take away what was drawn."""
        for one in self.made:
            one.remove()
        self.made.clear()

    def line(self, s: Any, x: Any, **look: Any) -> None:
        self.made.extend(self.axes.plot(*self.at(s, x), **_look(look, color=INK, linewidth=1.0)))

    def area(self, s: Any, x: Any, **look: Any) -> None:
        self.made.extend(self.axes.fill(*self.at(s, x), **_look(look, facecolor=METAL, edgecolor=INK, linewidth=0.8)))

    def box(self, s: tuple[float, float], x: tuple[float, float], **look: Any) -> None:
        self.area([s[0], s[1], s[1], s[0]], [x[0], x[0], x[1], x[1]], **look)

    def text(self, s: float, x: float, words: str, **look: Any) -> None:
        across, along = self.at(s, x)
        look = _look(look, fontsize=style.TICK, ha="center", va="center", color=INK)
        self.made.append(self.axes.text(float(across), float(along), words, **look))

    def wall(self, s: float, x: tuple[float, float], out: float, **look: Any) -> None:
        """A wall across, hatched on the side on which s grows by `out`."""
        marks = np.linspace(x[0], x[1], HATCH + 1)
        lean = (x[1] - x[0]) / HATCH
        nan = np.full(HATCH, np.nan)
        strokes = np.stack([marks[1:], marks[1:] - lean, nan], axis=1).ravel()
        depth = np.stack([np.full(HATCH, s), np.full(HATCH, s + out), nan], axis=1).ravel()
        self.line(depth, strokes, **{"linewidth": 0.5} | look)
        self.line([s, s], list(x), **{"linewidth": 1.4} | look)

    def cable(self, start: tuple[float, float], end: tuple[float, float], slack: float = 0.0, **look: Any) -> None:
        """A cable from one point (s, x) to another; one that is too long by `slack` [m] sags to one side."""
        t = np.linspace(0.0, 1.0, 25 if slack > 0.0 else 2)
        (s0, x0), (s1, x1) = start, end
        reach = float(np.hypot(s1 - s0, x1 - x0))
        bow = np.sqrt(slack * (3.0 * reach + 2.0 * slack) / 8.0) * 4.0 * t * (1.0 - t) if slack > 0.0 else 0.0 * t
        self.line(s0 + t * (s1 - s0), x0 + t * (x1 - x0) + bow, **look)

    def spring(self, s: tuple[float, float], x: float, wide: float) -> None:
        ends = np.array([0.0, 0.12])
        t = np.concatenate([ends, np.linspace(0.12, 0.88, 2 * TURNS + 2)[1:-1], 1.0 - ends[::-1]])
        side = np.concatenate([[0.0, 0.0], wide * (-1.0) ** np.arange(2 * TURNS), [0.0, 0.0]])
        self.line(s[0] + t * (s[1] - s[0]), x + side, color=style.GREY)

    def damper(self, s: tuple[float, float], x: float, wide: float, cup: tuple[float, float], rod: float) -> None:
        """A dashpot: its cup, from `cup[0]` to `cup[1]`, stays; its piston goes with the far end, by a rod."""
        piston, grey = s[1] - rod, style.GREY
        self.line([s[0], cup[0]], [x, x], color=grey)
        self.line([cup[1], cup[0], cup[0], cup[1]], [x - wide, x - wide, x + wide, x + wide], color=grey)
        self.line([piston, piston, np.nan, piston, s[1]], [x - 0.8 * wide, x + 0.8 * wide, np.nan, x, x], color=grey)

    def muscle(
        self,
        length: float,
        x: float,
        silhouette: Silhouette | None,
        radius: float,
        fitting: float,
        colour: Any,
        label: str,
    ) -> None:
        """A muscle of a length [m] with its fittings; without a silhouette a dashed outline of one radius stands for
        it."""
        if silhouette is None:
            z, r = np.array([0.0, length]), np.array([radius, radius])
        else:
            z, r = silhouette.z + 0.5 * (length - silhouette.z[-1]), silhouette.r
        both = np.concatenate([z, z[::-1]]), x + np.concatenate([r, -r[::-1]])
        dashed = silhouette is None
        self.area(*both, facecolor=colour, linestyle="--" if dashed else "-", linewidth=1.2, gid=label, zorder=3)
        wide = float(r[0]) * 1.12, float(r[-1]) * 1.12
        self.box((-fitting, float(z[0])), (x - wide[0], x + wide[0]), zorder=4)
        self.box((float(z[-1]), length + fitting), (x - wide[1], x + wide[1]), zorder=4)


def _look(given: dict[str, Any], **usual: Any) -> dict[str, Any]:
    return usual | given


def valve_word(command: float, switching: bool) -> tuple[str, str]:
    """What a valve does by its command, and the colour of the word."""
    if switching:
        return f"pulses, mean {command:+.2f}", INK
    if abs(command) < 0.005:
        return "closed", style.GREY
    word, colour = ("fills", style.BLUE) if command > 0.0 else ("vents", style.VERMILLION)
    return (word if abs(command) > 0.995 else f"{word}, {100.0 * abs(command):.0f} %"), colour
