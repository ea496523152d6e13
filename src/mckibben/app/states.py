"""The result of a run for people (a table and notes) and for programs (JSON)."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

from mckibben.app.console import COMPLETE, INCOMPLETE, INTERRUPTED, say, table
from mckibben.experiments import foresee
from mckibben.results.result import Result
from mckibben.results.rows import COLUMNS as COLUMNS_SI
from mckibben.results.rows import rows
from mckibben.results.told import cells, columns, verdict
from mckibben.results.verdict import Verdict
from mckibben.spec.rows import muscle_rows

__all__ = ["as_json", "exit_code", "show"]

MOST_ROWS = 40
"""Rows of the table; of more states the ones in the middle are left out."""
GOOD = (Verdict.STABLE, Verdict.UNSTABLE)
"""Verdicts of states that are equilibria and admissible."""


def exit_code(result: Result) -> int:
    """0 if there is an admissible equilibrium at every state asked for, 130 after Ctrl-C, else 3."""
    if result.status == "interrupted":
        return INTERRUPTED
    return COMPLETE if all(verdict in GOOD for verdict in result.verdict) else INCOMPLETE


def show(result: Result, tolerance: float) -> None:
    """Print the table of states, then the notes on them."""
    states = list(rows(result))
    several = states[-1]["protocol_step"] > 0
    shown = columns(result.muscle)
    heads = (f"{name}\n[{unit}]" if unit else name for _, name, unit in shown)
    names = ["state", *(["step"] if several else []), *heads, "verdict"]
    body = [
        [str(k), *([str(row["protocol_step"])] if several else []), *cells(row, shown), row["verdict"]]
        for k, row in enumerate(states)
    ]
    say(
        table(
            names,
            body,
            title=result.attributes["title"],
            right=range(len(names) - 1),
            whole=(len(names) - 1,),
            most=MOST_ROWS,
            narrow=True,
        ),
        whole=True,
    )
    say(foresee.turns(result.muscle))
    say("contr.: contraction; diam.: largest diameter of the braid; tension: the largest of a fibre")
    for note in _notes(result, states, tolerance):
        say(note)


def _notes(result: Result, states: list[dict[str, Any]], tolerance: float) -> Iterator[str]:
    found: dict[tuple[str, str], list[int]] = {}
    for k, row in enumerate(states):
        if row["verdict"] != Verdict.STABLE:
            found.setdefault((row["verdict"], row["reason"]), []).append(k)
    for (word, reason), which in found.items():
        yield f"{_states(which)}: {verdict(word, reason)}"
    for warning in filter(None, result.attributes["warnings"].splitlines()):
        yield f"warning: {warning}"
    worst = max((row["error_estimate"] or 0.0 for row in states), default=0.0)
    if worst > tolerance:
        yield f"note: the estimated error, {worst:.1e}, is above the tolerance {tolerance:g}"
    known = {name: text for name, text, _, _ in muscle_rows(result.muscle)}
    if known.keys() & set(result.muscle.assumed):
        shown = ", ".join(f"{name} = {known[name]}" for name in result.muscle.assumed if name in known)
        yield f"assumed, not measured: {shown}"


def _states(which: list[int]) -> str:
    if len(which) == 1:
        return f"state {which[0]}"
    if which == list(range(which[0], which[-1] + 1)):
        return f"states {which[0]} to {which[-1]}"
    few = ", ".join(map(str, which[:10]))
    return f"states {few}" + (", ..." if len(which) > 10 else "")


def as_json(result: Result, file: str | None) -> dict[str, Any]:
    """The whole result for JSON: every state in SI units, None for NaN, with the muscle, the test and the versions."""
    about = result.attributes
    return {
        "complete": exit_code(result) == COMPLETE,
        "file": file,
        "muscle": tomllib.loads(about["muscle"]),
        "test": tomllib.loads(about["test"]),
        "assumed": list(result.muscle.assumed),
        "warnings": list(filter(None, about["warnings"].splitlines())),
        "units": {name: unit for name, (unit, _) in COLUMNS_SI.items() if unit},
        "states": list(rows(result)),
        "mckibben_version": about["mckibben_version"],
        "versions": about["versions"],
        "date": about["date"],
    }
