"""A fit ↔ NetCDF-4, equal number by number; and its points as a CSV table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mckibben.files.hdf5 import opened
from mckibben.files.stored import FOUND, checked, muscle_in, of_numbers
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.results.fit import POINTS, Fitted
from mckibben.spec.errors import SpecError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["load", "of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **FOUND,
    **{name: (("point",), "f") for name in POINTS},
    **{name: (("point",), "U") for name in ("test", "branch")},
}
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {"muscle": str, "given": str, "notes": str, "source": str, "mckibben_version": str, "converged": int,
          "level": float, "force_error": float}  # fmt: skip
"""Attributes that a file must have."""


def save(fit: Fitted, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a fit as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    return written(fit.data, "fit", path, force)


def load(path: str | PathLike[str]) -> Fitted:
    """The fit in a file written by `save`; SpecError, in one line, for any other file."""
    return of(opened(path), str(path))


def of(stored: xr.Dataset, name: str) -> Fitted:
    """The fit that a file of this name holds; SpecError where it holds something else."""
    data = checked(stored, name, "fit", _NEEDED, _ABOUT, ("number", "other"))
    texts = data["further"].values.tolist() if "further" in data else []
    further = tuple(muscle_in(name, text) for text in texts)
    if further and not ("of" in data and set(np.unique(data["of"].values)) <= set(range(len(further) + 1))):
        raise SpecError(name, allowed="does not say which muscle each point is of", advice="make it again")
    return Fitted(muscle_in(name, data.attrs["muscle"]), muscle_in(name, data.attrs["given"]), data, further)


def save_csv(fit: Fitted, path: str | PathLike[str], force: bool = False) -> Path:
    """Write the measured points with what the fitted muscle differs from them by, in SI units."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    units = {name: f"{name} [{unit}]" if unit != "1" else name for name, (unit, _) in POINTS.items()}
    writer.writerow(["test", "branch", *units.values(), "residual [N]"])
    columns = [fit.data[name].values.tolist() for name in ("test", "branch", *POINTS)]
    writer.writerows(zip(*columns, fit.residuals.tolist(), strict=True))  # str of a float has all its digits
    return write(path, _notes(fit), text.getvalue(), force)


def _notes(fit: Fitted) -> Iterator[str]:
    about = fit.data.attrs
    yield f"a fit to {about['source']}, made by mckibben {about['mckibben_version']}"
    yield f"{fit.goodness}; R squared {fit.explained:.6g}"
    yield "residual: force of the fitted muscle (offsets included) less the measured one; units are SI, in brackets"
    yield ""
    yield from of_numbers(fit)
    for k, text in enumerate([about["muscle"], *(fit.data["further"].values.tolist() if fit.further else [])]):
        yield f"the fitted muscle{f', number {k + 1}' if fit.further else ''} (TOML):"
        yield from text.splitlines()
