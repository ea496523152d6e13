"""A design for people and for programs: tables of what was found, JSON, and a muscle for case files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mckibben.app.console import say, table
from mckibben.app.outputs import case_of, finite

if TYPE_CHECKING:
    from mckibben.results.design import Designed

__all__ = ["as_json", "described", "muscle_text", "show"]

FRONT = 20
"""Designs of a front that are shown."""


def show(design: Designed, seconds: float) -> None:
    """Print the best design, its limits, its states, the front, and the notes."""
    best = [(name, row["value"], row["searched"]) for name, row in design.table.iterrows()]
    middle = ", the one nearest to having the best of every goal" if design.front is not None else ""
    say(table(("free", "value", "searched"), best, title=f"Best design{middle}", whole=(0, 1)))
    say(table(("goal", "value"), _goals(design), whole=(1,)))
    limits = [(row["limit"], row["value"], f"{row['room [%]']:g} %", "yes" if row["reached"] else "")
              for _, row in design.limits.iterrows()]  # fmt: skip
    if limits:
        say(table(("demand", "value", "room", "reached"), limits, right=(2,), whole=(1, 2, 3)))
    head = ("state", "length", "force", "pressure", "largest\nradius", "fibre\ntension", "verdict")
    states = [(name, row["length"], row["force"], row["pressure"], row["largest_radius"], row["peak_fibre_tension"],
               row["verdict"]) for name, row in design.states.iterrows()]  # fmt: skip
    if states:
        say(table(head, states, title="What it does", right=range(1, 6), whole=(0, 6)), whole=True)
    if design.front is not None:
        say(_front(design), whole=True)
    ended = "" if design.converged else ": the search had not settled"
    say(f"{design.tried} designs tried in {seconds:.1f} s{ended}")
    for note in design.notes:
        say(f"- {note}")


def _goals(design: Designed) -> list[tuple[str, str]]:
    from mckibben.spec.wishes import text_of

    data = design.data
    about = zip(design.goals.items(), data["goal_unit"].values, data["goal_display"].values, strict=True)
    return [(name, text_of(value, str(unit), str(display), 5)) for (name, value), unit, display in about]


def _front(design: Designed) -> Any:
    """The designs of the front, some of them left out where they are many."""
    from mckibben.spec.wishes import text_of

    data, rows = design.data, []
    about = list(zip(data["goal_unit"].values, data["goal_display"].values, strict=True))
    for k, said in enumerate(data["front_said"].values):
        goals = zip(data["front_goal"].values[k].tolist(), about, strict=True)
        shown = [text_of(value, str(unit), str(display)) for value, (unit, display) in goals]
        rows.append((str(k), *shown, *map(str, said)))
    head, numbers = ("", *design.goal_names, *design.numbers), range(1, 1 + len(about))
    return table(head, rows, title=f"Front of {len(rows)} designs", most=FRONT, right=numbers)


def as_json(design: Designed, seconds: float, files: dict[str, str | None]) -> dict[str, Any]:
    """The whole design for JSON, in SI units; None for NaN and infinity."""
    from mckibben.results.design import STATES
    from mckibben.spec.text import to_mapping

    data = design.data
    said = [str(one) for one in data["said"].values]
    limits = [
        {"limit": str(name), "value": finite(data["limit_value"].values[k]), "at": float(data["limit_at"].values[k]),
         "met": bool(data["limit_met"].values[k]), "reached": bool(data["limit_active"].values[k]),
         "gain_per_percent": finite(data["limit_gain"].values[k])}
        for k, name in enumerate(data["limit"].values)
    ]  # fmt: skip
    states = [
        {"state": str(name), "verdict": str(data["verdict"].values[k]),
         **{kind: finite(data[kind].values[k]) for kind in STATES}}
        for k, name in enumerate(data["state"].values)
    ]  # fmt: skip
    front = None
    if design.front is not None:
        rows = zip(data["front_goal"].values.tolist(), data["front_said"].values.tolist(), strict=True)
        front = [
            dict(zip(design.goal_names, map(finite, goals), strict=True))
            | {"free": dict(zip(design.numbers, map(str, texts), strict=True))}
            for goals, texts in rows
        ]
    return {
        "feasible": design.feasible, "converged": design.converged, **files,
        "free": {name: {"value": finite(value), "said": text}
                 for (name, value), text in zip(design.values.items(), said, strict=True)},
        "goals": {name: finite(value) for name, value in design.goals.items()}, "limits": limits, "states": states,
        "front": front, "notes": list(design.notes), "muscle": to_mapping(design.muscle, allow_custom=True),
        "tried": design.tried, "seconds": seconds, "mckibben_version": str(data.attrs["mckibben_version"]),
    }  # fmt: skip


def described(design: Designed) -> list[tuple[str, str]]:
    """What a saved design is, in rows of a name and a text."""
    many = f", and a front of {len(design.data['design'])}" if design.front is not None else ""
    rows = [
        ("holds", f"a design: the best of {design.tried} muscles{many}"),
        ("made", f"with mckibben {design.data.attrs['mckibben_version']}"),
        ("demands", "met" if design.feasible else "cannot be met together"),
        *(("goal", f"{name}: {value}") for name, value in _goals(design)),
    ]
    rows += [(name, row["value"]) for name, row in design.table.iterrows()]
    rows += [("demand", f"{row['limit']}: {row['value']}") for _, row in design.limits.iterrows()]
    return rows + [("note", note) for note in design.notes]


def muscle_text(design: Designed) -> str:
    """The best muscle as the [muscle] table of a case file, with what it was made for in comments."""
    lines = [f"designed by mckibben {design.data.attrs['mckibben_version']}"]
    lines += [f"{name}: {value}" for name, value in _goals(design)]
    lines += [f"{row['limit']}: {row['value']}" for _, row in design.limits.iterrows()]
    return case_of(design.muscle, lines)
