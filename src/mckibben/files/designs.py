"""A design ↔ NetCDF-4, equal number by number; and its front, or its best, as a CSV table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.stored import checked, muscle_in
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.results.design import CURVES, STATES, Designed

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **{name: (("number",), "f") for name in ("value", "from", "to")},
    **{name: (("number",), "U") for name in ("number", "said", "searched", "unit", "meaning")},
    "goal_value": (("goal",), "f"), **{f"goal{end}": (("goal",), "U") for end in ("", "_kind", "_unit", "_display")},
    **{f"limit_{name}": (("limit",), "f")
       for name in ("value", "at", "over", "sign", "gain", "pressure", "force", "contraction")},
    **{f"limit{end}": (("limit",), "U") for end in ("", "_kind", "_unit", "_display")},
    "limit_active": (("limit",), "b"), "limit_met": (("limit",), "b"),
    **{name: (("state",), "f") for name in STATES}, **{name: (("state",), "U") for name in ("state", "verdict")},
    **{name: (("curve", "point"), "f") for name in CURVES}, "curve": (("curve",), "f"),
}  # fmt: skip
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {"muscle": str, "given": str, "notes": str, "mckibben_version": str, "feasible": int, "converged": int,
          "tried": int}  # fmt: skip
"""Attributes that a file must have."""


def save(design: Designed, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a design as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    return written(design.data, "design", path, force)


def of(stored: xr.Dataset, name: str) -> Designed:
    """The design that a file of this name holds; SpecError where it holds something else."""
    data = checked(stored, name, "design", _NEEDED, _ABOUT, ("number", "goal", "limit", "state", "curve", "design"))
    return Designed(muscle_in(name, data.attrs["muscle"]), muscle_in(name, data.attrs["given"]), data)


def save_csv(design: Designed, path: str | PathLike[str], force: bool = False) -> Path:
    """Write the designs of the front, or the best design, with their goals, in SI units."""
    data, text = design.data, io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    units = [*map(str, data["unit"].values), *map(str, data["goal_unit"].values)]
    heads = zip([*design.numbers, *design.goal_names], units, strict=True)
    writer.writerow([name if unit in ("", "1") else f"{name} [{unit}]" for name, unit in heads])
    front = design.front is not None
    values, said = (data[f"front_{one}" if front else one].values for one in ("value", "said"))
    goals = data["front_goal" if front else "goal_value"].values
    for numbers, texts, reached in zip(*(one if front else one[None] for one in (values, said, goals)), strict=True):
        own = zip(numbers.tolist(), texts.tolist(), strict=True)  # str of a float has all its digits
        writer.writerow([*(number if number == number else text for number, text in own), *reached.tolist()])
    return write(path, _notes(design), text.getvalue(), force)


def _notes(design: Designed) -> Iterator[str]:
    about = design.data.attrs
    yield f"a design: the best of {about['tried']} muscles, made by mckibben {about['mckibben_version']}"
    yield "units are SI, in brackets"
    yield ""
    yield from (f"{name}: {row['value']}, searched {row['searched']}" for name, row in design.table.iterrows())
    yield from (f"{row['limit']}: {row['value']}" for _, row in design.limits.iterrows())
    yield ""
    yield from (f"note: {line}" for line in design.notes)
    yield ""
    yield "the best muscle (TOML):"
    yield from about["muscle"].splitlines()
