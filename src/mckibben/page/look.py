"""What is seen of a muscle at a pressure and a load or contraction: verdict, numbers, shape, energies."""

from __future__ import annotations

from typing import Any

from mckibben.experiments.solve import solve
from mckibben.page.asked import Asked
from mckibben.page.plain import number
from mckibben.page.shape import as_made, shape
from mckibben.results.result import State
from mckibben.results.rows import COLUMNS, rows
from mckibben.results.told import cells, columns, verdict
from mckibben.results.variables import STEP, has
from mckibben.results.verdict import Verdict
from mckibben.spec import Muscle
from mckibben.units import show

__all__ = ["look", "solved"]

PARTS = {
    "energy_chamber": "chamber", "energy_bending_1": "bending in the surface",
    "energy_bending_2": "bending normal to it", "energy_twist": "twist", "energy_stretch": "stretch",
    "energy_fittings": "fittings", "energy_crossings": "crossings", "energy_sliding": "sliding",
}  # fmt: skip
"""Parts of the stored energy and their names."""


def solved(asked: Asked) -> State:
    """The state that is asked for, as `solve` finds it."""
    pressure = f"{asked.pressure!r} Pa"
    if asked.hold == "force":
        return solve(asked.muscle, force=f"{asked.value!r} N", pressure=pressure)
    return solve(asked.muscle, contraction=asked.value, pressure=pressure)


def look(asked: Asked) -> dict[str, Any]:
    """The state that is asked for; where it is not stable, the last good one on the way to it."""
    state = solved(asked)
    good = state.verdict == Verdict.STABLE
    drawn = state if good else state.last_good
    return {
        "verdict": str(state.verdict),
        "said": verdict(str(state.verdict), state.reason),
        "good": good,
        "drawn": _drawn(state, drawn),
        "point": _point(state),
        "last": None if drawn is None else _point(drawn),
        "numbers": [] if drawn is None else _numbers(drawn),
        "energy": [] if drawn is None else _energies(drawn),
        "shape": as_made(state.muscle) if drawn is None else shape(drawn.result),
        "cautions": list((state if drawn is None else drawn).cautions),
        "law": _law(state.muscle),
    }


def _drawn(state: State, drawn: State | None) -> str:
    """What picture and numbers are of, where it is not the state that was asked for."""
    if drawn is state:
        return ""
    if drawn is None:
        return "Shown is the muscle as made: no stable state was found on the way."
    at = f"{show(drawn.length, 'm', 4)}, {show(drawn.force, 'N', 4)} and {show(drawn.pressure, 'Pa', 4)}"
    return f"Shown is the last stable state on the way: {at}."


def _point(state: State) -> dict[str, float | None]:
    names = ("contraction", "force", "length", "pressure")
    return {name: number(getattr(state, name)) for name in names}


def _numbers(state: State) -> list[list[str]]:
    """(name, value, unit) as tables show them."""
    (row,) = rows(state.result)
    known = [column for column in columns(state.muscle) if row[column[0]] is not None]
    texts = cells(row, known)
    return [[COLUMNS[name][1], text, unit] for (name, _, unit), text in zip(known, texts, strict=True)]


def _energies(state: State) -> list[dict[str, Any]]:
    """The parts of the stored energy [J]."""
    return [
        {"name": name, "meaning": STEP[variable][1], "value": number(state.result.column(variable)[0], 6)}
        for variable, name in PARTS.items()
        if has(state.muscle, variable)
    ]


def _law(muscle: Muscle) -> str:
    """How stiff the rubber is at small strains, by which laws compare; empty of a chamber of no such law."""
    law = None if muscle.chamber is None else muscle.chamber.law
    if law is None or not hasattr(law, "shear_modulus"):
        return ""
    remark = law.__remark__() if hasattr(law, "__remark__") else ""
    return f"shear modulus at small strains {show(law.shear_modulus, 'kPa', 4)}" + (f"; {remark}" if remark else "")
