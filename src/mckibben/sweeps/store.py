"""Sweeps as Zarr stores (format 3), written chunk by chunk.

Every array lies along `design`, in the chunks of the sweep. The chunk of `status` is written last, after all others are
on the disk, as one file moved into its place: where it is, the chunk is whole; where it is not, whatever else there is
of the chunk counts for nothing and is written again. Only one process writes.
"""

from __future__ import annotations

import errno
import json
import os
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import xarray as xr
import zarr
from numcodecs import VLenUTF8

from mckibben import disk
from mckibben.spec.errors import SpecError
from mckibben.sweeps.dataset import about, arranged, coordinates
from mckibben.sweeps.outcome import DESIGN, STATES, STATUSES, Columns, Kept, Status
from mckibben.sweeps.plan import Plan
from mckibben.sweeps.trouble import SweepError

__all__ = ["Store", "is_store", "load"]

_MARK = "status"
_KEYS: dict[str, Any] = {"name": "default", "separator": "."}
"""Chunk files lie side by side in the folder of their array: force/c.3.0."""


def is_store(path: str | PathLike[str]) -> bool:
    """Whether there is a Zarr store at `path`."""
    return (Path(path) / "zarr.json").is_file()


@attrs.frozen
class Store:
    """The store of one sweep, made or found again by `Store.of`."""

    path: Path
    plan: Plan

    @classmethod
    def of(cls, path: str | PathLike[str], plan: Plan, force: bool = False) -> Store:
        """The store for a sweep at `path`: a new one, or one that holds part of the same sweep.

        Raises SpecError for a place that cannot be written, or that holds something else; with `force` another sweep
        there is deleted.
        """
        target = Path(os.path.realpath(path))
        if not target.name.endswith(".zarr"):
            raise SpecError(str(path), allowed="must end in .zarr")
        store = cls(target, plan)
        if target.exists():
            there = _sweep_in(path)
            if not force:
                _check_same(str(path), there, plan.identity())
                return store
        elif not target.parent.is_dir():
            raise SpecError(str(path), allowed=f"there is no folder {target.parent}", advice="make it first")
        store._create()
        return store

    def _create(self) -> None:
        """Everything but the results, made beside the place and moved into it whole."""
        with _writing(self.path), disk.new_folder(self.path) as made:
            _describe(made, self.plan)

    @property
    def missing(self) -> list[int]:
        """The chunks that are yet to be solved: those not written whole, and those on which the program failed."""
        return [index for index in range(self.plan.chunks) if self._failed(index) is not False]

    def _failed(self, index: int) -> bool | None:
        """Whether the program failed on a design of a chunk; None for a chunk that is not there."""
        try:
            marks = np.frombuffer(self._mark(index).read_bytes(), np.int8)
        except FileNotFoundError:
            return None
        whole = len(marks) == self.plan.chunk
        return bool((marks == STATUSES.index(Status.FAILED)).any()) if whole else None

    def _mark(self, index: int) -> Path:
        return self.path / _MARK / f"c.{index}"

    def put(self, index: int, columns: Columns) -> None:
        """Keep the designs of a chunk: all of them once this returns, or none. SweepError where it cannot be."""
        with _writing(self.path):
            self._mark(index).unlink(missing_ok=True)
            parts = [
                (self.path / name / _file(name, index), self._encoded(name, columns)) for name in (*STATES, *DESIGN)
            ]
            with ThreadPoolExecutor(len(parts)) as together:  # the disk settles many files in the time of one
                list(together.map(_write, *zip(*parts[:-1], strict=True)))
            _write(*parts[-1])

    def _encoded(self, name: str, columns: Columns) -> bytes:
        """The designs of a chunk as the bytes of a chunk file, the last one filled up."""
        kept = (STATES | DESIGN)[name]
        values = columns[name]
        whole = np.full((self.plan.chunk, *values.shape[1:]), kept.fill, object if kept.dtype == "str" else kept.dtype)
        whole[: len(values)] = values
        if kept.dtype == "str":
            return bytes(VLenUTF8().encode(whole))
        return whole.astype(whole.dtype.newbyteorder("<")).tobytes()

    def dataset(self) -> xr.Dataset:
        """What the store holds, arranged by its fields and read from the disk when used."""
        return load(self.path)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT)
        said = "the disk is full" if full else f"cannot be written: {error.strerror or error}"
        raise SweepError(f"{path}: {said}; what is finished is kept, and the same sweep goes on from there") from error


def _file(name: str, index: int) -> str:
    return f"c.{index}.0" if name in STATES else f"c.{index}"


def _write(path: Path, data: bytes) -> None:
    """A chunk file; only this process writes."""
    disk.replace(path, data, alone=True)


def _describe(path: Path, plan: Plan) -> None:
    """A store without results: the arrays, what each field is in each design, and the attributes."""
    count, steps = len(plan), plan.steps
    fields = " ".join(varied.field for varied in plan.varied)  # this is how xarray knows them for coordinates
    group = zarr.create_group(path, zarr_format=3, attributes=about(plan) | {"coordinates": fields})
    for name, (dim, values, attributes) in coordinates(plan).items():
        kind = "str" if values.dtype.kind in "UO" else str(values.dtype)
        chunks = (min(max(plan.chunk, 2**14), max(len(values), 1)),)
        made = _made(group, name, Kept(kind, attributes), values.shape, chunks, (dim,))
        made[:] = values.astype(object) if kind == "str" else values
    for name, kept in STATES.items():
        _made(group, name, kept, (count, steps), (plan.chunk, steps), ("design", "step"))
    for name, kept in DESIGN.items():
        _made(group, name, kept, (count,), (plan.chunk,), ("design",))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        zarr.consolidate_metadata(path, zarr_format=3)


def _made(
    group: zarr.Group, name: str, kept: Kept, shape: tuple[int, ...], chunks: tuple[int, ...], dims: tuple[str, ...]
) -> Any:
    """One array. Its chunks are not compressed: the last digits of numbers do not shrink, and writing is simple."""
    return group.create_array(
        name, shape=shape, chunks=chunks, dtype=kept.dtype, fill_value=kept.fill, dimension_names=dims,
        attributes=kept.attributes, chunk_key_encoding=_KEYS, compressors=None,
    )  # fmt: skip


def _sweep_in(path: str | PathLike[str]) -> dict[str, Any]:
    """What the sweep in a store depends on. SpecError, in one line, where there is no store of a sweep."""
    name = str(path)
    if not Path(path).exists():
        raise SpecError(name, allowed="there is no such store")
    if not is_store(path):
        raise SpecError(name, allowed="is no store of a sweep", advice="give another name ending in .zarr")
    try:
        attributes = json.loads((Path(path) / "zarr.json").read_bytes())["attributes"]
        held: dict[str, Any] = json.loads(attributes["sweep"])
    except OSError as error:
        raise SpecError(name, allowed=f"cannot be read: {error.strerror or error}") from error
    except (ValueError, KeyError, TypeError) as error:
        raise SpecError(name, allowed="is no store of a sweep of mckibben") from error
    return held


def _check_same(name: str, there: dict[str, Any], here: dict[str, Any]) -> None:
    """SpecError that says what differs, unless the sweep in a store is the one that is asked for."""
    here = json.loads(json.dumps(here))  # as it reads back
    if there == here:
        return
    then, now = dict(_leaves(there)), dict(_leaves(here))
    differing = [key for key in {**now, **then} if then.get(key) != now.get(key)]
    key = differing[0] if differing else "its form"
    said = f"holds another sweep: {key} is {_brief(then.get(key))} there and {_brief(now.get(key))} here"
    more = f" ({len(differing)} differences)" if len(differing) > 1 else ""
    raise SpecError(name, allowed=said + more, advice="give another name, or --force to delete it (force=True)")


def _leaves(value: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, f"{prefix}.{key}" if prefix else key)
    else:
        yield prefix, value


def _brief(value: Any) -> str:
    text = "not given" if value is None else json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def load(path: str | PathLike[str]) -> xr.Dataset:
    """The sweep in a store, finished or not, arranged by its fields and read from the disk when used."""
    _sweep_in(path)
    try:
        stored = xr.open_zarr(path, consolidated=True, decode_times=False)
        return arranged(stored[[*STATES, *DESIGN]].chunk(design=-1))
    except (OSError, ValueError, KeyError, TypeError) as error:
        said = "is damaged: " + " ".join(str(error).split())
        raise SpecError(str(path), allowed=said, advice="run the sweep again with --force") from error
