"""Long jobs of a page: the size of effects, a fit to measured data. They tell how far they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from mckibben.experiments.effects import effects
from mckibben.fitting.fit import fit
from mckibben.page.asked import Asked
from mckibben.page.look import solved
from mckibben.page.measured import data_of
from mckibben.page.opening import opened
from mckibben.page.plain import number
from mckibben.results.effects import QUANTITIES
from mckibben.results.verdict import Verdict
from mckibben.spec import SpecError
from mckibben.spec.text import to_mapping

__all__ = ["effects_of", "fitted", "free_of"]

Tell = Callable[[str, Any], None]
POINTS = 60
"""Points of a branch that are fitted to; of more, local means."""
STARTS = 4
MOST = 8
"""Numbers that may be free."""


def effects_of(asked: Asked, tell: Tell) -> dict[str, Any]:
    """The size of each effect at the state that is asked for."""
    state = solved(asked)
    if state.verdict != Verdict.STABLE:
        said = f"the muscle is not stable there: {state.reason}"
        raise SpecError("effects", allowed=said, advice="take another state")
    found = effects(
        asked.muscle, length=f"{state.length!r} m", pressure=f"{asked.pressure!r} Pa",
        watch=lambda done, total: tell("progress", {"done": done, "of": total}),
    )  # fmt: skip
    rows = []
    for name, row in found.table.iterrows():
        pair = [float(found.data["force"].sel(effect=name, state=state)) for state in ("without", "with")]
        rows.append({
            "effect": str(name), "assumed": bool(found.data["assumed"].sel(effect=name)), "switch": row["switch"],
            "reason": row["reason"], "time": number(row["time"], 3), "newtons": number(pair[1] - pair[0], 6),
            **{key: number(row[f"{key} [%]"], 6) for key in QUANTITIES},
        })  # fmt: skip
    return {"title": str(found.data.attrs["title"]), "rows": rows}


def free_of(said: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers that are free with their ranges, as a browser says them. SpecError for what is no such table."""
    free = said.get("free")
    if not isinstance(free, Mapping) or not 0 < len(free) <= MOST:
        raise SpecError("free", allowed=f"must be a table of 1 to {MOST} numbers with their ranges")
    return {str(name): value for name, value in free.items()}


def fitted(asked: Asked, said: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The numbers that are free, so that the forces differ least from the measured ones; and that muscle, opened."""
    data = data_of(said).decimated(POINTS)
    found = fit(
        asked.muscle, data, free_of(said), starts=STARTS,
        watch=lambda count: tell("progress", {"done": count, "of": 0}),
    )  # fmt: skip
    rows = [[str(name), *(str(row[key]) for key in ("value", "error", "interval", "bounds"))]
            for name, row in found.table.iterrows()]  # fmt: skip
    notes = [*found.notes, *(() if found.converged else ("the search had not settled",))]
    told = {"rows": rows, "rms": number(found.rms), "percent": number(found.percent, 4), "notes": notes}
    return told | {"opened": opened({"from": to_mapping(found.muscle)})}
