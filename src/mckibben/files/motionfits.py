"""A fit of a motion ↔ NetCDF-4, equal number by number; and its values over time as a CSV table."""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.stored import checked
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.results.found import NUMBERS
from mckibben.results.motionfit import MOMENTS, MotionFit
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.rig import Rig
from mckibben.spec.rigtext import rig_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **{name: (("number",), "f") for name in NUMBERS},
    **{name: (("point",), "f") for name in MOMENTS},
    **{name: (("number", "other"), "f") for name in ("correlation", "covariance")},
    **{name: (("number",), "U") for name in ("number", "unit", "display", "meaning")},
    "quantity": (("point",), "U"), "other": (("other",), "U"), "undetermined": (("number",), "b"),
}  # fmt: skip
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
    return MotionFit(_rig_in(name, data.attrs["rig"]), _rig_in(name, data.attrs["given"]), data)


def _rig_in(name: str, text: str) -> Rig:
    try:
        with trusted():
            return rig_from_mapping(tomllib.loads(text))
    except (SpecError, ValueError, RecursionError) as error:
        advice = "its numbers can be read with xarray.open_dataset"
        raise SpecError(name, allowed=f"its rig cannot be built again: {error}", advice=advice) from error


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
    yield f"the numbers, with intervals at {100.0 * about['level']:g} %:"
    for name, row in fit.table.iterrows():
        yield f"{name}: {row['value']}, standard error {row['error'] or 'unknown'}, interval {row['interval']}"
    yield ""
    yield from (f"note: {line}" for line in fit.notes)
    yield ""
    yield "the fitted rig (TOML):"
    yield from about["rig"].splitlines()
