"""Tolerances ↔ NetCDF-4, equal number by number."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.stored import checked, muscle_in, rebuilt
from mckibben.files.stored import write as written
from mckibben.results.tolerances import OF_NUMBERS, OF_RESULTS, SHARES, Tolerances
from mckibben.spec.text import test_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save"]

_LETTER = {float: "f", str: "U", bool: "b"}
_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **{f"number_{name}": (("number",), _LETTER[form]) for name, form in OF_NUMBERS.items()},
    **{f"result_{name}": (("result",), _LETTER[form]) for name, form in OF_RESULTS.items()},
    **{name: (("number", "result"), "f") for name in SHARES},
    "number": (("number",), "U"), "result": (("result",), "U"),
    "drawn": (("sample", "number"), "f"), "sampled": (("sample", "result"), "f"),
}  # fmt: skip
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {"muscle": str, "test": str, "title": str, "state": int, "verdict": str, "reason": str, "notes": str,
          "assumed": str, "tried": int, "lost": int, "mckibben_version": str}  # fmt: skip
"""Attributes that a file must have."""


def save(found: Tolerances, path: str | PathLike[str], force: bool = False) -> Path:
    """Write tolerances as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    return written(found.data, "tolerances", path, force)


def of(stored: xr.Dataset, name: str) -> Tolerances:
    """The tolerances that a file of this name holds; SpecError where it holds something else."""
    axes = tuple(key for key in _NEEDED if key.partition("_")[0] in ("number", "result"))
    data = checked(stored, name, "tolerances", _NEEDED, _ABOUT, axes)
    test = rebuilt(name, "test", data.attrs["test"], test_from_mapping)
    return Tolerances(muscle_in(name, data.attrs["muscle"]), test, data)
