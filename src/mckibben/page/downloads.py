"""What a page gives to download, written by the package's own savers into a folder of the page."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mckibben.experiments.run import run
from mckibben.files.store import save
from mckibben.files.table import notes_file
from mckibben.page.asked import Asked, asked_of
from mckibben.page.curves import levels_at, pressures_with
from mckibben.page.kinds import KINDS
from mckibben.page.look import solved
from mckibben.results.result import Result
from mckibben.sheet.datasheet import datasheet
from mckibben.spec import Isobaric, Muscle, SpecError
from mckibben.spec.text import Case, to_toml
from mckibben.view.shapefile import save_shape

__all__ = ["written"]

POINTS = 21
"""States of the curve in a file."""


def written(kind: str, said: Mapping[str, Any], folder: str) -> dict[str, str]:
    """Write the file of a kind into a new folder inside `folder`: its path, and a name for the user's own disk.

    SpecError for another kind, for a muscle that is wrong, and where there is nothing to write.
    """
    if kind not in KINDS:
        raise SpecError("file", kind, "must be one of " + ", ".join(KINDS))
    asked = asked_of(said)
    place = Path(tempfile.mkdtemp(dir=folder)) / f"out.{kind}"
    if kind == "toml":
        place.write_text(to_toml(Case(asked.muscle, _test(asked))), encoding="utf-8")
    elif kind == "pdf":
        datasheet(asked.muscle, place, pressure=f"{asked.top!r} Pa")
    elif kind == "glb":
        save_shape(_state(asked), place)
    elif kind == "txt":
        table = place.with_suffix(".csv")
        save(_curve(asked), table)
        place = notes_file(table)
    else:
        save(_curve(asked), place)
    return {"path": str(place), "name": f"{_named(asked.muscle)}.{kind}"}


def _test(asked: Asked) -> Isobaric:
    """The curve that a page shows at the present pressure, as a test that can be run."""
    (level,) = [level for level in levels_at(asked.muscle, pressures_with(asked.pressure, asked.top))
                if level.pressure == asked.pressure]  # fmt: skip
    first, last = (f"{100.0 * level.curve.contraction[k]:.9g} %" for k in (0, -1))
    ends: Any = {"contraction": f"{first} to {last}"}
    return Isobaric(pressure=f"{asked.pressure!r} Pa", points=POINTS, **ends)


def _curve(asked: Asked) -> Result:
    return run(asked.muscle, _test(asked))


def _state(asked: Asked) -> Result:
    """The state that a page draws: that which is asked for, or the last good one on the way."""
    state = solved(asked)
    drawn = state if state.last_good is None else state.last_good
    if drawn.length != drawn.length:
        raise SpecError("file", "glb", "there is no shape to write", state.reason)
    return drawn.result


def _named(muscle: Muscle) -> str:
    """A name for a file, of letters and digits alone."""
    words = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in muscle.name or "muscle")
    return "-".join(part for part in words.split("-") if part)[:60] or "muscle"
