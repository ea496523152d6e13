"""The pictures of a datasheet: the muscle with its dimensions, and force against contraction."""

from __future__ import annotations

import math
import re
from typing import Any

import attrs
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.measure.mass import over_fibres
from mckibben.results.verdict import Verdict
from mckibben.sheet.facts import Facts
from mckibben.sheet.levels import stable
from mckibben.spec import Muscle
from mckibben.spec.winding import extremes, turned
from mckibben.units import show
from mckibben.view import style

__all__ = ["curves", "drawing", "svg"]

LONGEST = 7.0
"""Length over diameter from which a muscle is drawn with a piece left out."""
STRANDS = 24
"""Fibres of one hand that are drawn at most."""
WIDTH = 7.0
"""Width [inch] of a picture."""
LEFT, RIGHT = 1.9, 1.3
"""Of that, for words beside the drawing."""
TALLEST = 3.3
"""Greatest height [inch] of the drawing."""
GAP = 0.25
"""Room for the mark of a piece left out, in diameters."""


@attrs.frozen
class Outline:
    """The outline of a muscle from the side [mm], maybe with a piece left out of the middle."""

    v: np.ndarray
    r: np.ndarray
    z: np.ndarray
    cut: float  #: length left out; 0 for none

    @classmethod
    def of(cls, v: np.ndarray, r: np.ndarray, z: np.ndarray, longest: float) -> Outline:
        """The outline, at most `longest` long."""
        even = np.linspace(v[0], v[-1], 2401)
        r, z = np.interp(even, v, r), np.interp(even, v, z)
        return cls(even, r, z, max(0.0, float(z[-1] - longest)))

    def pieces(self, gap: float) -> list[tuple[np.ndarray, float]]:
        """Which points each piece has, and by how much it is moved along."""
        if not self.cut:
            return [(np.ones(len(self.z), bool), 0.0)]
        half = 0.5 * (self.z[-1] - self.cut)
        return [(self.z <= half, 0.0), (self.z >= self.z[-1] - half, gap - self.cut)]

    def shown(self, gap: float) -> float:
        """Length on the paper."""
        return float(self.z[-1] - (self.cut - gap if self.cut else 0.0))


def drawing(facts: Facts) -> Figure:
    """The muscle as made, and free at the largest pressure if that exists, side by side to one scale."""
    muscle = facts.muscle
    braid = muscle.braid
    R, H = 1e3 * float(braid.radius), 1e3 * float(braid.length)
    longest = LONGEST * 2.0 * R
    straight = np.linspace(0.0, H, 61)
    made = Outline.of(straight, np.full(61, R), straight, longest)
    sides, words = [made], ["as made"]
    free, k = facts.free
    if free.verdict[k] == Verdict.STABLE:
        r, z = 1e3 * free.column("r")[k], 1e3 * free.column("z")[k]
        sides.append(Outline.of(1e3 * free.column("v"), r, z, longest))
        words.append(f"free at {show(facts.pressure, 'Pa', 3)}")
    gap = GAP * 2.0 * R
    lead = 0.22 * 2.0 * R
    span = max(side.shown(gap) for side in sides)
    heights = [2.0 * float(side.r.max()) for side in sides]
    drop = max(R, 0.09 * span)
    total = sum(heights) + 1.4 * drop * len(sides)
    scale = max((span + 4.0 * lead) / (WIDTH - LEFT - RIGHT), total / TALLEST)  # mm per inch
    figure = Figure(figsize=(WIDTH, total / scale))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    top = 0.0
    for side, height, word in zip(sides, heights, words, strict=True):
        middle = top - 0.5 * height
        length = float(side.z[-1]) + 1e3 * float(muscle.rest_length - braid.length)
        _muscle(axes, side, muscle, middle, gap, lead)
        _dimensions(axes, side, middle, gap, lead, drop, length, muscle, word, side is made)
        top = middle - 0.5 * height - 1.4 * drop
    axes.set_axis_off()
    middle = 0.5 * (WIDTH - LEFT - RIGHT) * scale  # the drawing stands in the middle of what the words leave
    begin = 0.5 * span - middle - LEFT * scale
    axes.set(xlim=(begin, begin + WIDTH * scale), ylim=(0.05 * drop - total, 0.05 * drop))
    return figure


def _muscle(axes: Axes, side: Outline, muscle: Muscle, middle: float, gap: float, lead: float) -> None:
    """Fittings, body and the fibres that face the viewer."""
    braid = muscle.braid
    winds = np.linspace(0.0, 1.0, 2049), turned(braid, np.linspace(0.0, 1.0, 2049))
    count = min(int(braid.fibres) // 2, STRANDS)
    for keep, shift in side.pieces(gap):
        z, r, v = side.z[keep] + shift, side.r[keep], side.v[keep]
        axes.fill_between(z, middle - r, middle + r, facecolor="0.93", edgecolor="0.2", linewidth=0.7, zorder=2)
        for hand in (1, -1):
            for k in range(count):
                phi = 2.0 * math.pi * k / count + hand * np.interp(1e-3 * v / float(braid.length), *winds)
                front = np.cos(phi) >= 0.0
                axes.plot(z, np.where(front, middle + r * np.sin(phi), np.nan), color="0.35", linewidth=0.35, zorder=3)
    for end, sign, which in ((0.0, -1.0, 0), (side.shown(gap), 1.0, -1)):
        drum, r = [end, end + sign * lead], float(side.r[which])
        axes.fill_between(drum, middle - r, middle + r, facecolor="0.7", edgecolor="0.2", linewidth=0.7, zorder=2)
    if side.cut:
        half, r = 0.5 * (side.z[-1] - side.cut), 1.25 * float(side.r.max())
        for at in (half, half + gap):
            y = np.linspace(middle - r, middle + r, 41)
            wave = 0.12 * gap * np.sin(np.linspace(0.0, 4.0 * math.pi, 41))
            axes.plot(at + wave, y, color="0.2", linewidth=0.6, zorder=4)


def _dimensions(
    axes: Axes, side: Outline, middle: float, gap: float, lead: float, drop: float, length: float, muscle: Muscle,
    word: str, made: bool,
) -> None:  # fmt: skip
    """Length below, diameter at the right, the braid angle and a word at the left."""
    end, r = side.shown(gap), float(side.r[len(side.r) // 2])
    below = middle - float(side.r.max()) - 0.4 * drop
    arrow = {"arrowstyle": "<->", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0, "color": style.BLUE}
    for at in (0.0, end):
        axes.plot([at, at], [middle - float(side.r[0]), below - 0.1 * drop], color=style.BLUE, linewidth=0.4)
    axes.annotate("", (0.0, below), (end, below), arrowprops=arrow)
    text: dict[str, Any] = {"fontsize": style.TICK, "color": style.BLUE}
    axes.text(
        0.5 * end,
        below - 0.06 * drop,
        f"{_mm(length)}{' (not to scale)' if side.cut else ''}",
        ha="center",
        va="top",
        **text,
    )
    right = end + 2.2 * lead
    axes.plot([0.5 * end, right + 0.5 * lead], [middle + r] * 2, color=style.BLUE, linewidth=0.4)
    axes.plot([0.5 * end, right + 0.5 * lead], [middle - r] * 2, color=style.BLUE, linewidth=0.4)
    axes.annotate("", (right, middle - r), (right, middle + r), arrowprops=arrow)
    said = "to the fibres' centres" if muscle.braid.fibre.diameter is None else "over the fibres"
    outer = 1e3 * float(over_fibres(1e-3 * r, muscle))
    axes.text(right + 0.5 * lead, middle, f" ⌀ {_mm(outer)}\n {said}", ha="left", va="center", **text)
    angles = dict.fromkeys(f"{math.degrees(angle):.3g}" for angle in extremes(muscle.braid))
    angle = f"\nbraid {'–'.join(angles)}° from the circles" if made else ""
    axes.text(-2.0 * lead, middle, f"{word}{angle}", ha="right", va="center", fontsize=style.TICK)


def _mm(value: float) -> str:
    return f"{value:.4g} mm"


def curves(facts: Facts) -> Figure:
    """Force against contraction, a curve for each pressure, with the free contraction at its end."""
    figure = style.new_figure(WIDTH, 2.9)
    axes = figure.add_subplot()
    colours = colormaps[style.SEQUENCE](np.linspace(0.82, 0.08, len(facts.levels)))
    for level, colour in zip(facts.levels, colours, strict=True):
        curve = level.curve
        good = stable(curve)
        label = show(level.pressure, "Pa", 3) + ("" if good.all() else f" ({(~good).sum()} of {len(good)} not stable)")
        axes.plot(100.0 * np.where(good, curve.contraction, np.nan), np.where(good, curve.force, np.nan), color=colour,
                  linewidth=1.3, marker="o", markersize=2.0, label=label)  # fmt: skip
    axes.axhline(0.0, color="0.3", linewidth=0.6)
    axes.set(xlabel="Contraction (%)", ylabel=style.axis_label("force", "N"))
    style.tidy(axes, "best")
    return figure


def svg(figure: Figure) -> str:
    """A figure as an SVG element that can stand in a page: without what comes before it, and without metadata."""
    text = style.picture(figure, "svg").decode("utf-8")
    text = text[text.index("<svg") :]
    return re.sub(r"\s*<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
