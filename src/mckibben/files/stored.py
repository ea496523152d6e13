"""What kinds of answers share in files: their Dataset written, read back and checked, and the muscles in it."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.files.hdf5 import HOLDS, kind, written
from mckibben.results.found import NUMBERS, Found
from mckibben.spec import Muscle
from mckibben.spec.errors import SpecError
from mckibben.spec.plausible import trusted
from mckibben.spec.text import muscle_from_mapping

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FOUND", "Needed", "checked", "muscle_in", "of_numbers", "rebuilt", "write"]

Needed = Mapping[str, tuple[tuple[str, ...], str]]
"""Of each variable that must be there: its dimensions, and NumPy's letter of the kind of data."""
FOUND: Needed = {
    **{name: (("number",), "f") for name in NUMBERS},
    **{name: (("number", "other"), "f") for name in ("correlation", "covariance")},
    **{name: (("number",), "U") for name in ("number", "unit", "display", "meaning")},
    "other": (("other",), "U"), "undetermined": (("number",), "b"),
}  # fmt: skip
"""The same of numbers that a fit found."""


def write(data: xr.Dataset, what: str, path: str | PathLike[str], force: bool) -> Path:
    """Write a Dataset that is a `what` as a NetCDF-4 file; SpecError if it exists (without `force`)."""
    variables = {str(name): (tuple(map(str, item.dims)), item.values, item.attrs)
                 for name, item in data.variables.items()}  # fmt: skip
    texts = {name: (dims, array.astype(str) if array.dtype.kind in "OT" else array, about)
             for name, (dims, array, about) in variables.items()}  # fmt: skip
    sizes = {str(name): int(size) for name, size in data.sizes.items()}
    return written(path, sizes, texts, {HOLDS: what} | data.attrs, force)


def checked(
    stored: xr.Dataset, name: str, what: str, needed: Needed, about_needed: Mapping[str, type], axes: tuple[str, ...]
) -> xr.Dataset:
    """The Dataset of a `what` in a file of this name; SpecError where it holds something else."""
    import xarray as xr

    if kind(stored) != what:
        advice = f"give what mckibben {what} or mk.save wrote"
        raise SpecError(name, allowed=f"holds no {what} of mckibben", advice=advice)
    about = {str(key): _plain(value) for key, value in stored.attrs.items() if key != HOLDS}
    for key, type_ in about_needed.items():
        if not isinstance(about.get(key), type_):
            raise SpecError(name, allowed=f"does not say its {key}", advice="make it again")
    variables = {}
    for variable in [*needed, *(str(one) for one in stored.variables if one not in needed)]:
        if variable not in stored.variables:
            raise SpecError(name, allowed=f"holds no {variable} of a {what} (written by {about['mckibben_version']})")
        array = np.asarray(stored[variable].values)
        array = array.astype(str) if array.dtype.kind in "OT" else array
        dims = tuple(map(str, stored[variable].dims))
        if needed.get(variable, (dims, array.dtype.kind)) != (dims, array.dtype.kind):
            raise SpecError(name, allowed=f"holds {variable} per {' and '.join(dims)} as {array.dtype}")
        array.flags.writeable = False
        variables[variable] = (dims, array, dict(stored[variable].attrs))
    coords = {axis: variables.pop(axis) for axis in axes if axis in variables}
    return xr.Dataset(
        {str(one): variables[str(one)] for one in stored.data_vars if str(one) in variables}, coords, about
    )


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def muscle_in(name: str, text: str) -> Muscle:
    """The muscle that a file of this name has as TOML; SpecError where it cannot be built."""
    muscle: Muscle = rebuilt(name, "muscle", text, muscle_from_mapping)
    return muscle


def rebuilt(name: str, what: str, text: str, build: Callable[[dict[str, Any]], Any]) -> Any:
    """What a file of this name has as TOML, a muscle say; SpecError where it cannot be built."""
    try:
        with trusted():
            return build(tomllib.loads(text))
    except SpecError as error:
        advice = "its numbers can be read with xarray.open_dataset"
        raise SpecError(name, allowed=f"its {what} cannot be built again: {error}", advice=advice) from error
    except (ValueError, RecursionError) as error:
        raise SpecError(name, allowed=f"is damaged: its {what} is not TOML", advice="make it again") from error


def of_numbers(found: Found) -> Iterator[str]:
    """Notes beside a table: the numbers that a fit found, and what must be known of them."""
    yield f"the numbers, with intervals at {100.0 * found.data.attrs['level']:g} %:"
    for name, row in found.table.iterrows():
        yield f"{name}: {row['value']}, standard error {row['error'] or 'unknown'}, interval {row['interval']}"
    yield ""
    yield from (f"note: {line}" for line in found.notes)
    yield ""
