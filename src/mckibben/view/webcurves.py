"""Interactive curves of a result: each state tells all its numbers; measured points over them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mckibben.data.branches import UNKNOWN
from mckibben.data.compare import compare
from mckibben.data.values import Data
from mckibben.results import told
from mckibben.results.result import Result
from mckibben.results.rows import rows
from mckibben.spec.errors import SpecError
from mckibben.view import curves, style, web
from mckibben.view.measured import MeasuredPoints, points, said
from mckibben.view.words import headline, lost

__all__ = ["family", "measured", "states"]


def states(result: Result) -> web.Web:
    """The curve of a test as `plot` draws it; a protocol state by state, and its force over the length."""
    if curves.driven(result) == "state":
        return _protocol(result)
    figure = web.panels()
    x, y = curves.driven(result), curves.drawn(result)
    _line(figure, result, x, y, showlegend=False)
    figure.update_xaxes(title_text=curves.label(x))
    figure.update_yaxes(title_text=curves.label(y))
    return web.Web(figure, headline(result), (lost(result), style.assumption(result.muscle)))


def family(results: Mapping[str, Result]) -> web.Web:
    """Curves of several results of one kind of test, by their names."""
    figure, first = web.panels(), next(iter(results.values()))
    x, y = curves.driven(first), curves.drawn(first)
    for k, (name, result) in enumerate(results.items()):
        _line(figure, result, x, y, name, style.LINES[k % len(style.LINES)])
    figure.update_xaxes(title_text="State" if x == "state" else curves.label(x))
    figure.update_yaxes(title_text=curves.label(y))
    heading = f"{first.test.kind[:1].upper()}{first.test.kind[1:]} tests: {', '.join(results)}"
    notes = (f"{name}: {note}" for name, result in results.items() if (note := lost(result)))
    return web.Web(figure, heading, (*notes, style.assumption(first.muscle)))


def measured(results: Mapping[str, Result], data: Data) -> web.Web:
    """A curve, its name "", or several, with the measured points that belong to them and the differences noted."""
    alone = len(results) == 1 and "" in results
    made = states(results[""]) if alone else family(results)
    trouble, notes = None, []
    for k, (name, result) in enumerate(results.items()):
        try:
            found = points(result, data)
            notes.append(said(f"{name}: model" if name else "Model", data, compare(result, data)))
        except SpecError as error:  # of a family, the bench may lack one
            trouble = error
            continue
        _points(made.figure, found, name, style.GREEN if alone else style.LINES[k % len(style.LINES)])
    if not notes:
        assert trouble is not None
        raise trouble
    if alone:
        made.figure.data[0].update(name="model", showlegend=True)
    return web.Web(made.figure, made.heading, (*notes, *made.notes))


def _points(figure: Any, found: MeasuredPoints, name: str, colour: str) -> None:
    """Measured points, a marker for each branch; they lie below the curve."""
    told_of = found.told()
    for branch, marker, of in found.branches():
        label = ", ".join(part for part in (name, "measured", "" if branch == UNKNOWN else branch) if part)
        said_of = [web.hover(label, told_of[k]) for k in np.flatnonzero(of)]
        look = {"symbol": web.SYMBOLS[marker], "size": 7, "color": colour}
        figure.add_scatter(
            **web.dots(found.x[of], found.y[of], said_of, mode="markers", marker=look, name=web.safe(label), zorder=-1)
        )


def _line(
    figure: Any, result: Result, x: str, y: str, name: str = "", colour: str = style.BLUE, row: int = 1, **options: Any
) -> None:
    """One curve with its states, those that are not stable marked."""
    xs, ys = (np.arange(len(result), dtype=float) if one == "state" else curves.column(result, one) for one in (x, y))
    place = {"row": row, "col": 1}
    look = {"line": {"color": colour, "width": 2}, "marker": {"size": 6}, "mode": "lines+markers"}
    figure.add_scatter(**web.dots(xs, ys, texts(result, name), name=web.safe(name), **look, **options), **place)
    _marks(figure, result, xs, ys, place)


def _marks(figure: Any, result: Result, xs: np.ndarray, ys: np.ndarray, place: dict[str, int]) -> None:
    """The states that are not stable, one entry of the legend per verdict."""
    known = {trace.name for trace in figure.data}
    for verdict, (marker, colour) in curves.MARKS.items():
        hit = np.array(result.verdict) == verdict
        if hit.any():
            look = {"symbol": web.SYMBOLS[marker], "size": 11, "color": colour, "line": {"width": 2, "color": colour}}
            figure.add_scatter(
                **web.dots(xs[hit], ys[hit], None, mode="markers", marker=look, name=verdict, zorder=2),
                legendgroup=verdict, showlegend=verdict not in known, **place,
            )  # fmt: skip


def texts(result: Result, name: str = "") -> list[str]:
    """What each state tells: its verdict, and the numbers of a table with their units."""
    shown, made = told.columns(result.muscle), []
    start = f"{name}, " if name else ""
    for k, row in enumerate(rows(result)):
        known = [column for column in shown if row[column[0]] is not None]
        values = zip(known, told.cells(row, known), strict=True)
        lines = [(column.replace("_", " "), f"{text} {unit}".rstrip()) for (column, _, unit), text in values]
        verdict = told.verdict(str(row["verdict"]), str(row["reason"]))
        good = row["verdict"] == "stable"
        head = f"{start}state {k}: {row['verdict']}"
        made.append(web.hover(head, lines if good else [("why", verdict), *lines]))
    return made


def _protocol(result: Result) -> web.Web:
    """Force, length and pressure state by state, and the force over the length, a colour for each step."""
    figure = web.panels(
        3, 2, specs=[[{}, {"rowspan": 3}], [{}, None], [{}, None]], column_widths=[0.55, 0.45], shared_xaxes=True,
        vertical_spacing=0.04, horizontal_spacing=0.1,
    )  # fmt: skip
    for row, (name, colour) in enumerate(curves.PROTOCOL, 1):
        _line(figure, result, "state", name, "", colour, row, showlegend=False)
        figure.update_yaxes(title_text=curves.label(name), row=row, col=1)
        for start in curves.starts(result):
            figure.add_vline(start, line={"color": web.GREY, "width": 1, "dash": "dot"}, row=row, col=1)
    figure.update_xaxes(title_text="State", row=3, col=1)
    length, force, told_of = curves.column(result, "length"), curves.column(result, "force"), texts(result)
    parts = result.column("protocol_step")
    for k in np.unique(parts):
        here = parts == k
        said_of = [text for text, one in zip(told_of, here.tolist(), strict=True) if one]
        figure.add_scatter(
            **web.dots(length[here], force[here], said_of, mode="lines+markers", marker={"size": 6},
                       line={"color": style.LINES[int(k) % len(style.LINES)], "width": 2}, name=f"step {int(k) + 1}"),
            row=1, col=2,
        )  # fmt: skip
    _marks(figure, result, length, force, {"row": 1, "col": 2})
    figure.update_xaxes(title_text=curves.label("length"), row=1, col=2)
    figure.update_yaxes(title_text=curves.label("force"), row=1, col=2)
    return web.Web(figure, headline(result), (lost(result), style.assumption(result.muscle)), 620)
