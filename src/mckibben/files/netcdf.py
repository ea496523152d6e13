"""Results as NetCDF-4 files, through h5netcdf. What is loaded equals what was saved, number by number.

The layout is that of xarray, which reads them. They are written without it, because importing it takes half a second.
A seal at the end tells damage; files of before have none, and are read without.
"""

from __future__ import annotations

import io
import tomllib
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np

from mckibben import disk
from mckibben.files.seal import SIGNATURE, Parts, damage, sealed
from mckibben.results.result import Result
from mckibben.results.variables import COORDINATES, FIELDS, LATER, OPTIONAL, VARIABLES, about_variable, dimensions, has
from mckibben.spec import Muscle, Test
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.text import muscle_from_mapping, test_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["load", "save"]

_BROKEN = (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError, IndexError, OverflowError, EOFError,
           MemoryError)  # fmt: skip
"""What HDF5 and the layers above it raise for files that are cut short or damaged."""


def save(result: Result, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a result as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    disk.check_target(path, force)
    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        file.dimensions = {"step": len(result), "v": len(result.column("v"))}
        _put(file, "step", np.arange(len(result)))
        for name in ("v", *(name for name in VARIABLES if has(result.muscle, name))):
            _put(file, name, result.column(name))
        file.attrs.update(result.attributes)
    return disk.write(path, sealed(content.getbuffer(), _parts(content)), force)


def _parts(content: io.BytesIO) -> Parts:
    """Where the numbers of each variable are in a file."""
    with h5py.File(content, "r") as file:
        found = {name: (item.id.get_offset(), item.id.get_storage_size()) for name, item in file.items()}
    return {name: (at, size) for name, (at, size) in found.items() if at is not None}


def _put(file: h5netcdf.File, name: str, array: np.ndarray) -> None:
    """Write one variable; text and booleans are encoded as xarray does."""
    dims, about = dimensions(name), about_variable(name)
    if array.dtype.kind == "f":
        variable = file.create_variable(name, dims, array.dtype, array, fillvalue=np.nan)
    elif array.dtype.kind == "b":
        variable, about = file.create_variable(name, dims, np.int8, array.astype(np.int8)), about | {"dtype": "bool"}
    elif array.dtype.kind == "U":
        variable = file.create_variable(name, dims, h5py.string_dtype(), array.astype(object))
    else:
        variable = file.create_variable(name, dims, array.dtype, array)
    variable.attrs.update(about)


def load(path: str | PathLike[str]) -> Result:
    """The result in a NetCDF file written by `save`; SpecError, in one line, for any other file."""
    name = str(path)
    stored = _opened(name, _content(path))
    data = _checked(name, stored)
    muscle, test = _specification(name, data.attrs)
    return Result(muscle, test, data)


def _content(path: str | PathLike[str]) -> bytes:
    name = str(path)
    try:
        return Path(path).read_bytes()
    except FileNotFoundError as error:
        raise SpecError(name, allowed="there is no such file") from error
    except OSError as error:
        raise SpecError(name, allowed=f"cannot be read: {error.strerror or error}") from error
    except ValueError as error:  # a null character in the name
        raise SpecError(name, allowed="is no name of a file") from error


def _opened(name: str, content: bytes) -> xr.Dataset:
    wrong = damage(content)
    if wrong is not None:
        raise SpecError(name, allowed=f"is cut short or damaged: {wrong} not as written", advice="make it again")
    if not content.startswith(SIGNATURE):
        said = "is empty" if not content else "is no NetCDF-4 file"
        raise SpecError(name, allowed=said, advice="give a file that mckibben wrote as .nc")
    import xarray as xr

    try:
        _read_through(content)
        return xr.load_dataset(io.BytesIO(content), engine="h5netcdf", decode_times=False, decode_coords=False)
    except _BROKEN as error:
        raise SpecError(name, allowed="is cut short or damaged", advice="make it again") from error


def _read_through(content: bytes) -> None:
    """Read the whole file with h5py first, which raises where it is damaged; h5netcdf would write to stderr instead."""
    with h5py.File(io.BytesIO(content), "r") as file:
        dict(file.attrs)
        for member in file.values():
            dict(member.attrs)
            if isinstance(member, h5py.Dataset):
                member[...]


def _checked(name: str, stored: xr.Dataset) -> xr.Dataset:
    """The Dataset as `result.dataset` makes it: declared variables, plain text, read-only arrays."""
    import xarray as xr

    about = {str(key): str(value) for key, value in stored.attrs.items()}
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
