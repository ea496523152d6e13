"""The paper's explanatory figures, drawn by the code that also computes: Figs. 1 to 3."""

from __future__ import annotations

import math
from typing import Any

import attrs
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.model.cylinder import cylinder_volume
from mckibben.model.parameters import parameters
from mckibben.spec import Muscle
from mckibben.view import style
from mckibben.view.projection import MM, View
from mckibben.view.shape3d import draw_fibres, draw_rings, draw_surface, frame
from mckibben.view.tube import Tube

MAGIC = math.degrees(math.atan(math.sqrt(0.5)))
"""Angle of the largest volume [deg from the parallels]."""
SHAPES = {"A": 14.0, "B": 27.0, "C": 64.0, "D": 45.0}
"""Braid angles [deg] of the extensor A to B and of the contractor C to D."""


def fig1(muscle: Muscle) -> Figure:
    """Fig. 1: volume of a cylinder against its braid angle, the magic angle, and four of its shapes to one scale."""
    figure = style.new_figure(style.COLUMN, 4.1)
    grid = figure.add_gridspec(2, 1, height_ratios=(1.05, 1.0))
    _four_shapes(figure.add_subplot(grid[0]), muscle)
    axes = figure.add_subplot(grid[1])
    degrees = np.linspace(0.0, 90.0, 361)
    volume = np.asarray(cylinder_volume(np.radians(np.append(degrees, MAGIC)), parameters(muscle)))
    share = volume[:-1] / volume[-1]
    axes.plot(degrees, share, color=style.BLACK, linewidth=1.3)
    axes.axvline(MAGIC, color=style.GREY, linestyle="--", linewidth=0.8)
    axes.text(MAGIC + 1.0, 0.06, f"θ* = arctan(1/√2)\n    = {MAGIC:.2f}°", fontsize=6.5, color="0.25")
    for first, last, colour in (("A", "B", style.BLUE), ("C", "D", style.VERMILLION)):
        x = np.linspace(SHAPES[first], SHAPES[last], 40)
        y = np.interp(x, degrees, share)
        axes.plot(x, y, color=colour, linewidth=2.2)
        arrow = dict(arrowstyle="-|>", color=colour, lw=0, mutation_scale=13)
        axes.annotate("", (x[21], y[21]), (x[19], y[19]), arrowprops=arrow)
        for k, letter in ((0, first), (-1, last)):
            side = 1.0 if x[k] > MAGIC else -1.0
            axes.plot(x[k], y[k], marker="o", markersize=4.0, color=colour)
            axes.annotate(letter, (x[k], y[k]), (side * 7, 2), textcoords="offset points", ha="center",
                          fontsize=style.LABEL, fontweight="bold", color=colour)  # fmt: skip
    axes.set(xlim=(0, 90), ylim=(0, 1.1), xlabel=style.axis_label("braid angle θ from the parallels", "deg"),
             ylabel="Volume V / V(θ*)", xticks=range(0, 91, 15))  # fmt: skip
    style.tidy(axes)
    return figure


def _four_shapes(axes: Axes, muscle: Muscle) -> None:
    """A to B (extensor) and C to D (contractor), standing on one line, to one scale."""
    view, centre = View("vertical", 14.0, 15.0), 0.0
    titles = (("A", "B", style.BLUE, "extensor"), ("C", "D", style.VERMILLION, "contractor"))
    for first, last, colour, title in titles:
        start = centre
        for letter in (first, last):
            tube = Tube.cylinder(muscle, math.radians(SHAPES[letter]))
            radius = MM * float(tube.r[0])
            here = attrs.evolve(view, at=(centre + radius, 0.0))
            draw_surface(axes, tube, here, colour="0.97")
            draw_fibres(axes, tube, here, count=24, ink=colour, width=0.5)
            draw_rings(axes, tube, here, colour=colour)
            axes.text(centre + radius, -9, letter, ha="center", va="top", fontsize=style.LABEL, fontweight="bold",
                      color=colour)  # fmt: skip
            if letter == first:
                arrow = centre + 2 * radius
                axes.annotate("", (arrow + 14, 26), (arrow + 2, 26), arrowprops=dict(arrowstyle="-|>", color=colour))
            centre += 2 * radius + (16.0 if letter == first else 22.0)
        axes.text(0.5 * (start + centre - 22.0), -20, title, ha="center", va="top", fontsize=style.TICK, color=colour)
    frame(axes)


def fig2(muscle: Muscle) -> Figure:
    """Fig. 2: the mesh as made, and the frame of directors: d1 normal to it, d3 along the fibre, d2 = d3 x d1."""
    figure = style.new_figure(style.COLUMN, 3.3)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    view, tube = View("vertical", 20.0, 25.0), Tube.cylinder(muscle)
    draw_fibres(left, tube, view, front=False, ink="0.8", width=0.3, zorder=1.0)
    draw_rings(left, tube, view)
    draw_fibres(left, tube, view)
    R, H, theta0 = MM * tube.R0, MM * float(tube.z[-1]), math.degrees(tube.theta0)
    low, high = view.project([0, 0, 0])[0][1], view.project([0, 0, H])[0][1]
    left.annotate("", (-R - 6, high), (-R - 6, low), arrowprops=dict(arrowstyle="<->", lw=0.7, color="0.2"))
    left.text(-R - 8, 0.5 * (low + high), f"H$_0$ = {H:.4g} mm", rotation=90, ha="right", va="center", fontsize=6.5)
    left.annotate("", (R, high), (0, high), arrowprops=dict(arrowstyle="->", lw=0.8, color=style.VERMILLION,
                                                            shrinkA=0, shrinkB=0), zorder=6)  # fmt: skip
    left.text(0, high + 7, f"R$_0$ = {R:.4g} mm", ha="center", fontsize=6.5, color=style.VERMILLION)
    left.text(0, low - 9, f"N = {tube.fibres}, θ$_0$ = {theta0:.4g}°", ha="center", fontsize=6.5)
    _triad(left, view, np.array([-R - 19.0, low - 3.0]))
    frame(left)
    _directors(right, tube)
    style.assumption_note(figure, muscle)
    return figure


def _arrow(axes: Axes, start: Any, end: Any, colour: str, label: str = "", gap: float = 1.25) -> None:
    start, end = np.asarray(start), np.asarray(end)
    arrow = dict(arrowstyle="-|>", color=colour, lw=1.2, shrinkA=0, shrinkB=0, mutation_scale=8)
    axes.annotate("", end, start, zorder=7, arrowprops=arrow)
    axes.plot(*np.stack([start, end]).T, linestyle="none")  # for the limits
    if label:
        _write(axes, start + gap * (end - start), label, colour)


def _write(axes: Axes, place: Any, text: str, colour: str = "0.0", size: float = style.LABEL) -> None:
    x, y = place
    axes.text(float(x), float(y), text, color=colour, fontsize=size, ha="center", va="center", zorder=8)


def _triad(axes: Axes, view: View, at: np.ndarray, size: float = 9.0) -> None:
    for k in range(3):
        tip, _ = view.project(size * np.eye(3)[k])
        _arrow(axes, at, at + tip, "0.3", f"e$_{k + 1}$", gap=1.4)


def _directors(axes: Axes, tube: Tube) -> None:
    """A patch of the envelope with two fibres and the frame at their crossing."""
    view, at, phi0 = View("vertical", 22.0, -38.0), 0.5 * float(tube.v[-1]), 0.0
    s, c = math.sin(tube.theta0), math.cos(tube.theta0)
    half = 0.42
    phis, vs = np.linspace(-half, half, 25), at + half * tube.R0 * np.linspace(-1.0, 1.0, 25)
    edge = np.concatenate([
        tube.point(vs[0], phis), tube.point(vs, phis[-1]), tube.point(vs[-1], phis[::-1]), tube.point(vs[::-1], phis[0])
    ])  # fmt: skip
    axes.fill(*view.place(edge).T, facecolor="0.94", edgecolor="0.6", linewidth=0.6, zorder=1)
    along = np.linspace(-half, half, 41)
    for offset in (-1, 0, 1):
        for hand, colour in ((1, style.BLUE), (-1, "0.45")):
            phi = phi0 + along
            v = at + tube.R0 * (hand * along * s / c + offset * 0.34)
            inside = np.abs(v - at) <= half * tube.R0
            axes.plot(*view.place(tube.point(v, phi))[inside].T, color=colour, linewidth=1.6 if offset == 0
                      else 0.7, zorder=2)  # fmt: skip
    axes.plot(*view.place(tube.point(at, phis)).T, color="0.2", linewidth=0.8, linestyle="--", zorder=2)
    centre = view.place(tube.point(at, phi0))
    d1, d3 = np.array([1.0, 0.0, 0.0]), np.array([0.0, c, s])
    size = 6.2
    for k, (d, colour) in enumerate(((d1, style.VERMILLION), (np.cross(d3, d1), style.GREEN), (d3, style.BLUE))):
        _arrow(axes, centre, centre + size * view.project(d)[0], colour, f"d$_{k + 1}$",
               gap=1.33 if k == 2 else 1.2)  # fmt: skip
    turn = np.linspace(0.0, tube.theta0, 20)
    arc = view.project(3.4 * np.stack([0 * turn, np.cos(turn), np.sin(turn)], axis=-1))[0] + centre
    axes.plot(*arc.T, color="0.1", linewidth=0.9, zorder=4)
    _write(axes, centre + 1.35 * (arc[9] - centre), "θ$_0$", size=style.TICK)
    axes.set_title("frame of directors", fontsize=style.TICK)
    frame(axes, 0.12)


def fig3(muscle: Muscle) -> Figure:
    """Fig. 3: the infinitesimal cylinder at mid-length under axial force F and internal pressure P."""
    figure = style.new_figure(0.75 * style.COLUMN, 2.7)
    axes, view = figure.add_subplot(), View("vertical", 20.0, 0.0)
    theta = math.radians(50.0)
    v = np.linspace(0.0, 0.5 * float(muscle.braid.length), 41)
    R = float(muscle.braid.radius)
    tube = Tube(v, np.full(41, R), v * 0.5, R, theta, 2)
    draw_surface(axes, tube, view, colour="0.95")
    draw_rings(axes, tube, view, colour="0.2")
    r, h = MM * R, MM * float(tube.z[-1])
    low, high = (view.project([0.0, 0.0, z])[0] for z in (0.0, h))
    up = np.array([0.0, 1.0])
    _arrow(axes, high, high + 13.0 * up, style.BLACK, "F", 1.18)
    _arrow(axes, low - 5.0 * up, low - 18.0 * up, style.BLACK, "F", 1.18)
    for angle in (-75, -40, 40, 75):
        a = math.radians(angle)
        inner, outer = (view.project([x * math.cos(a), x * math.sin(a), h / 2])[0] for x in (1.06 * r, 1.5 * r))
        _arrow(axes, inner, outer, style.BLUE, "P" if abs(angle) == 75 else "", 1.3)
    rim = view.project([0.0, r, h])[0]
    axes.plot(*np.stack([high, rim]).T, color=style.VERMILLION, linewidth=1.1, zorder=6)
    _write(axes, 0.5 * (high + rim) + np.array([0.0, 1.9]), "r", style.VERMILLION)
    side = -r - 9
    axes.annotate("", (side - 6, high[1]), (side - 6, low[1]), arrowprops=dict(arrowstyle="<->", lw=0.7))
    for end in (low[1], high[1]):
        axes.plot([side - 8, -r], [end, end], color="0.6", linewidth=0.5, linestyle=":")
    for x in (-r, r):
        axes.plot([x, x], [low[1], high[1]], color="0.2", linewidth=0.8, zorder=3.2)
    axes.text(side - 8, 0.5 * (low[1] + high[1]), "dz", ha="right", va="center", fontsize=style.LABEL)
    _fibre_angle(axes, view, r, h)
    frame(axes, 0.08)
    return figure


def _fibre_angle(axes: Axes, view: View, r: float, h: float) -> None:
    """One fibre across the front of the infinitesimal cylinder, the parallel it crosses and the angle between them."""
    phi = np.linspace(-0.55, 0.55, 60)
    slope = 0.42 * h / 0.55
    fibre = np.stack([r * np.cos(phi), r * np.sin(phi), 0.5 * h + slope * phi], axis=-1)
    parallel = np.stack([r * np.cos(phi), r * np.sin(phi), np.full(60, 0.5 * h)], axis=-1)
    axes.plot(*view.project(fibre)[0].T, color=style.GREEN, linewidth=1.8, zorder=5)
    axes.plot(*view.project(parallel)[0].T, color="0.3", linewidth=0.8, linestyle="--", zorder=5)
    turn = np.linspace(0.0, math.atan2(slope, r), 20)
    arc = np.stack([np.full(20, r), 0.3 * r * np.cos(turn), 0.5 * h + 0.3 * r * np.sin(turn)], axis=-1)
    screen = view.project(arc)[0]
    axes.plot(*screen.T, color="0.1", linewidth=0.9, zorder=6)
    _write(axes, screen[9] + np.array([1.6, 0.8]), "θ")
