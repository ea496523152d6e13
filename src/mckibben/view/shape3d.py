"""The muscle in three dimensions: surfaces of revolution and fibres in parallel projection.

Only what faces the viewer is drawn, from back to front, so that it looks right in vector files. The picture is in plain
2-D axes of equal aspect, without empty margins, and so can be part of any other figure.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import Collection, LineCollection, PolyCollection
from matplotlib.colors import Normalize, to_rgba
from numpy.typing import NDArray

from mckibben.view.projection import MM, View
from mckibben.view.tube import FACETS, Floats, Tube

FITTING = "0.72"
"""Grey of the end fittings."""


def draw_surface(
    axes: Axes, tube: Tube, view: View, *, values: Any = None, cmap: str = "viridis", norm: Normalize | None = None,
    colour: str = "0.93",
) -> ScalarMappable:  # fmt: skip
    """The surface where it faces the viewer, coloured by `values` along v, or plain; returns what a bar needs."""
    v = tube.even()
    phi = np.linspace(0.0, 2.0 * np.pi, 2 * FACETS + 1)
    screen = view.place(tube.point(v[:, None], phi[None, :]))
    vm, pm = 0.5 * (v[1:] + v[:-1])[:, None], 0.5 * (phi[1:] + phi[:-1])[None, :]
    _, depth = view.project(MM * tube.point(vm, pm))
    normal_screen, facing = view.project(tube.normal(vm, pm))
    corners = np.stack([screen[:-1, :-1], screen[1:, :-1], screen[1:, 1:], screen[:-1, 1:]], axis=2)
    field = np.interp(vm[:, 0], tube.v, np.zeros_like(tube.v) if values is None else np.asarray(values))
    colours = ScalarMappable(norm or Normalize(float(np.min(field)), float(np.max(field))), colormaps[cmap])
    base = np.tile(to_rgba(colour), (len(field), 1)) if values is None else colours.to_rgba(field)
    # Faint shading, so that colours can be compared with the bar.
    light = 0.86 + 0.14 * np.clip(0.85 * facing + 0.5 * normal_screen[..., 1], 0.0, 1.0)
    rgba = np.repeat(base[:, None, :], facing.shape[1], axis=1)
    rgba[..., :3] *= light[..., None]
    seen = facing > -1e-3
    order = np.argsort(depth[seen])
    faces = rgba[seen][order]
    patches: Any = corners[seen][order]
    _add(axes, PolyCollection(patches, facecolors=faces, edgecolors=faces, linewidths=0.35, zorder=2.0))
    return colours


def draw_fibres(
    axes: Axes, tube: Tube, view: View, *, count: int | None = None, front: bool = True, ink: Any = "0.1",
    width: float = 0.35, zorder: float = 3.0,
) -> None:  # fmt: skip
    """The fibres of both hands where they face the viewer (or, with front=False, where they turn away)."""
    number = tube.fibres // 2 if count is None else max(1, count // 2)
    strokes: list[Floats] = []
    for hand in (1, -1):
        for k in range(number):
            v, phi = tube.fibre(2.0 * np.pi * k / number, hand)
            _, facing = view.project(tube.normal(v, phi))
            strokes += _runs(view.place(tube.point(v, phi)), facing >= 0.0 if front else facing < 0.0)
    _add(axes, LineCollection(strokes, colors=ink, linewidths=width, zorder=zorder, capstyle="round"))


def ink_on(rgba: Floats) -> tuple[float, float, float, float]:
    """Colour (red, green, blue, opacity) of faint lines on colours (n, 4): white if most are dark, else black."""
    light = rgba[:, :3] @ np.array([0.299, 0.587, 0.114])
    return (1.0, 1.0, 1.0, 0.4) if float(np.median(light)) < 0.5 else (0.0, 0.0, 0.0, 0.4)


def draw_rings(axes: Axes, tube: Tube, view: View, *, width: float = 0.8, colour: str = "0.25") -> None:
    """The circles at both ends; of the one further away only the half that faces the viewer."""
    phi = np.linspace(0.0, 2.0 * np.pi, 181)
    for v in (tube.v[0], tube.v[-1]):
        screen = view.place(tube.point(v, phi))
        _, facing = view.project(tube.normal(v, phi))
        seen = facing >= 0.0 if v == tube.v[0] or view.tilt <= 0 else np.ones_like(facing, bool)
        axes.add_collection(LineCollection(_runs(screen, seen), colors=colour, linewidths=width, zorder=3.2))


def draw_fittings(axes: Axes, tube: Tube, view: View, length: float = 5e-3) -> None:
    """Grey end fittings of the tube's end radii."""
    for end, sign in ((0, -1.0), (-1, 1.0)):
        z = tube.z[end] + np.array([0.0, 0.5, 1.0]) * sign * length
        if sign < 0.0:
            z = z[::-1]
        drum = Tube(np.array([0.0, 0.5, 1.0]), np.full(3, tube.r[end]), z, tube.R0, tube.theta0, 0)
        draw_surface(axes, drum, view, colour=FITTING)
        towards = np.sign(np.sin(np.deg2rad(view.tilt))) == sign
        if towards:
            disc = view.place(drum.point(drum.v[end], np.linspace(0.0, 2.0 * np.pi, 121)))
            axes.fill(disc[:, 0], disc[:, 1], facecolor="0.82", edgecolor="0.4", linewidth=0.4, zorder=2.5)


def draw_muscle(
    axes: Axes, tube: Tube, view: View | None = None, *, values: Any = None, cmap: str = "viridis",
    norm: Normalize | None = None, count: int | None = None, fittings: bool = True,
) -> ScalarMappable:  # fmt: skip
    """A whole muscle: fittings, surface coloured by a field along v, fibres. Returns what a colour bar needs."""
    view = view or View()
    if fittings:
        draw_fittings(axes, tube, view)
    colours = draw_surface(axes, tube, view, values=values, cmap=cmap, norm=norm)
    ink = "0.25" if values is None else ink_on(np.asarray(colours.to_rgba(np.asarray(values))))
    draw_fibres(axes, tube, view, count=count, ink=ink)
    frame(axes)
    return colours


def frame(axes: Axes, margin: float = 0.02) -> None:
    """Equal aspect, no spines, limits around what was drawn (mm on the screen)."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.margins(margin)
    axes.autoscale_view()


def _add(axes: Axes, collection: Collection) -> None:
    """Add a collection that the layout does not measure: it lies inside the axes, and has thousands of paths."""
    collection.set_in_layout(False)
    axes.add_collection(collection)


def _runs(points: Floats, seen: Sequence[bool] | NDArray[np.bool_]) -> list[Floats]:
    """Pieces of a polyline, each of consecutive points that are seen."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(seen, int), [0]])))
    return [points[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1]
