"""Sweeps as Zarr stores (format 3), written chunk by chunk, and damage to them found and mended.

Every array lies along `design`, in the chunks of the sweep. The chunk of `status` is written last, after all others are
on the disk, as one file moved into its place: where it is, the chunk is whole; where it is not, whatever else there is
of the chunk counts for nothing and is written again. Only one process writes. What was damaged since is known by
digests: it is not loaded, and the same sweep mends it.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Any

import attrs
import dask.array
import numpy as np
import xarray as xr

from mckibben import disk
from mckibben.spec.errors import SpecError
from mckibben.sweeps.chunkfiles import MARK, ChunkFiles, identity_digest
from mckibben.sweeps.dataset import arranged
from mckibben.sweeps.description import DIGESTS, check_same, damage, describe, mend, sweep_in
from mckibben.sweeps.outcome import DESIGN, LATER, STATES, Columns
from mckibben.sweeps.plan import Plan
from mckibben.sweeps.trouble import SweepError

__all__ = ["Store", "is_store", "load"]

_BROKEN = (OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError, RecursionError,
           MemoryError, NotImplementedError)  # fmt: skip
"""What Zarr and xarray raise for a description that was damaged; one with digests does not come so far."""

MENDED = "run the same sweep again: it mends this and keeps the rest"


def is_store(path: str | PathLike[str]) -> bool:
    """Whether there is a Zarr store at `path`."""
    return (Path(path) / "zarr.json").is_file()


@attrs.frozen
class Store:
    """The store of one sweep, made or found again by `Store.of`."""

    path: Path
    plan: Plan
    files: ChunkFiles

    @classmethod
    def of(cls, path: str | PathLike[str], plan: Plan, force: bool = False) -> Store:
        """The store for a sweep at `path`: a new one, or one that holds part of the same sweep, mended if need be.

        Raises SpecError for a place that cannot be written, or that holds something else; with `force` another sweep
        there is deleted.
        """
        target = Path(os.path.realpath(path))
        if not target.name.endswith(".zarr"):
            raise SpecError(str(path), allowed="must end in .zarr")
        sweep = identity_digest(plan.identity())
        files = ChunkFiles(target, sweep, len(plan), plan.chunk, plan.steps, noted=True)
        store = cls(target, plan, files)
        if target.exists():
            notes = _notes(target)
            if notes != {sweep} and not (force and notes):  # else a store of ours, whatever became of its description
                there = _sweep_in(path)
                if not force:
                    check_same(str(path), there, plan.identity())
            if not force:
                return store._gone_on_with()
        elif not target.parent.is_dir():
            raise SpecError(str(path), allowed=f"there is no folder {target.parent}", advice="make it first")
        with _writing(target), disk.new_folder(target) as made:  # made beside the place and moved into it whole
            describe(made, plan)
        return store

    def _gone_on_with(self) -> Store:
        """This store as it is on the disk, with digests of everything and a description as it was written."""
        attributes: dict[str, Any] = {}
        with _writing(self.path):
            with suppress(SpecError):
                _, document = sweep_in(self.path, str(self.path))
                attributes = document["attributes"]
            if attributes and DIGESTS not in attributes:  # from before there were digests
                attrs.evolve(self.files, noted=False).note_all()
            if DIGESTS not in attributes or damage(self.path, document):
                date = attributes.get("date", "")
                mend(self.path, self.plan, date if isinstance(date, str) else "")
        return self

    @property
    def missing(self) -> list[int]:
        """The chunks that are yet to be solved: not written, damaged, or with designs on which the program failed."""
        with _writing(self.path):
            return self.files.missing()

    def put(self, index: int, columns: Columns) -> None:
        """Keep the designs of a chunk: all of them once this returns, or none. SweepError where it cannot be."""
        with _writing(self.path):
            self.files.mark(index).unlink(missing_ok=True)
            contents = self.files.contents(columns)
            parts = [(self.files.file(name, index), data) for name, data in contents.items() if name != MARK]
            parts.append((self.files.note(index), self.files.noting(index, contents)))
            with ThreadPoolExecutor(len(parts)) as together:  # the disk settles many files in the time of one
                list(together.map(_write, *zip(*parts, strict=True)))
            _write(self.files.mark(index), contents[MARK])

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


def _write(path: Path, data: bytes) -> None:
    """A chunk file; only this process writes."""
    path.parent.mkdir(exist_ok=True)
    disk.replace(path, data, alone=True)


def _notes(path: Path) -> set[str]:
    """The sweeps that the notes on the chunks of a store speak of."""
    found = set()
    for note in (path / MARK).glob("sha256.*"):
        with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
            found.add(str(json.loads(note.read_bytes())["sweep"]))
    return found


def _sweep_in(path: str | PathLike[str]) -> dict[str, Any]:
    """What the sweep in a store depends on. SpecError, in one line, where there is no store of a sweep."""
    name = str(path)
    if not Path(path).exists():
        raise SpecError(name, allowed="there is no such store")
    if not is_store(path):
        if _notes(Path(path)):
            raise SpecError(name, allowed="is damaged: it has no zarr.json", advice=MENDED)
        raise SpecError(name, allowed="is no store of a sweep", advice="give another name ending in .zarr")
    return sweep_in(Path(path), name)[0]


def load(path: str | PathLike[str]) -> xr.Dataset:
    """The sweep in a store, finished or not, arranged by its fields and read from the disk when used.

    SpecError for a store that is damaged, by the digests of all that it holds. Designs that are pending hold nothing.
    """
    _sweep_in(path)
    held, document = sweep_in(Path(path), str(path))
    wrong = damage(Path(path), document)
    if DIGESTS not in document["attributes"] and _notes(Path(path)):
        wrong = ["zarr.json"]
    if wrong:
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        said = f"is damaged: its description ({wrong[0]}{more}) is not as written"
        raise SpecError(str(path), allowed=said, advice=MENDED)
    try:
        whole = xr.open_zarr(path, consolidated=True, decode_times=False)
        stored = whole[[name for name in (*STATES, *DESIGN) if name not in LATER or name in whole]]
        stored.attrs.pop(DIGESTS, None)
        noted, sweep = DIGESTS in document["attributes"], identity_digest(held)
        count, steps = stored["force"].shape
        files = ChunkFiles(Path(path), sweep, count, int(held["chunk"]), steps, noted)
        _check_chunks(str(path), files)
        return arranged(_with_later(_without_pending(stored, files.there()).chunk(design=-1)))
    except SpecError:
        raise
    except _BROKEN as error:
        said = "is damaged: " + " ".join(str(error).split())
        raise SpecError(str(path), allowed=said, advice="run the sweep again with --force") from error


def _check_chunks(name: str, files: ChunkFiles) -> None:
    """SpecError that names the chunks that are not as written."""
    damaged = files.damaged()
    if not damaged:
        return
    said = []
    for index, wrong in list(damaged.items())[:3]:
        first, last = index * files.chunk, min((index + 1) * files.chunk, files.count) - 1
        parts = ", ".join(wrong[:3]) + (f" and {len(wrong) - 3} more" if len(wrong) > 3 else "")
        said.append(f"chunk {index} (designs {first} to {last}: {parts})")
    more = f" and {len(damaged) - 3} more chunks" if len(damaged) > 3 else ""
    raise SpecError(
        name, allowed=f"is damaged: {', '.join(said)}{more} not as written",
        advice=f"{MENDED}, solving these designs anew",
    )  # fmt: skip


def _without_pending(stored: xr.Dataset, there: np.ndarray) -> xr.Dataset:
    """The arrays of a store with nothing in the designs of chunks that are not there, whose files are not read."""
    if there.all():
        return stored
    edges = [0, *(np.flatnonzero(np.diff(there)) + 1).tolist(), len(there)]
    made = {}
    for name, kept in (STATES | DESIGN).items():
        if name not in stored:
            continue
        data = stored[name].data
        parts = []
        for first, last in pairwise(edges):
            part = data[first:last]
            kind = object if kept.dtype == "str" else data.dtype
            parts.append(part if there[first] else dask.array.full(part.shape, kept.fill, kind, chunks=part.chunks))
        made[name] = (stored[name].dims, dask.array.concatenate(parts), stored[name].attrs)
    return stored.assign(made)


def _with_later(stored: xr.Dataset) -> xr.Dataset:
    """With what a store of an earlier version does not hold, as NaN."""
    lacking = [name for name in LATER if name not in stored]
    return stored.assign({
        name: (stored["force"].dims, dask.array.full_like(stored["force"].data, np.nan), STATES[name].attributes)
        for name in lacking
    })  # fmt: skip
