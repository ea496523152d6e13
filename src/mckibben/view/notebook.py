"""What a notebook shows of a muscle, a test, a result: a short table with units, the verdict, a small picture."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable, Sequence
from html import escape
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from mckibben.data.values import Data
from mckibben.potential.chart import Chart
from mckibben.results.design import Designed
from mckibben.results.effects import Effects
from mckibben.results.fit import Fitted
from mckibben.results.motion import Motion
from mckibben.results.motionfit import MotionFit
from mckibben.results.result import Result, State
from mckibben.results.rows import COLUMNS, rows
from mckibben.results.sensitivity import Sensitivity
from mckibben.results.swept import Swept, said
from mckibben.results.told import cells, columns, verdict
from mckibben.results.tolerances import Tolerances
from mckibben.spec import TESTS, Muscle, spec_classes
from mckibben.spec.rows import ASSUMED, muscle_rows, part_rows, test_rows
from mckibben.view import style
from mckibben.view.plot import plot
from mckibben.view.shape3d import draw_muscle
from mckibben.view.tube import Tube

__all__ = ["html"]

MOST = 8
"""Rows of a table; of more the ones in the middle are left out."""
REASONS = 3
"""Reasons why designs of a sweep are not complete that are named."""

Rows = Iterable[Sequence[str]]


def html(value: Any) -> str:
    """A value of the package as HTML that needs nothing else: all text is escaped, pictures are inside."""
    draw = next((draw for kind, draw in _KINDS.items() if isinstance(value, kind)), _plain)
    return f'<div style="display:flex;flex-wrap:wrap;gap:1.5em;align-items:flex-start">{draw(value)}</div>'


def _plain(value: Any) -> str:
    return f"<pre>{escape(repr(value))}</pre>"


def _muscle(muscle: Muscle) -> str:
    found = [(name, said, "assumed" if source.startswith(ASSUMED) else "", meaning)
             for name, said, meaning, source in muscle_rows(muscle)]  # fmt: skip
    name = f'Muscle "{muscle.name}"' if muscle.name else "Muscle"
    return _part(name, _table(("field", "value", "", "meaning"), found)) + _image(_side(Tube.cylinder(muscle)), name)


def _test(test: Any) -> str:
    return _part(f"{type(test).__name__} test", _table(("field", "value", "meaning"), test_rows(test)))


def _part_of_muscle(value: Any) -> str:
    return _part(type(value).__name__, _table(("field", "value", "meaning"), part_rows(value)))


def _result(result: Result) -> str:
    shown, states = columns(result.muscle), list(rows(result))
    heads = ["state", *(f"{name} [{unit}]" if unit else name for _, name, unit in shown), "verdict"]
    body = [[str(k), *cells(row, shown), row["verdict"]] for k, row in enumerate(states)]
    said = {verdict(row["verdict"], row["reason"]): None for row in states if row["verdict"] != "stable"}
    notes = [*said, *result.cautions, *_assumed(result.muscle)]
    heading = f"{result.attributes['title']}, {result.status}, {result.reached} of {len(result)} states reached"
    return _part(heading, _table(heads, _few(body)), notes) + _image(plot(result), heading)


def _state(state: State) -> str:
    (row,) = rows(state.result)
    shown = [column for column in columns(state.muscle) if row[column[0]] is not None]
    numbers = zip(shown, cells(row, shown), strict=True)
    body = [(COLUMNS[name][1], text, unit) for (name, _, unit), text in numbers]
    notes = [*state.cautions, *_assumed(state.muscle)]
    if state.last_good is not None:
        notes.insert(0, f"the last good state on the way: {state.last_good!r}")
    told = _part(verdict(str(state.verdict), state.reason), _table(("", "", ""), body) if body else "", notes)
    return told + (_image(_side(Tube.of(state.result, 0)), "the muscle in this state") if body else "")


def _fit(fit: Fitted) -> str:
    return _part(repr(fit).strip("<>"), _frame(fit.table), fit.notes) + _image(plot(fit), "the fit")


def _motion_fit(fit: MotionFit) -> str:
    return _part(repr(fit).strip("<>"), _frame(fit.table), fit.notes) + _image(plot(fit), "the fit")


def _design(design: Designed) -> str:
    tables = _frame(design.table) + _frame(design.limits)
    return _part(repr(design).strip("<>"), tables, design.notes) + _image(plot(design), "the design")


def _chart(chart: Chart) -> str:
    return _part(repr(chart).strip("<>"), _frame(chart.summary), chart.notes) + _image(plot(chart), "the map")


def _motion(motion: Motion) -> str:
    notes = [*((f"not complete: {motion.reason}",) if motion.reason else ()), *motion.notes]
    return _part(repr(motion).strip("<>"), _frame(motion.summary()), notes) + _image(plot(motion), "the motion")


def _tolerances(found: Tolerances) -> str:
    tables = _frame(found.spread) + _frame(found.table)
    return _part(repr(found).strip("<>"), tables, found.notes) + _image(plot(found), "tolerances")


def _sensitivity(found: Sensitivity) -> str:
    notes = [verdict(found.verdict, found.reason), "per cent of the result per per cent of the number"]
    picture = _image(plot(found), "sensitivity") if found.complete else ""
    return _part(repr(found).strip("<>"), _frame(found.table), notes) + picture


def _effects(effects: Effects) -> str:
    return _part(repr(effects).strip("<>"), _frame(effects.table)) + _image(plot(effects), "effects")


def _data(data: Data) -> str:
    body = [(name, str(len(part)), f"{part.force.min():.4g} to {part.force.max():.4g} N")
            for name in data.tests for part in [data[name]]]  # fmt: skip
    return _part(repr(data).strip("<>"), _table(("test", "points", "force"), _few(body)), data.assumptions)


def _swept(found: Swept) -> str:
    heading = repr(found).strip("<>").partition(";")[0]
    if found.large:
        return _part(
            heading, _frame(found.fields), ["many states: data.mckibben.counts and .table look at all of them"]
        )
    counts = [f"designs: {said(found.statuses)}", f"states: {said(found.counts)}"]
    reasons = [str(one) for one in np.unique(found.data["reason"].values.astype(str)) if one][:REASONS]
    tables = _frame(found.fields) + _frame(found.table)
    notes = [*counts, *(f"not complete: {one}" for one in reasons)]
    return _part(heading, tables, notes) + _image(plot(found.data), heading)


_KINDS: dict[Any, Callable[[Any], str]] = {
    Muscle: _muscle, Result: _result, State: _state, Fitted: _fit, Designed: _design, Tolerances: _tolerances,
    Sensitivity: _sensitivity, Effects: _effects, Data: _data, Chart: _chart, Motion: _motion,
    MotionFit: _motion_fit, Swept: _swept,
    tuple(TESTS.values()): _test, spec_classes(): _part_of_muscle,
}  # fmt: skip
"""What shows each kind of value."""


def _assumed(muscle: Muscle) -> list[str]:
    return [f"assumed, not measured: {', '.join(muscle.assumed)}"] if muscle.assumed else []


def _few(body: list[Any]) -> list[Any]:
    """The first and the last rows of many."""
    if len(body) <= MOST:
        return body
    return [*body[: MOST // 2], ["…"] * len(body[0]), *body[-MOST // 2 :]]


def _part(heading: str, table: str, notes: Iterable[str] = ()) -> str:
    said = "".join(f"<div><small>{escape(note)}</small></div>" for note in notes)
    return f"<div><div><b>{escape(heading)}</b></div>{table}{said}</div>"


def _table(heads: Sequence[str], body: Rows) -> str:
    head = "".join(f"<th>{escape(text)}</th>" for text in heads) if any(heads) else ""
    lines = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in body)
    head = f"<thead><tr>{head}</tr></thead>" if head else ""
    return f'<table style="text-align:left">{head}<tbody>{lines}</tbody></table>'


def _frame(frame: Any) -> str:
    """A DataFrame by its own HTML, the middle of a long one left out."""
    made: str = frame.to_html(max_rows=MOST, float_format="{:.4g}".format, border=0)
    return made


def _side(tube: Tube) -> Figure:
    """A muscle seen from the side."""
    figure = style.new_figure(style.COLUMN, 1.7)
    draw_muscle(figure.add_subplot(), tube)
    return figure


def _image(figure: Figure, what: str) -> str:
    content = base64.b64encode(style.picture(figure, "png")).decode("ascii")
    width = round(style.INCH * figure.get_figwidth())
    return f'<img alt="{escape(what)}" width="{width}" src="data:image/png;base64,{content}">'
