"""Executables on the disk, so that a later process neither traces nor compiles: keys, and files that cannot be wrong.

A wrong hit would be worse than none. The key covers every source file of the package, the kernel with its static
arguments, shapes and types, the versions, the processor and the settings of JAX and XLA. A file carries the digest of
its content; one that was cut short or changed is not read but made anew. Executables are machine code, hence only from
a folder that nobody else can write to.
"""

import hashlib
import os
import pickle
import platform
import stat
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import attrs

from .lazy import changed_settings

SUFFIX = ".kernel"
_MAGIC = b"mckibben kernel 2\n"
_PACKAGE = __name__.partition(".")[0]
_PASSING = ("jax_compilation_cache", "jax_persistent_cache", "jax_enable_compilation_cache", "jax_log", "jax_dump",
            "jax_explain", "jax_pprint", "jax_traceback", "jax_compiler_detailed")  # fmt: skip
"""Settings of JAX that do not change what is compiled."""


class UnkeepableError(ValueError):
    """A static argument that no text identifies in another process, such as a user's function."""


def describe(value: Any) -> str:
    """Text that stands for a static argument in every process; UnkeepableError where there is none."""
    kind = type(value)
    if value is None or kind in (bool, int, float, str):
        return repr(value)
    if attrs.has(kind):
        parts = ", ".join(f"{field.name}={describe(getattr(value, field.name))}" for field in attrs.fields(kind))
        return f"{kind.__module__}.{kind.__qualname__}({parts})"
    module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", None)
    ours = isinstance(module, str) and module.partition(".")[0] == _PACKAGE
    if ours and name and getattr(sys.modules.get(str(module)), name, None) is value:  # its source is part of the key
        return f"{module}.{name}"
    raise UnkeepableError(f"{value!r} means nothing to another process")


@cache
def source() -> str:
    """Digest of the package's source."""
    digest = hashlib.sha256()
    root = Path(__file__).parent
    for file in sorted(root.rglob("*.py")):
        digest.update(f"{file.relative_to(root).as_posix()}\n".encode() + file.read_bytes() + b"\0")
    return digest.hexdigest()


@cache
def surroundings() -> str:
    """Versions, processor and what the environment says to JAX and XLA, as text."""
    said = sorted((k, v) for k, v in os.environ.items() if k.startswith(("JAX_", "XLA_")) and not _passing(k))
    return repr((version("jax"), version("jaxlib"), sys.version, platform.platform(), processor(), said))


def _passing(setting: str) -> bool:
    """Whether a setting of JAX does not change what is compiled."""
    return setting.lower().startswith(_PASSING)


@cache
def processor() -> str:
    """The processor with its extensions: code compiled for another one may not run, and home folders are shared."""
    features = platform.processor().encode()
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_bytes().splitlines()
        features = next((line for line in lines if line.lower().startswith((b"flags", b"features"))), features)
    return f"{platform.machine() or 'unknown'}-{hashlib.sha256(features).hexdigest()[:8]}"


def key(name: str, static: Any, shapes: Any, options: dict[str, Any]) -> str:
    """Name of the file for a kernel on given static argument, shapes and types, compiled with given options."""
    settings = sorted((k, repr(v)) for k, v in changed_settings().items() if not _passing(k))
    said = (name, describe(static), repr(shapes), sorted(options.items()), source(), surroundings(), settings)
    return hashlib.sha256(repr(said).encode()).hexdigest()[:40]


def private(folder: Path) -> bool:
    """Whether nobody but the user can put files there; the folder is made if missing."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        about = folder.stat()
    except OSError:
        return False
    if os.name != "posix":
        return True
    return about.st_uid == os.getuid() and not about.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def read(file: Path) -> Callable[..., Any] | None:
    """The executable in a file; None if there is none, or none that is whole."""
    try:
        content = file.read_bytes()
    except OSError:
        return None
    head = len(_MAGIC) + hashlib.sha256().digest_size
    body = memoryview(content)[head:]
    if content[:head] != _MAGIC + hashlib.sha256(body).digest():
        return None
    from . import native

    try:
        return native.Executable(*pickle.loads(body))
    except Exception:  # whatever another build of JAX does not like: it is compiled anew
        return None


def write(file: Path, compiled: Any) -> None:
    """Keep an executable, whole or not at all; where that cannot be done nothing happens."""
    from . import native

    temporary: str | None = None
    try:
        body = pickle.dumps(native.serialize(compiled))
        handle, temporary = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=file.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(_MAGIC + hashlib.sha256(body).digest() + body)
        os.replace(temporary, file)
        temporary = None
    except Exception:  # a full disk, an executable that cannot be serialised: the next process compiles
        pass
    finally:
        if temporary is not None:
            with suppress(OSError):
                os.unlink(temporary)
