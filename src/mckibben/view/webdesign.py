"""Interactive pictures of a design: its front, in which each design tells its numbers and goals; or the best alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from mckibben.results.design import Designed
from mckibben.spec.wishes import text_of
from mckibben.view import style, web
from mckibben.view.design import FULL, demands, goal, places, room, words

__all__ = ["best", "front"]

BEST = "nearest to the best of every goal"
SHORT = 34
"""Letters of a line of a name beside an axis."""


def front(design: Designed) -> web.Web:
    """The goals against each other, three of them in space, and what is free along the first."""
    values = design.data["front_goal"].values
    columns = [goal(design, k, values[:, k]) for k in range(values.shape[1])]
    at = [goal(design, k, one)[0] for k, one in enumerate(design.data["goal_value"].values)]
    texts = [web.hover(f"design {k}", told) for k, told in enumerate(_designs(design))]
    chosen = web.hover(BEST, _best(design))
    space = len(columns) > 2
    figure = web.panels(
        1, 2, specs=[[{"type": "scene" if space else "xy"}, {}]], column_widths=[0.58, 0.42], horizontal_spacing=0.12
    )
    place, star = {"row": 1, "col": 1}, {"size": 13, "color": style.VERMILLION, "symbol": "star"}
    labels = [web.wrapped(label, 46) + f"<br>{better}" for _, label, better in columns]
    if space:
        colours = {"color": columns[2][0], "colorscale": web.colour_scale(style.SEQUENCE), "size": 4}
        points = web.dots(columns[0][0], columns[1][0], texts, mode="markers", name="front", marker=colours)
        figure.add_scatter3d(**points, z=np.asarray(columns[2][0], float), showlegend=False, **place)
        one = web.dots(
            [at[0]], [at[1]], [chosen], mode="markers", name=BEST, marker=star | {"size": 6, "symbol": "diamond"}
        )
        figure.add_scatter3d(**one, z=[float(at[2])], **place)
        axes = ("xaxis", "yaxis", "zaxis")
        titles = (web.wrapped(f"{label}, {better}", 28) for _, label, better in columns)
        named = {axis: {"title": {"text": title, "font": {"size": 11}}, "tickfont": {"size": 10}}
                 for axis, title in zip(axes, titles, strict=False)}  # fmt: skip
        figure.update_scenes(named | {"camera": {"eye": {"x": 1.7, "y": -1.8, "z": 0.8}}})
    else:
        points = web.dots(
            columns[0][0], columns[1][0], texts, mode="markers", name="front", marker={"size": 7, "color": style.BLUE}
        )
        figure.add_scatter(**points, **place)
        figure.add_scatter(**web.dots([at[0]], [at[1]], [chosen], mode="markers", name=BEST, marker=star), **place)
        figure.update_xaxes(title_text=labels[0], **place)
        figure.update_yaxes(title_text=labels[1], **place)
    for said, part, colour in places(design):
        look = {"size": 6, "color": colour}
        figure.add_scatter(
            **web.dots(columns[0][0], part, texts, mode="markers", name=web.safe(said), marker=look),
            legend="legend2",
            row=1,
            col=2,
        )
    figure.update_xaxes(title_text=web.wrapped(columns[0][1], 46), row=1, col=2)
    figure.update_yaxes(title_text="Place in its range (%)", range=[-4.0, 104.0], row=1, col=2)
    right = figure.layout.xaxis.domain if space else figure.layout.xaxis2.domain
    figure.update_layout(legend2={"yanchor": "bottom", "y": 1.01, "x": right[0], "font": {"size": 12}})
    return _worded(figure, design)


def best(design: Designed) -> web.Web:
    """Force over contraction of the best design with what was demanded, and the room left in each limit."""
    data, limits = design.data, len(design.data["limit"])
    figure = web.panels(1, 2 if limits else 1, column_widths=[0.6, 0.4] if limits else None, horizontal_spacing=0.22)
    for k, pressure in enumerate(data["curve"].values.tolist()):
        x, y = (data[name].values[k] for name in ("curve_contraction", "curve_force"))
        name = text_of(pressure, "Pa")
        rows = {"contraction": _texts(x, "1", "%"), "force": _texts(y, "N"), "pressure": [name] * len(x)}
        look = {"color": style.LINES[k % len(style.LINES)], "width": 2}
        figure.add_scatter(
            **web.dots(100.0 * x, y, web.rows_of(rows), mode="lines", line=look, name=name), row=1, col=1
        )
    states = design.states
    told = [web.hover(str(name), ((str(one).replace("_", " "), str(value)) for one, value in row.items()))
            for name, row in states.iterrows()]  # fmt: skip
    figure.add_scatter(
        **web.dots(100.0 * data["contraction"].values, data["force"].values, told, mode="markers",
                   marker={"size": 7, "color": style.BLACK}, name="states asked for"),
        row=1, col=1,
    )  # fmt: skip
    shown = set[str]()
    for x, y, marker, name in demands(design):
        look = {"symbol": web.SYMBOLS[marker], "size": 12, "color": style.VERMILLION, "line": {"width": 2}}
        said = web.hover(name, (("contraction", f"{x:.4g} %"), ("force", f"{y:.4g} N")))
        figure.add_scatter(
            **web.dots([x], [y], [said], mode="markers", marker=look, name=name),
            legendgroup=name, showlegend=name not in shown, row=1, col=1,
        )  # fmt: skip
        shown.add(name)
    figure.add_hline(0.0, line={"color": web.GREY, "width": 1}, row=1, col=1)
    figure.update_xaxes(title_text=style.axis_label("contraction", "%"), row=1, col=1)
    figure.update_yaxes(title_text=style.axis_label("force", "N"), row=1, col=1)
    if limits:
        _room(figure, design)
    return _worded(figure, design)


def _room(figure: Any, design: Designed) -> None:
    """Bars of the room left in each limit."""
    left, colours = room(design)
    names = [web.wrapped(str(name), SHORT) for name in design.data["limit"].values]
    told = [web.hover(limit, (("value", value), ("room left", f"{one:g} %"))) for limit, value, one in _limits(design)]
    cut, at = np.round(np.clip(left, -FULL, FULL), 2) + 0.0, list(range(len(left)))
    figure.add_bar(
        x=cut, y=at, orientation="h", marker={"color": colours}, width=0.5, showlegend=False, customdata=told,
        text=[web.safe(value) for _, value, _ in _limits(design)], textposition="outside", cliponaxis=False,
        hovertemplate="%{customdata}<extra></extra>", row=1, col=2,
    )  # fmt: skip
    ends = [min(-2.0, 1.3 * float(cut.min())), max(10.0, 1.45 * float(cut.max()))]
    figure.update_xaxes(
        title_text="Room left (% of the limit)", range=ends, zeroline=True, zerolinecolor=style.BLACK, row=1, col=2
    )
    figure.update_yaxes(
        tickvals=at, ticktext=names, range=[len(at) - 0.4, -0.6], showgrid=False, tickfont={"size": 11}, row=1, col=2
    )


def _designs(design: Designed) -> Iterator[list[tuple[str, str]]]:
    """What each design of the front is: its free numbers, then its goals."""
    data = design.data
    about = list(zip(data["goal"].values, data["goal_unit"].values, data["goal_display"].values, strict=True))
    for said, goals in zip(data["front_said"].values, data["front_goal"].values.tolist(), strict=True):
        numbers = list(zip(design.numbers, map(str, said), strict=True))
        shown = [(str(name), text_of(value, str(unit), str(display), 5))
                 for value, (name, unit, display) in zip(goals, about, strict=True)]  # fmt: skip
        yield [*numbers, *shown]


def _best(design: Designed) -> list[tuple[str, str]]:
    """What the best design is: its free numbers, goals and limits."""
    data = design.data
    goals = zip(design.goals.items(), data["goal_unit"].values, data["goal_display"].values, strict=True)
    numbers = [(name, str(row["value"])) for name, row in design.table.iterrows()]
    shown = [(name, text_of(value, str(unit), str(display), 5)) for (name, value), unit, display in goals]
    return [*numbers, *shown, *((limit, f"{value}, room {one:g} %") for limit, value, one in _limits(design))]


def _limits(design: Designed) -> Iterator[tuple[str, str, float]]:
    for _, row in design.limits.iterrows():
        yield str(row["limit"]), str(row["value"]), float(row["room [%]"])


def _texts(values: Any, unit: str, display: str = "") -> list[str]:
    return [text_of(float(value), unit, display) for value in values]


def _worded(figure: Any, design: Designed) -> web.Web:
    heading, notes = words(design)
    figure.update_layout(legend={"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": 0.0})
    return web.Web(figure, heading, (*notes, style.assumption(design.muscle)), 520)
