"""A fit of a motion ↔ NetCDF-4, equal number by number; and its values over time as a CSV table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.stored import FOUND, checked, of_numbers, rebuilt
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.results.motionfit import MOMENTS, MotionFit
from mckibben.spec.rigtext import rig_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **FOUND,
    **{name: (("point",), "f") for name in MOMENTS},
    "quantity": (("point",), "U"),
}
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {"rig": str, "given": str, "notes": str, "source": str, "mckibben_version": str, "converged": int,
          "level": float}  # fmt: skip
"""Attributes that a file must have."""


def save(fit: MotionFit, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a fit of a motion as a NetCDF-4 file; SpecError if it exists (without `force`) or cannot be written."""
    return written(fit.data, "motion fit", path, force)


def of(stored: xr.Dataset, name: str) -> MotionFit:
    """The fit of a motion that a file of this name holds; SpecError where it holds something else."""
    data = checked(stored, name, "motion fit", _NEEDED, _ABOUT, ("number", "other"))
    best, given = (rebuilt(name, "rig", data.attrs[key], rig_from_mapping) for key in ("rig", "given"))
    return MotionFit(best, given, data)


def save_csv(fit: MotionFit, path: str | PathLike[str], force: bool = False) -> Path:
    """Write the measured values with those of the fitted rig, in SI units."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["quantity", "time [s]", *list(MOMENTS)[1:]])
    writer.writerows(zip(*(fit.data[name].values.tolist() for name in ("quantity", *MOMENTS)), strict=True))
    return write(path, _notes(fit), text.getvalue(), force)


def _notes(fit: MotionFit) -> Iterator[str]:
    about = fit.data.attrs
    yield f"a fit of a motion to {about['source']}, made by mckibben {about['mckibben_version']}"
    yield "values are SI: lengths in m, gauge pressures in Pa, forces in N, angles in rad"
    yield ""
    yield from of_numbers(fit)
    yield "the fitted rig (TOML):"
    yield from about["rig"].splitlines()
