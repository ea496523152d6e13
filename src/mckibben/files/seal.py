"""The seal at the end of a NetCDF-4 file: a digest of every byte before it, so that no damaged file passes for whole.

HDF5 reads a file up to the end that its first bytes name, and leaves alone what follows: other programs do not notice
the seal. It is checked before HDF5 sees the file, which on damaged bytes may give other numbers or never come back.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from typing import TypeAlias

__all__ = ["Parts", "damage", "sealed"]

Parts: TypeAlias = dict[str, tuple[int, int]]
"""Where in the file the numbers of a variable are: first byte and number of bytes."""

SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MARK = b"\nmckibben seal "
_DIGITS = 64  # of a SHA-256 in hexadecimal


def sealed(content: bytes | memoryview, parts: Parts) -> bytes:
    """A file with its seal. The parts are listed in it with a checksum each, to tell which of them was damaged."""
    body = bytes(content)
    listed = {name: [at, size, zlib.crc32(body[at : at + size])] for name, (at, size) in parts.items()}
    index = json.dumps({"bytes": len(body), "parts": listed}, separators=(",", ":")).encode()
    return body + _MARK + _digest(body, index) + b" " + index + b"\n"


def damage(content: bytes) -> str | None:
    """What is not as written, in words; None for a file that is whole, or that never had a seal.

    That a file had one is known by what follows its end, so that no damage to the seal itself hides another.
    """
    at = content.rfind(_MARK)
    if at < 0:
        return "its seal" if len(content) > _end(content) > 0 else None
    body, seal = content[:at], content[at + len(_MARK) :]
    said, index = seal[:_DIGITS], seal[_DIGITS + 1 : -1]
    if seal == _digest(body, index) + b" " + index + b"\n":
        return None
    try:
        parts = json.loads(index)["parts"].items()
        wrong = [name for name, (at, size, check) in parts if zlib.crc32(body[at : at + size]) != check]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return "its seal"
    listed = ", ".join(str(name) for name in wrong[:4]) + (f" and {len(wrong) - 4} more" if len(wrong) > 4 else "")
    return listed or ("its text or description" if said.isalnum() else "its seal")


def _digest(body: bytes, index: bytes) -> bytes:
    return hashlib.sha256(body + b"\0" + index).hexdigest().encode()


def _end(content: bytes) -> int:
    """Where HDF5 says that the file ends, by the superblock that it begins with; 0 where that cannot be read."""
    place = {0: 40, 1: 44, 2: 28, 3: 28}.get(content[8]) if len(content) > 52 else None
    return int.from_bytes(content[place : place + 8], "little") if place is not None else 0
