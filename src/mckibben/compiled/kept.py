"""Executables on the disk, so that a later process neither traces nor compiles: keys, and files that cannot be wrong.

A wrong hit would be worse than none. The key covers every source file of the package, the kernel with its static
arguments, shapes and types, the versions, the processor and the settings of JAX and XLA. A file carries its key and the
digest of its content; one that was cut short, changed or renamed is not read but made anew.
"""

import hashlib
import os
import pickle
import platform
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jax

from mckibben.compiled.folder import processor
from mckibben.compiled.options import Options

__all__ = ["key", "read", "write"]

_MAGIC = b"mckibben kernel 3\n"
_HEAD = len(_MAGIC) + hashlib.sha256().digest_size
_PASSING = ("jax_compilation_cache", "jax_persistent_cache", "jax_enable_compilation_cache", "jax_log", "jax_dump",
            "jax_explain", "jax_pprint", "jax_traceback", "jax_compiler_detailed")  # fmt: skip
"""Settings of JAX that do not change what is compiled."""


@cache
def source() -> str:
    """Digest of the package's source."""
    digest = hashlib.sha256()
    root = Path(__file__).parent.parent
    for file in sorted(root.rglob("*.py")):
        digest.update(f"{file.relative_to(root).as_posix()}\n".encode() + file.read_bytes() + b"\0")
    return digest.hexdigest()


@cache
def surroundings() -> str:
    """Versions, processor and what the environment says to JAX and XLA, as text."""
    said = sorted((k, v) for k, v in os.environ.items() if k.startswith(("JAX_", "XLA_")) and not _passing(k))
    return repr((version("jax"), version("jaxlib"), sys.version, platform.platform(), processor(), said))


def _passing(setting: str) -> bool:
    return setting.lower().startswith(_PASSING)


def key(name: str, static: str, forms: Sequence[Any], options: Options) -> str:
    """What to call a kernel on described static arguments, shapes and types, compiled with given options."""
    settings = sorted((k, repr(v)) for k, v in jax.config.values.items() if not _passing(k))
    kinds = [(tuple(shape), str(dtype)) for shape, dtype in forms]
    said = (name, static, kinds, sorted(options.items()), source(), surroundings(), settings)
    return hashlib.sha256(repr(said).encode()).hexdigest()[:40]


def read(file: Path) -> Any:
    """What was written to a file of this name; None if there is none, or none that is whole."""
    try:
        content = file.read_bytes()
    except OSError:
        return None
    body = memoryview(content)[_HEAD:]
    if content[:_HEAD] != _MAGIC + _digest(file, body):
        return None
    try:
        return pickle.loads(body)
    except Exception:  # such as a class that is no longer there
        return None


def write(file: Path, content: Any) -> None:
    """Keep what can be pickled, whole or not at all; where that cannot be done nothing happens."""
    temporary: str | None = None
    try:
        body = pickle.dumps(content)
        handle, temporary = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=file.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(_MAGIC + _digest(file, body) + body)
        os.replace(temporary, file)
        temporary = None
    except Exception:  # a full disk, a result that cannot be pickled: the next process compiles
        pass
    finally:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)


def _digest(file: Path, body: bytes | memoryview) -> bytes:
    digest = hashlib.sha256(file.name.encode() + b"\0")
    digest.update(body)
    return digest.digest()
