"""The vectors of a MAT file → heads and columns: of its top level, or of one of its structs."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from mckibben.data.heads import read_head
from mckibben.spec.errors import SpecError, nearest

__all__ = ["columns_of_mat", "is_mat"]

_OLD, _NEW = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"
_HDF5 = b"\x89HDF\r\n\x1a\n"
_TOP = "the top level"
_DEEPEST = 8
"""Structs within structs at most."""

Vectors = dict[str, list[object]]


def is_mat(content: bytes, name: str) -> bool:
    """Whether a file's content is that of a MAT file; of the oldest kind, which has no mark, its name tells."""
    marked = content.startswith((_OLD, _NEW))
    return marked or (name.lower().endswith(".mat") and (content.startswith(_HDF5) or content[:4] in _VERSION_4))


_VERSION_4 = tuple(int(code).to_bytes(4, "little") for code in (0, 10, 20, 30, 40, 50))
"""How variables of numbers begin in files of version 4."""


def columns_of_mat(content: bytes, name: str, sheet: str | int | None) -> tuple[Vectors, list[str]]:
    """The columns of a struct, or of the top level, by their names, and what was taken for granted.

    Single numbers beside vectors count for every row. SpecError where several structs could be meant, or none.
    """
    read = _read_new if content.startswith((_NEW, _HDF5)) else _read_old
    try:
        variables = read(content)
    except SpecError:
        raise
    except Exception as error:  # both libraries raise many kinds for files that are damaged or something else
        said = f"is no MAT file that can be read: {error}"
        raise SpecError(name, allowed=said, advice="save it again in MATLAB, or write a CSV file") from error
    found: dict[str, Mapping[str, Any]] = {}
    _gather(variables, "", found)
    told = {group: vectors for group, held in found.items() if (vectors := _vectors(held))}
    if not told:
        said = "holds no vectors of numbers"
        advice = "save vectors or a struct of them; a table first becomes one: s = table2struct(t, ToScalar=true)"
        raise SpecError(name, allowed=said, advice=advice)
    group = _chosen(sheet, told, name)
    columns, notes = _aligned(told[group], _of(name, group))
    singles = {key: value for key, value in _singles(found[group]).items() if read_head(key).readings}
    count = len(next(iter(columns.values())))
    for key, value in singles.items():
        columns[key] = [value] * count
        notes.append(f"{key} is a single number, taken for every row")
    return columns, notes


def _of(name: str, group: str) -> str:
    return name if group == _TOP else f"{name}, {group}"


def _gather(held: Mapping[str, Any], path: str, found: dict[str, Mapping[str, Any]], depth: int = 0) -> None:
    """The structs of a file by their names, the top level too."""
    found[path or _TOP] = held
    for key, value in held.items():
        inner = f"{path}.{key}" if path else key
        if isinstance(value, Mapping) and depth < _DEEPEST:
            _gather(value, inner, found, depth + 1)
        elif isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
            for number, one in enumerate(value, 1):
                _gather(one, f"{inner}({number})", found, depth + 1)


def _vectors(held: Mapping[str, Any]) -> Vectors:
    """Those of two and more numbers, or of texts."""
    found: Vectors = {}
    for key, value in held.items():
        array = np.asarray(value) if isinstance(value, (np.ndarray, list)) else np.zeros(0)
        if array.ndim != 1 or len(array) < 2:
            continue
        if array.dtype.kind in "fiu":
            found[key] = array.astype(float).tolist()
        elif array.dtype.kind in "UO" and all(isinstance(one, str) for one in array.tolist()):
            found[key] = array.tolist()
    return found if any(not isinstance(column[0], str) for column in found.values()) else {}


def _singles(held: Mapping[str, Any]) -> dict[str, float]:
    numbers = {}
    for key, value in held.items():
        array = np.asarray(value) if isinstance(value, (int, float, np.ndarray, np.generic)) else np.zeros(0)
        if array.size == 1 and array.dtype.kind in "fiu":
            numbers[key] = float(array.ravel()[0])
    return numbers


def _chosen(sheet: str | int | None, told: Mapping[str, Vectors], name: str) -> str:
    """The struct that is meant: the one asked for, or the only one in which something of a bench is understood."""
    if sheet is not None:
        known = list(told)
        if isinstance(sheet, int) and not isinstance(sheet, bool) and 1 <= sheet <= len(known):
            return known[sheet - 1]
        if str(sheet) in told:
            return str(sheet)
        raise SpecError(f"{name}, sheet", sheet, "is none of its structs", nearest(str(sheet), known))
    usable = [group for group, vectors in told.items() if sum(bool(read_head(key).readings) for key in vectors) >= 2]
    usable = usable or list(told)
    if len(usable) > 1:
        listed = ", ".join(f'"{group}"' for group in usable)
        advice = f'say sheet="{usable[0]}" (--sheet)'
        raise SpecError(name, allowed=f"has vectors in several structs: {listed}", advice=advice)
    return usable[0]


def _aligned(vectors: Vectors, place: str) -> tuple[Vectors, list[str]]:
    """The vectors that are as long as those in which something is understood."""
    understood = {key: len(column) for key, column in vectors.items() if read_head(key).readings} or {
        key: len(column) for key, column in vectors.items()
    }
    if len(set(understood.values())) > 1:
        listed = ", ".join(f"{key} has {count}" for key, count in understood.items())
        raise SpecError(place, allowed=f"its vectors have different lengths: {listed}", advice="save one of each point")
    count = next(iter(understood.values()))
    other = [key for key, column in vectors.items() if len(column) != count]
    notes = [f"of another length and left out: {', '.join(other)}"] if other else []
    return {key: column for key, column in vectors.items() if len(column) == count}, notes


def _read_old(content: bytes) -> dict[str, Any]:
    """Of a file up to version 7."""
    from scipy.io import loadmat

    held = loadmat(io.BytesIO(content), simplify_cells=True)
    return {key: value for key, value in held.items() if not key.startswith("__")}


def _read_new(content: bytes) -> dict[str, Any]:
    """Of a file of version 7.3, which is HDF5."""
    import h5py

    with h5py.File(io.BytesIO(content), "r") as file:
        return {key: _plain(file, value) for key, value in file.items() if not key.startswith("#")}


def _plain(file: Any, item: Any) -> Any:
    """A struct as a mapping, a list of them as a list, numbers as an array, texts as text; None for what is empty."""
    import h5py

    if isinstance(item, h5py.Group):
        return {key: _plain(file, value) for key, value in item.items()}
    kind = item.attrs.get("MATLAB_class", b"")
    if item.attrs.get("MATLAB_empty", 0):
        return None
    values = item[()]
    if item.dtype == h5py.ref_dtype:  # a cell, or the field of several structs
        return [_plain(file, file[one]) for one in np.ravel(values)]
    if kind == b"char":
        return "".join(chr(int(code)) for code in np.ravel(values))
    array = np.squeeze(np.asarray(values))
    return array if array.ndim else array[()]
