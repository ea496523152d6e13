"""A fit ↔ NetCDF-4, equal number by number; and its points as a CSV table."""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.files.hdf5 import HOLDS, kind, opened, written
from mckibben.files.table import write
from mckibben.results.fit import NUMBERS, POINTS, Fitted
from mckibben.spec import Muscle
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.text import muscle_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["load", "of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    **{name: (("number",), "f") for name in NUMBERS},
    **{name: (("point",), "f") for name in POINTS},
    **{name: (("number", "other"), "f") for name in ("correlation", "covariance")},
    **{name: (("number",), "U") for name in ("number", "unit", "display", "meaning")},
    **{name: (("point",), "U") for name in ("test", "branch")},
    "other": (("other",), "U"), "undetermined": (("number",), "b"),
}  # fmt: skip
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {"muscle": str, "given": str, "notes": str, "source": str, "mckibben_version": str, "converged": int,
          "level": float, "force_error": float}  # fmt: skip
"""Attributes that a file must have."""


def save(fit: Fitted, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a fit as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    data = fit.data
    variables = {str(name): (tuple(map(str, item.dims)), item.values, item.attrs)
                 for name, item in data.variables.items()}  # fmt: skip
    texts = {name: (dims, array.astype(str) if array.dtype.kind in "OT" else array, about)
             for name, (dims, array, about) in variables.items()}  # fmt: skip
    sizes = {str(name): int(size) for name, size in data.sizes.items()}
    return written(path, sizes, texts, {HOLDS: "fit"} | data.attrs, force)


def load(path: str | PathLike[str]) -> Fitted:
    """The fit in a file written by `save`; SpecError, in one line, for any other file."""
    return of(opened(path), str(path))


def of(stored: xr.Dataset, name: str) -> Fitted:
    """The fit that a file of this name holds; SpecError where it holds something else."""
    import xarray as xr

    if kind(stored) != "fit":
        raise SpecError(name, allowed="holds no fit of mckibben", advice="give what mckibben fit or mk.save wrote")
    about = {str(key): _plain(value) for key, value in stored.attrs.items() if key != HOLDS}
    for key, type_ in _ABOUT.items():
        if not isinstance(about.get(key), type_):
            raise SpecError(name, allowed=f"does not say its {key}", advice="make it again")
    variables = {}
    for variable in [*_NEEDED, *(str(one) for one in stored.variables if one not in _NEEDED)]:
        if variable not in stored.variables:
            raise SpecError(name, allowed=f"holds no {variable} of a fit (written by {about['mckibben_version']})")
        array = np.asarray(stored[variable].values)
        array = array.astype(str) if array.dtype.kind in "OT" else array
        dims = tuple(map(str, stored[variable].dims))
        if _NEEDED.get(variable, (dims, array.dtype.kind)) != (dims, array.dtype.kind):
            raise SpecError(name, allowed=f"holds {variable} per {' and '.join(dims)} as {array.dtype}")
        array.flags.writeable = False
        variables[variable] = (dims, array, dict(stored[variable].attrs))
    coords = {axis: variables.pop(axis) for axis in ("number", "other")}
    data = xr.Dataset({str(one): variables[str(one)] for one in stored.data_vars}, coords, about)
    return Fitted(_muscle(name, about["muscle"]), _muscle(name, about["given"]), data)


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _muscle(name: str, text: str) -> Muscle:
    try:
        with trusted():
            return muscle_from_mapping(tomllib.loads(text))
    except SpecError as error:
        advice = "its numbers can be read with xarray.open_dataset"
        raise SpecError(name, allowed=f"its muscle cannot be built again: {error}", advice=advice) from error
    except (ValueError, RecursionError) as error:
        raise SpecError(name, allowed="is damaged: its muscle is not TOML", advice="make it again") from error


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
    yield f"the numbers, with intervals at {100.0 * about['level']:g} %:"
    for name, row in fit.table.iterrows():
        yield f"{name}: {row['value']}, standard error {row['error'] or 'unknown'}, interval {row['interval']}"
    yield ""
    yield from (f"note: {line}" for line in fit.notes)
    yield ""
    yield "the fitted muscle (TOML):"
    yield from about["muscle"].splitlines()
