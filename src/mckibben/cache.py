"""The folder of compiled functions, kept between processes: kernels as executables, the rest in JAX's own cache.

Kernels are always kept, unless MCKIBBEN_CACHE is "off". JAX's cache is used by the command line and the workers of a
sweep only, because it would take in what else a program compiles.

JAX writes its entries straight into the folder: one that was cut short (the process was killed, the disk full) cannot
be unpacked later. JAX then warns and compiles anew, but never replaces it. `kept` hears that and clears the folder.
"""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path

from . import kept as kept_files
from .lazy import configure

__all__ = ["folder", "kept", "kernels", "off", "size", "use"]

KERNELS = "kernels"
"""Folder beside JAX's own entries."""
LIMIT = 256 * 2**20
"""Bytes above which the folder is cleared."""
_TROUBLE = r"Error (reading|writing) persistent compilation cache entry"


def folder() -> Path:
    """Where compiled functions are kept: JAX_COMPILATION_CACHE_DIR, else one folder per JAX version and processor."""
    given = os.environ.get("JAX_COMPILATION_CACHE_DIR")
    if given:
        return Path(given)
    from platformdirs import user_cache_dir

    return Path(user_cache_dir("mckibben", appauthor=False)) / f"jax-{version('jax')}-{kept_files.processor()}"


def off() -> bool:
    """Whether the user wants nothing to be kept."""
    return os.environ.get("MCKIBBEN_CACHE") == "off"


def ready() -> Path | None:
    """The folder, made where it is missing and cleared where it is too full; None where it cannot be written."""
    if off():
        return None
    place = folder()
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        try:
            place.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError:
            return None
        if not os.access(place, os.W_OK | os.X_OK):
            return None
        if size(place)[1] > LIMIT:
            _clear(place)
    return place


def kernels() -> Path | None:
    """Folder of the kernels; None where they cannot be kept."""
    place = ready()
    return None if place is None else place / KERNELS


def use() -> Path | None:
    """Have JAX keep what it compiles; the folder, or None where it cannot be written (nothing else changes then).

    Settings that are in the environment stay as they are.
    """
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")  # the compiler's own remarks; errors still raise
    place = ready()
    if place is None:
        return None
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        configure("jax_compilation_cache_dir", str(place))
    for name, value in (("min_compile_time_secs", 0), ("min_entry_size_bytes", -1)):
        if f"JAX_PERSISTENT_CACHE_{name.upper()}" not in os.environ:
            configure(f"jax_persistent_cache_{name}", value)
    return place


@contextmanager
def kept() -> Iterator[None]:
    """Inside this JAX keeps what it compiles, and trouble with keeping it is nobody's concern."""
    place = use()
    with warnings.catch_warnings(record=True) as caught:
        warnings.filterwarnings("always", message=_TROUBLE)
        yield
    trouble = [warning for warning in caught if re.match(_TROUBLE, str(warning.message))]
    damaged = any(str(warning.message).startswith("Error reading") for warning in trouble)
    if damaged and place is not None and "JAX_COMPILATION_CACHE_DIR" not in os.environ:
        _clear(place)
    for warning in caught:
        if warning not in trouble:
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)


def size(place: Path) -> tuple[int, int]:
    """Number of kept functions and their bytes."""
    count = total = 0
    with suppress(OSError):
        for entry in _entries(place):
            with suppress(OSError):  # cleared by another process in the meantime
                count, total = count + 1, total + entry.stat().st_size
    return count, total


def _clear(place: Path) -> None:
    with suppress(OSError):
        for entry in _entries(place):
            with suppress(OSError):
                entry.unlink()


def _entries(place: Path) -> Iterator[Path]:
    yield from place.glob("*-cache")
    yield from (place / KERNELS).glob(f"*{kept_files.SUFFIX}")
