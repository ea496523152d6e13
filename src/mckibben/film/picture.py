"""One figure for all frames: the rig as drawn, and beside it the curves of what moves and of pressure."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from PIL import Image

from mckibben.film.frames import Frames, rig_of
from mckibben.film.inline import BetweenWalls, OnLine
from mckibben.film.layout import Layout, Scene
from mckibben.film.pen import Pen
from mckibben.film.pulley import Turning
from mckibben.film.silhouettes import Silhouette
from mckibben.results.motion import Motion
from mckibben.view import motion as curves
from mckibben.view import style
from mckibben.view.words import sentence

__all__ = ["SCALE", "Film"]

SCALE = ListedColormap(colormaps["Blues"](np.linspace(0.08, 0.9, 256)))
"""Colours of pressure: pale, but not white, where there is none; even steps to the eye."""


class Film:
    """Draws the frames of a motion, one after the other, on one figure whose camera and scales stay."""

    def __init__(
        self, motion: Motion, frames: Frames, silhouettes: list[tuple[Silhouette | None, ...]], speed: float,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        self.frames = frames
        self.dots: list[tuple[Any, np.ndarray | None]] = []
        self.size = size
        self.dpi = size[0] / style.PAGE
        self.figure = style.new_figure(style.PAGE, size[1] / self.dpi)
        self.figure.set_dpi(self.dpi)
        rig = rig_of(motion)
        top = max(float(motion.pressure.max()), 1.0)
        scale = ScalarMappable(Normalize(0.0, float(style.shown(top, "Pa"))), SCALE)
        wanted = curves.target(motion, "angle") if rig.turns else None
        target = None if wanted is None else np.interp(frames.time, motion.time, wanted)
        scene = Scene(rig, frames, silhouettes, lambda P: SCALE(P / top), target)
        self.layout: Layout = (BetweenWalls if rig.fixed else Turning if rig.turns else OnLine)(scene)
        self._panels(motion, scale)
        style.heading(self.figure, f"{motion.data.attrs['title']}{_load(rig)}; {_paced(speed)}")
        for line in _notes(motion, silhouettes):
            style.note(self.figure, line)
        self.still, self.pen = Pen(self.axes, self.layout.way), Pen(self.axes, self.layout.way)
        self.layout.still(self.still)
        self.show(0)
        canvas: Any = self.figure.canvas
        canvas.draw()  # lays it out once for all frames
        self.figure.set_layout_engine("none")
        for axes in self.figure.get_axes():
            _pinned(axes)
        self._moving(visible=False)
        canvas.draw()
        self.behind = canvas.copy_from_bbox(self.figure.bbox)
        self._moving(visible=True)

    def _panels(self, motion: Motion, scale: ScalarMappable) -> None:
        tall = self.layout.way != "right"
        drawn, beside = cast(Any, self.figure).subfigures(1, 2, width_ratios=(1.0, 1.5) if tall else (1.5, 1.0))
        self.axes = drawn.add_subplot()
        above, below = beside.subplots(2, 1)
        curves.moves(above, motion)
        curves.lines(below, motion, "pressure", "Pa")
        below.set_xlabel("Time (s)")
        for axes in (above, below):
            axes.set_xlim(float(motion.time[0]), float(motion.time[-1]))
            curves.marks(axes, motion)
            style.tidy(axes, legend="best")
        _ruled(self.axes, self.layout)
        where = "right" if tall else "bottom"
        style.colour_bar(drawn, scale, self.axes, style.axis_label("gauge pressure", "Pa"), location=where)
        frames, moving = self.frames, "angle" in motion.data
        shown = style.shown(frames.place[:, None], "rad") if moving else style.shown(frames.length, "m")
        pressure = style.shown(frames.pressure, "Pa")
        for axes, values in ((above, shown), (below, pressure)):
            mark = axes.axvline(float(frames.time[0]), color=style.BLACK, linewidth=0.6)
            self.dots.append((mark, None))
            for which in range(values.shape[1]):
                (dot,) = axes.plot(
                    frames.time[:1],
                    values[:1, which],
                    "o",
                    clip_on=False,
                    color=style.LINES[which],
                    markersize=4.5,
                    zorder=6,
                )
                self.dots.append((dot, values[:, which]))

    def show(self, k: int) -> None:
        """Draw a frame."""
        t = float(self.frames.time[k])
        self.pen.clear()
        self.layout.draw(self.pen, k)
        self.axes.set_title(f"{t:.3f} s", fontsize=style.LABEL + 2.0)
        for mark, values in self.dots:
            mark.set_xdata([t] if values is not None else [t, t])
            if values is not None:
                mark.set_ydata([float(values[k])])

    def image(self, k: int) -> Image.Image:
        """A frame in pixels: what moves is drawn over what does not, which is drawn once."""
        self.show(k)
        canvas: Any = self.figure.canvas
        canvas.restore_region(self.behind)
        renderer = canvas.get_renderer()
        for one in self._moving():
            one.draw(renderer)
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())

    def _moving(self, visible: bool = True) -> list[Any]:
        """What changes from frame to frame, from behind to the front; shown or not."""
        found = [*self.pen.made, self.axes.title, *(mark for mark, _ in self.dots)]
        for one in found:
            one.set_visible(visible)
        return sorted(found, key=lambda one: one.get_zorder())


def _pinned(axes: Any) -> None:
    """Have a legend stay where it is, whatever the dots cover."""
    legend = axes.get_legend()
    if legend is not None:
        place = axes.transAxes.inverted().transform(legend.get_window_extent())
        legend.set_loc(tuple(place[0]))


def _ruled(axes: Any, layout: Layout) -> None:
    """Axes true to scale, with a ruler along the muscle in mm from its fixed end."""
    (s0, s1), (x0, x1) = (tuple(1e3 * one for one in pair) for pair in layout.extent)
    along = layout.way == "right"
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim((s0, s1) if along else (x0, x1))
    axes.set_ylim((x0, x1) if along else (s1, s0) if layout.way == "down" else (s0, s1))
    longest = 1e3 * float(layout.scene.frames.length.max())
    ruler = axes.xaxis if along else axes.yaxis
    step = next(one for one in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000) if longest / one <= 7.0 or one == 1000)
    ticks = np.arange(0.0, longest + 0.5 * step, step)
    ruler.set_ticks(ticks)
    (axes.yaxis if along else axes.xaxis).set_ticks([])
    for side, spine in axes.spines.items():
        spine.set_visible(side == ("bottom" if along else "left"))
        spine.set_bounds(0.0, float(ticks[-1]))
        spine.set_linewidth(0.6)
    (axes.set_xlabel if along else axes.set_ylabel)("Length (mm)", fontsize=style.LABEL, loc=None)
    axes.tick_params(labelsize=style.TICK, width=0.6, length=2.5)


def _load(rig: Any) -> str:
    """What acts on the load, in words."""
    load = rig.load
    if rig.fixed:
        return ""
    turning = rig.turns
    units = ("N m", "N m s", "N m") if turning else ("N/m", "N s/m", "N")
    words = [
        f"{name} {value:.3g} {unit}"
        for name, value, unit in zip(
            ("spring", "damper", "friction"), (load.spring, load.damping, load.friction), units, strict=True
        )
        if value > 0.0
    ]
    return "".join(f", {one}" for one in words)


def _paced(speed: float) -> str:
    return "in real time" if speed == 1.0 else f"at {speed:g} times real time"


def _notes(motion: Motion, silhouettes: list[tuple[Silhouette | None, ...]]) -> list[str]:
    """What must be known, in sentences."""
    plain = any(one is None for some in silhouettes for one in some)
    rubs = any(muscle.friction is not None for muscle in rig_of(motion).muscles)
    found = [
        *((f"not complete: {motion.reason}",) if motion.reason else ()),
        *(("a dashed outline stands for a muscle whose shape is not known: outside of the map, or no stable state",)
          if plain else ()),
        *(("shapes are those without friction at the crossings",) if rubs else ()),
        *motion.notes,
    ]  # fmt: skip
    return [" ".join(sentence(line) for line in found)] if found else []
