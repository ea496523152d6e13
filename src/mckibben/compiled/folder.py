"""The folder of compiled functions, kept between processes: where it is, how full it may be. Does without JAX."""

from __future__ import annotations

import hashlib
import os
import platform
import stat
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path

__all__ = ["LIMIT", "SUFFIX", "content", "folder", "off", "private", "processor", "ready", "size"]

SUFFIX = ".kernel"
LIMIT = 2**31
"""Bytes above which files are deleted, those first that were not used for longest, until half is left: some 1,000
functions of one to a few MB."""
_READING = os.O_RDONLY
for _flag in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"):  # as far as the system has them; a pipe must not be waited for
    _READING |= getattr(os, _flag, 0)


def off() -> bool:
    """Whether the user wants nothing to be kept."""
    return os.environ.get("MCKIBBEN_CACHE") == "off"


def folder() -> Path:
    """Where compiled functions are kept, if they are.

    MCKIBBEN_CACHE, else `kernels` in JAX_COMPILATION_CACHE_DIR, else the user's folder of cached files, with one folder
    for each version of JAX and each processor.
    """
    given, of_jax = os.environ.get("MCKIBBEN_CACHE"), os.environ.get("JAX_COMPILATION_CACHE_DIR")
    if given and not off():
        return Path(given)
    if of_jax:
        return Path(of_jax) / "kernels"
    from platformdirs import user_cache_dir

    return Path(user_cache_dir("mckibben", appauthor=False)) / f"jax-{version('jax')}-{processor()}"


def ready() -> Path | None:
    """The folder, made where it is missing and cleared where it is too full; None where nothing can be kept."""
    if off():
        return None
    place = folder()
    if not private(place):
        return None
    if size(place)[1] > LIMIT:
        _clear(place)
    return place


def private(place: Path) -> bool:
    """Whether the user can put files there and nobody else can; the folder is made if missing.

    What is kept is machine code, which nobody else may slip in.
    """
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = place.stat()
    except OSError:
        return False
    return os.access(place, os.W_OK | os.X_OK) and _own(about)


def content(file: Path) -> bytes | None:
    """What is in a file that is the user's own, in a folder that is; None for any other, or where there is none.

    Asked on every reading, of the file that is open: the folder may have been changed, or a file put there, since it
    was found private. A link is not followed, and a file that has another name elsewhere is not taken.
    """
    try:
        handle = os.open(file, _READING)
        with os.fdopen(handle, "rb") as stream:
            about = os.fstat(handle)
            fits = stat.S_ISREG(about.st_mode) and about.st_nlink == 1 and _own(about) and _own(file.parent.stat())
            return stream.read() if fits else None
    except OSError:
        return None


def _own(about: os.stat_result) -> bool:
    """Whether a file or folder belongs to the user, and nobody else can write to it."""
    if os.name != "posix":
        return True
    return about.st_uid == os.getuid() and not about.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


@cache
def processor() -> str:
    """The processor with its extensions: code compiled for another one may not run, and home folders are shared."""
    features = platform.processor().encode()
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_bytes().splitlines()
        features = next((line for line in lines if line.lower().startswith((b"flags", b"features"))), features)
    return f"{platform.machine() or 'unknown'}-{hashlib.sha256(features).hexdigest()[:8]}"


def size(place: Path) -> tuple[int, int]:
    """Number of kept functions and their bytes."""
    sizes = [about.st_size for _, about in _entries(place)]
    return len(sizes), sum(sizes)


def _clear(place: Path) -> None:
    left = size(place)[1]
    for file, about in sorted(_entries(place), key=lambda entry: entry[1].st_mtime):
        if left <= LIMIT // 2:
            return
        with suppress(OSError):
            file.unlink()
        left -= about.st_size


def _entries(place: Path) -> Iterator[tuple[Path, os.stat_result]]:
    with suppress(OSError):
        for file in place.glob(f"*{SUFFIX}"):
            with suppress(OSError):  # deleted by another process in the meantime
                yield file, file.stat()
