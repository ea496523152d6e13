"""A design that a page asks for: what is free, one goal or several, and limits, as a design file says them."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from mckibben.designing.design import design
from mckibben.designing.designfile import read_design
from mckibben.page.asked import Asked
from mckibben.page.fronts import front_of
from mckibben.page.jobs import Tell, free_of
from mckibben.page.opening import opened
from mckibben.spec import SpecError
from mckibben.spec.text import to_mapping

__all__ = ["designed"]

MOST = 2_000
"""Designs that a page tries at most."""


def designed(asked: Asked, said: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The muscle that does best what is wanted, opened; its numbers, limits and notes; of several goals the front."""
    tables = {"muscle": to_mapping(asked.muscle), "free": free_of(said), "objective": said.get("objective"),
              "subject_to": said.get("subject_to", []), "options": {"designs": said.get("designs")}}  # fmt: skip
    case = _read(tables)
    if not case.options["designs"] <= MOST:
        raise SpecError("designs", case.options["designs"], f"must be at most {MOST}")
    found = design(
        case.muscle, case.free, case.objective, case.subject_to, **case.options,
        watch=lambda done, total: tell("progress", {"done": done, "of": total}),
    )  # fmt: skip
    rows = [[str(name), str(row["value"]), str(row["searched"])] for name, row in found.table.iterrows()]
    limits = [[str(row["limit"]), str(row["value"]), f"{row['room [%]']:g} %"] for _, row in found.limits.iterrows()]
    notes = [*found.notes, *(() if found.converged else ("the search had not settled",))]
    told = {
        "front": front_of(found),
        "rows": rows,
        "limits": limits,
        "feasible": found.feasible,
        "notes": notes,
        "tried": found.tried,
    }
    return told | {"opened": opened({"from": to_mapping(found.muscle)})}


def _read(tables: dict[str, Any]) -> Any:
    """What a design file of these tables says; its messages do not name the file, which nobody else sees."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "design.toml"
        try:
            path.write_text(tomli_w.dumps(tables), encoding="utf-8")
        except (TypeError, ValueError) as error:  # what JSON knows and TOML does not
            raise SpecError("design", allowed="has a value that is none") from error
        return read_design(path)
