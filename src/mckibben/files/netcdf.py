"""A `Result` ↔ NetCDF-4. What is loaded equals what was saved, number by number."""

from __future__ import annotations

import tomllib
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.files.hdf5 import kind, opened, written
from mckibben.results.result import Result
from mckibben.results.variables import COORDINATES, FIELDS, LATER, OPTIONAL, VARIABLES, about_variable, dimensions, has
from mckibben.spec import Muscle, Test
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.text import muscle_from_mapping, test_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["load", "of", "save"]


def save(result: Result, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a result as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    arrays = {"step": np.arange(len(result)), "v": result.column("v")}
    arrays |= {name: result.column(name) for name in VARIABLES if has(result.muscle, name)}
    variables = {name: (dimensions(name), array, about_variable(name)) for name, array in arrays.items()}
    return written(path, {"step": len(result), "v": len(arrays["v"])}, variables, result.attributes, force)


def load(path: str | PathLike[str]) -> Result:
    """The result in a NetCDF file written by `save`; SpecError, in one line, for any other file."""
    return of(opened(path), str(path))


def of(stored: xr.Dataset, name: str) -> Result:
    """The result that a file of this name holds; SpecError where it holds something else."""
    data = _checked(name, stored)
    muscle, test = _specification(name, data.attrs)
    return Result(muscle, test, data)


def _checked(name: str, stored: xr.Dataset) -> xr.Dataset:
    """The Dataset as `result.dataset` makes it: declared variables, plain text, read-only arrays."""
    import xarray as xr

    about = {str(key): str(value) for key, value in stored.attrs.items()}
    if kind(stored) == "fit":
        raise SpecError(name, allowed="holds a fit, not a result", advice="open it with mckibben.load")
    writer = about.get("mckibben_version")
    if writer is None:
        raise SpecError(name, allowed="holds no result of mckibben")
    variables: dict[str, Any] = {}
    for variable in VARIABLES:
        dims = dimensions(variable)
        if variable in OPTIONAL and variable not in stored.data_vars:
            continue
        if variable in LATER and variable not in stored.data_vars:
            variables[variable] = (dims, _absent(stored, dims), about_variable(variable))
            continue
        if variable not in stored.data_vars or stored[variable].dims != dims:
            raise SpecError(
                name, allowed=f"holds no {variable} per {' and '.join(dims)} (written by mckibben {writer})"
            )
        variables[variable] = (dims, _array(name, stored[variable]), dict(stored[variable].attrs))
    missing = [axis for axis in COORDINATES if axis not in stored.coords]
    if missing:
        raise SpecError(name, allowed=f"holds no coordinate {missing[0]} (written by mckibben {writer})")
    coords = {axis: ((axis,), stored[axis].values, dict(stored[axis].attrs)) for axis in COORDINATES}
    return xr.Dataset(variables, coords, about)


_KINDS = {"verdict": "UOT", "reason": "UOT", "shape": "UOT", "converged": "b"}
"""NumPy's letters of the kinds of data that a variable may have in a file: text in three forms, or booleans."""


def _absent(stored: xr.Dataset, dims: tuple[str, ...]) -> np.ndarray:
    """NaN for a variable of a later version."""
    array = np.full(tuple(stored.sizes.get(dim, 0) for dim in dims), np.nan)
    array.flags.writeable = False
    return array


def _array(name: str, variable: xr.DataArray) -> np.ndarray:
    array = np.asarray(variable.values)
    kinds = _KINDS.get(str(variable.name), "f" if variable.name in FIELDS else "fi")
    if array.dtype.kind not in kinds:
        raise SpecError(name, allowed=f"holds {variable.name} as {array.dtype}")
    if "U" in kinds:
        array = array.astype(str)
    array.flags.writeable = False
    return array


def _specification(name: str, about: dict[str, Any]) -> tuple[Muscle, Test]:
    """Muscle and test, from their TOML text among the attributes."""
    try:
        with trusted():  # a file of an earlier version may say 1.0 for a pressure of 1 Pa
            return (
                muscle_from_mapping(tomllib.loads(about.get("muscle", ""))),
                test_from_mapping(tomllib.loads(about.get("test", ""))),
            )
    except SpecError as error:
        advice = "its numbers can be read with xarray.open_dataset"
        raise SpecError(name, allowed=f"its muscle or test cannot be built again: {error}", advice=advice) from error
    except (ValueError, RecursionError) as error:
        raise SpecError(name, allowed="is damaged: its muscle or test is not TOML", advice="make it again") from error
