"""A Dataset ↔ the bytes of a sealed NetCDF-4 file, through h5netcdf; what it means is for those who call.

The layout is that of xarray, which reads the files. They are written without it, because importing it takes half a
second. A seal at the end tells damage; files of before have none, and are read without.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import h5netcdf
import h5py
import numpy as np

from mckibben import disk
from mckibben.files.seal import SIGNATURE, Parts, damage, sealed
from mckibben.spec.errors import SpecError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["HOLDS", "Variables", "kind", "opened", "written"]

HOLDS = "holds"
"""The attribute by which a file says what it holds; those of results have none."""

Variables: TypeAlias = Mapping[str, tuple[tuple[str, ...], np.ndarray, Mapping[str, Any]]]
"""Of each variable its dimensions, its values and what is known of it."""

_BROKEN = (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError, IndexError, OverflowError, EOFError,
           MemoryError)  # fmt: skip
"""What HDF5 and the layers above it raise for files that are cut short or damaged."""


def written(
    path: str | PathLike[str], sizes: dict[str, int], variables: Variables, about: dict[str, Any], force: bool
) -> Path:
    """Write a sealed file, whole or not at all; SpecError if it exists (without `force`) or cannot be written."""
    disk.check_target(path, force)
    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        file.dimensions = sizes
        for name, (dims, array, known) in variables.items():
            _put(file, name, dims, array, dict(known))
        file.attrs.update(about)
    return disk.write(path, sealed(content.getbuffer(), _parts(content)), force)


def _parts(content: io.BytesIO) -> Parts:
    """Where the numbers of each variable are in a file."""
    with h5py.File(content, "r") as file:
        found = {name: (item.id.get_offset(), item.id.get_storage_size()) for name, item in file.items()}
    return {name: (at, size) for name, (at, size) in found.items() if at is not None}


def _put(file: h5netcdf.File, name: str, dims: tuple[str, ...], array: np.ndarray, about: dict[str, Any]) -> None:
    """Write one variable; text and booleans are encoded as xarray does."""
    if array.dtype.kind == "f":
        variable = file.create_variable(name, dims, array.dtype, array, fillvalue=np.nan)
    elif array.dtype.kind == "b":
        variable, about = file.create_variable(name, dims, np.int8, array.astype(np.int8)), about | {"dtype": "bool"}
    elif array.dtype.kind == "U":
        variable = file.create_variable(name, dims, h5py.string_dtype(), array.astype(object))
    else:
        variable = file.create_variable(name, dims, array.dtype, array)
    variable.attrs.update(about)


def opened(path: str | PathLike[str]) -> xr.Dataset:
    """What is in a NetCDF-4 file, as xarray reads it; SpecError, in one line, where it is damaged or none."""
    name = str(path)
    content = _content(path)
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


def kind(stored: xr.Dataset) -> str:
    """What a file says that it holds, "fit"; empty for a result."""
    return str(stored.attrs.get(HOLDS, ""))


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


def _read_through(content: bytes) -> None:
    """Read the whole file with h5py first, which raises where it is damaged; h5netcdf would write to stderr instead."""
    with h5py.File(io.BytesIO(content), "r") as file:
        dict(file.attrs)
        for member in file.values():
            dict(member.attrs)
            if isinstance(member, h5py.Dataset):
                member[...]
