"""Executables in memory: a bounded number, of which the least recently used goes first.

An executable takes some hundreds of memory mappings, and Linux allows a process 65,530 of them: one that went on
compiling would crash in the midst of it. What goes is read from the disk again when it is called.
"""

import threading
from typing import Any, NamedTuple

from mckibben.compiled.executable import Executable

__all__ = ["LIMIT", "forget", "remember"]

LIMIT = 100
"""About 25,000 mappings; a script needs 10 to 30 executables, a long session with all effects some more."""

Known = dict[Any, Executable]


class _Entry(NamedTuple):
    known: Known
    key: Any
    executable: Executable


_entries: list[_Entry] = []
_lock = threading.Lock()


def remember(known: Known, key: Any, executable: Executable) -> None:
    """Put it among those known, in place of the least recently used of all if they are too many."""
    with _lock:
        if len(_entries) >= LIMIT:
            oldest = _entries.pop(min(range(len(_entries)), key=lambda i: _entries[i].executable.used))
            oldest.known.pop(oldest.key, None)
        known[key] = executable
        _entries.append(_Entry(known, key, executable))


def forget(known: Known, key: Any = None) -> None:
    """Take one of what a kernel knows, or all of it."""
    with _lock:
        gone = [i for i, entry in enumerate(_entries) if entry.known is known and key in (None, entry.key)]
        for i in reversed(gone):
            del known[_entries.pop(i).key]
