"""The interactive picture of a motion: what moves, pressure, command, force, air and energies over time."""

from __future__ import annotations

from typing import Any

import numpy as np

from mckibben.results.motion import Motion
from mckibben.units import DISPLAY, from_si
from mckibben.view import style, web
from mckibben.view.motion import MANY, energies, names, outside, target, words

__all__ = ["moved"]


def moved(motion: Motion) -> web.Web:
    """Six panels over time, which enlarge together; a line through all tells the values at a time."""
    figure = web.panels(3, 2, shared_xaxes="all", vertical_spacing=0.05, horizontal_spacing=0.1)
    turns = "angle" in motion.data
    moves, unit = ("angle", "rad") if turns else ("length", "m")
    if turns:
        _line(figure, motion, style.shown(motion.angle, unit), DISPLAY[unit], "angle", style.BLUE, (1, 1))
    else:
        _lines(figure, motion, "length", unit, (1, 1))
    wanted = target(motion, moves)
    if wanted is not None:
        _line(
            figure,
            motion,
            style.shown(wanted, unit),
            DISPLAY[unit],
            "target",
            web.GREY,
            (1, 1),
            line_dash="dash",
            showlegend=True,
        )
    figure.update_yaxes(title_text=style.axis_label(moves, unit), row=1, col=1)
    for name, label, si, place in (
        ("pressure", "gauge pressure", "Pa", (1, 2)),
        ("force", "force", "N", (2, 1)),
        ("command", "command", "1", (2, 2)),
    ):
        _lines(figure, motion, name, si, place)
        figure.update_yaxes(title_text=style.axis_label(label, si), row=place[0], col=place[1])
    figure.update_yaxes(tickvals=[-1.0, 0.0, 1.0], ticktext=["vent", "0", "fill"], row=2, col=2)
    _line(figure, motion, motion.of("consumed"), "normal L", "air taken", style.BLACK, (3, 1))
    figure.update_yaxes(title_text="Air taken (normal L)", row=3, col=1)
    for label, (values, colour) in energies(motion).items():
        _line(figure, motion, from_si(values, "J"), "J", label, colour, (3, 2), legend="legend2")
    figure.update_yaxes(title_text="Energy (J)", row=3, col=2)
    for column in (1, 2):
        figure.update_xaxes(title_text="Time (s)", row=3, col=column)
    _marks(figure, motion)
    figure.update_layout(hovermode="x", legend={"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": 0.0})
    last = figure.layout.xaxis6.domain[0], figure.layout.yaxis6.domain[1]
    figure.update_layout(legend2={"x": last[0] + 0.01, "y": last[1], "yanchor": "top", "font": {"size": 12}})
    figure.update_xaxes(
        hoverformat=".5~g", showspikes=True, spikemode="across", spikecolor=web.GREY, spikethickness=1, spikedash="dot"
    )
    heading, notes = words(motion)
    return web.Web(figure, heading, tuple(notes), 640)


def _lines(figure: Any, motion: Motion, name: str, unit: str, place: tuple[int, int]) -> None:
    """A quantity over time, of two muscles a line each; a command as the steps that it is."""
    values = style.shown(motion.of(name).reshape(len(motion.time), -1), unit)
    for k, muscle in enumerate(names(motion)):
        options: dict[str, Any] = {"line_shape": "hv"} if name == "command" else {}
        if muscle:
            options |= {"legendgroup": muscle, "name": web.safe(muscle), "showlegend": place == (1, 2)}
        said = ", ".join(part for part in (muscle, name) if part)
        _line(figure, motion, values[:, k], DISPLAY.get(unit, unit), said, style.LINES[k], place, **options)


def _line(
    figure: Any, motion: Motion, shown: Any, unit: str, name: str, colour: str, place: tuple[int, int], **options: Any
) -> None:
    """Values in the unit shown, over time, in one panel."""
    said = f"{web.safe(name)}: %{{y:.5~g}} {unit if unit != '1' else ''}".rstrip()
    look = {"line_color": colour, "line_width": 2, "name": web.safe(name), "showlegend": "legend" in options}
    figure.add_scatter(
        x=motion.time, y=np.asarray(shown, float), mode="lines", hovertemplate=said + "<extra></extra>",
        row=place[0], col=place[1], **look | options,
    )  # fmt: skip


def _marks(figure: Any, motion: Motion) -> None:
    """Times outside of the map shaded, and events as lines; the first panel tells what happened."""
    edges = np.flatnonzero(np.diff(outside(motion).astype(int), prepend=0, append=0))
    last = len(motion.time) - 1
    for start, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        figure.add_vrect(
            motion.time[start], motion.time[min(end, last)], fillcolor="#e6e6e6", line_width=0, layer="below"
        )
    events = motion.events
    if not 0 < len(events) <= MANY:
        return
    for t in events["time"].tolist():
        figure.add_vline(t, line={"color": web.GREY, "width": 1, "dash": "dot"})
    moves, unit = ("angle", "rad") if "angle" in motion.data else ("length", "m")
    first = motion.of(moves).reshape(len(motion.time), -1)[:, 0]
    at = np.interp(events["time"].to_numpy(), motion.time, style.shown(first, unit))
    told = [web.hover(str(event), ()) for event in events["event"]]
    look = {"symbol": "diamond-open", "size": 8, "color": style.BLACK}
    figure.add_scatter(**web.dots(events["time"], at, told, mode="markers", marker=look, name="event"), row=1, col=1)
