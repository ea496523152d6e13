"""The files of the chunks of a store: their names and bytes, and whether a chunk is whole.

Beside the last file of a chunk, which says that the chunk is there, lies a note: the digest (SHA-256) of each of its
files, which chunk it is, and the digest of its sweep. Chunks from before there were notes are known by the size of
their files.
"""

from __future__ import annotations

import hashlib
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import attrs
import numpy as np
from numcodecs import VLenUTF8

from mckibben import disk
from mckibben.sweeps.outcome import DESIGN, LATER, STATES, STATUSES, Columns, Kept, Status

__all__ = ["MARK", "ChunkFiles", "digest", "identity_digest"]

MARK = "status"
_NAMES = (*STATES, *DESIGN)
_THREADS = 8


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def identity_digest(identity: Any) -> str:
    """Digest of what a sweep depends on, as given or as read back from JSON."""
    return digest(json.dumps(json.loads(json.dumps(identity)), sort_keys=True).encode())


@attrs.frozen
class ChunkFiles:
    """The files of the chunks of one store."""

    path: Path
    sweep: str  #: digest of what the sweep depends on
    count: int  #: designs in all
    chunk: int  #: designs in a chunk
    steps: int
    noted: bool  #: whether every chunk has its note

    @property
    def names(self) -> tuple[str, ...]:
        """The variables of the store; one of an earlier version lacks some."""
        return tuple(name for name in _NAMES if name not in LATER or (self.path / name).exists())

    def file(self, name: str, index: int) -> Path:
        return self.path / name / (f"c.{index}.0" if name in STATES else f"c.{index}")

    def mark(self, index: int) -> Path:
        """The file that is written last."""
        return self.file(MARK, index)

    def note(self, index: int) -> Path:
        return self.path / MARK / f"sha256.{index}"

    def contents(self, columns: Columns) -> dict[str, bytes]:
        """The designs of a chunk as the bytes of its files, by variable."""
        return {name: self._encoded((STATES | DESIGN)[name], columns[name]) for name in self.names}

    def _encoded(self, kept: Kept, values: np.ndarray) -> bytes:
        """Values as a chunk file; the last one is filled up."""
        whole = np.full((self.chunk, *values.shape[1:]), kept.fill, object if kept.dtype == "str" else kept.dtype)
        whole[: len(values)] = values
        if kept.dtype == "str":
            return bytes(VLenUTF8().encode(whole))
        return whole.astype(whole.dtype.newbyteorder("<")).tobytes()

    def noting(self, index: int, contents: dict[str, bytes]) -> bytes:
        """The note on a chunk."""
        said = {"sweep": self.sweep, "chunk": index}
        return json.dumps(said | {name: digest(data) for name, data in contents.items()}).encode()

    def note_all(self) -> None:
        """Write the missing notes on chunks that are there and have the form of whole ones. OSError."""
        for index, wrong in self._surveyed().items():
            if wrong == [] and not self.note(index).exists():
                contents = {name: self._bytes(name, index) for name in self.names}
                disk.replace(self.note(index), self.noting(index, contents), alone=True)

    def damage(self, index: int) -> list[str] | None:
        """The variables of a chunk whose file is not as written; None where the chunk is not there."""
        if not self.mark(index).exists():
            return None
        try:
            said = json.loads(self.note(index).read_bytes())
            ours = isinstance(said, dict) and (said.get("sweep"), said.get("chunk")) == (self.sweep, index)
        except FileNotFoundError:
            if not self.noted:
                return [name for name in self.names if not self._fits(name, index)]
            ours = False
        except (ValueError, RecursionError):
            ours = False
        return (
            [name for name in self.names if digest(self._bytes(name, index)) != said.get(name)]
            if ours
            else ["its note"]
        )

    def damaged(self) -> dict[int, list[str]]:
        """The chunks that are there and not whole, with what is wrong of each."""
        return {index: wrong for index, wrong in self._surveyed().items() if wrong}

    def missing(self) -> list[int]:
        """The chunks that are yet to be solved: not there, not whole, or with designs on which the program failed."""
        return [index for index, wrong in self._surveyed().items() if wrong != [] or self._failed(index)]

    def there(self) -> np.ndarray:
        """Whether the chunk of each design is there."""
        found = [self.mark(index).exists() for index in range(-(-self.count // self.chunk))]
        return np.repeat(np.array(found, bool), self.chunk)[: self.count]

    def _surveyed(self) -> dict[int, list[str] | None]:
        indices = range(-(-self.count // self.chunk))
        with ThreadPoolExecutor(_THREADS) as together:  # reading, and digests of what is read, in many threads at once
            return dict(zip(indices, together.map(self.damage, indices), strict=True))

    def _failed(self, index: int) -> bool:
        marks = np.frombuffer(self._bytes(MARK, index), np.int8)
        return bool((marks == STATUSES.index(Status.FAILED)).any())

    def _bytes(self, name: str, index: int) -> bytes:
        try:
            return self.file(name, index).read_bytes()
        except FileNotFoundError:
            return b""

    def _fits(self, name: str, index: int) -> bool:
        """Whether a file has the form of what it should hold."""
        data, kept = self._bytes(name, index), (STATES | DESIGN)[name]
        if kept.dtype == "str":
            try:
                return len(VLenUTF8().decode(data)) == self.chunk
            except (ValueError, RuntimeError):
                return False
        wanted = self.chunk * (self.steps if name in STATES else 1) * np.dtype(kept.dtype).itemsize
        marks = np.frombuffer(data, np.int8) if name == MARK else np.zeros(1)
        inside = marks[: self.count - index * self.chunk]
        return len(data) == wanted and bool(((inside >= 0) & (inside < len(STATUSES))).all())
