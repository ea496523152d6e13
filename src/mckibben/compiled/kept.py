"""Executables on the disk, so that a later process neither traces nor compiles: keys, and files that cannot be wrong.

A wrong hit would be worse than none. The key covers every source file of the package, the kernel with its static
arguments, shapes and types, the versions, the processor and the settings of JAX and XLA. A file says in its first lines
which kernel it holds, with the key, and the digest of that and of its content. One that was cut short, changed, renamed
or exchanged with another is not read but made anew, and so is one that is not the user's own.
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

from mckibben.compiled.folder import content as content_of
from mckibben.compiled.folder import processor
from mckibben.compiled.options import Options

__all__ = ["key", "read", "write"]

_MAGIC = b"mckibben kernel 4\n"
_DIGEST = hashlib.sha256().digest_size
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
    content, said = content_of(file), _said(file)
    if content is None or not content.startswith(said):
        return None
    digest, body = content[len(said) : len(said) + _DIGEST], memoryview(content)[len(said) + _DIGEST :]
    if digest != _digest(said, body):
        return None
    with suppress(OSError):  # a folder that is too full loses first what was not used for longest
        os.utime(file)
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
            said = _said(file)
            stream.write(said + _digest(said, body) + body)
        os.replace(temporary, file)
        temporary = None
    except Exception:  # a full disk, a result that cannot be pickled: the next process compiles
        pass
    finally:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)


def _said(file: Path) -> bytes:
    """The first lines of a file of this name, which holds the name of a kernel and a key."""
    return _MAGIC + file.name.encode() + b"\n"


def _digest(said: bytes, body: bytes | memoryview) -> bytes:
    digest = hashlib.sha256(said)
    digest.update(body)
    return digest.digest()
