"""Writing a file, or a folder, whole or not at all: made beside its place, then moved into it.

Whenever the process is killed, the name holds the old file or the new one, never a part of either; what it left beside
it is deleted by the next that writes there. `write` is for what
users name: it checks, and speaks of trouble in a SpecError. `replace` and `new_folder` are for files of the package's
own, such as the chunks of a store: they raise OSError.
"""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import re
import secrets
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path

from mckibben.spec.errors import SpecError

__all__ = ["check_target", "new_folder", "replace", "write"]


def check_target(path: str | PathLike[str], force: bool = False) -> Path:
    """The file that a later `write` to `path` will make or replace. SpecError, in one line, if it could not.

    A link is followed to a regular file. Whatever else is there (a device, a pipe, a link to one or to nothing) is
    refused, also with `force`. Call this before long work, so that no result is lost for want of a place.
    """
    name = str(path)
    if not name or "\0" in name:
        raise SpecError("file", name, "is no name of a file")
    try:
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise SpecError(name, allowed="is a folder", advice="give the name of a file")
        if os.path.lexists(path):
            if not target.is_file():
                raise SpecError(name, allowed="is no regular file", advice="give another name")
            if not force:
                raise _exists(name)
        if not target.parent.is_dir():
            raise SpecError(name, allowed=f"there is no folder {target.parent}", advice="make it first")
        with tempfile.TemporaryFile(dir=target.parent):  # the only test of a folder that holds on every system
            pass
    except OSError as error:
        raise _unwritable(name, error) from error
    return target


def write(path: str | PathLike[str], data: bytes | memoryview, force: bool = False) -> Path:
    """Write `data` as the file at `path`; the file itself. SpecError if it exists (without `force`) or cannot be."""
    target = check_target(path, force)
    try:
        replace(target, data, new=not force)
    except FileExistsError as error:  # made by someone else in the meantime
        raise _exists(str(path)) from error
    except OSError as error:
        raise _unwritable(str(path), error) from error
    return target


def replace(path: Path, data: bytes | memoryview, *, new: bool = False, sync: bool = True, alone: bool = False) -> None:
    """Put `data` at `path`, over a file that is there, whose permissions stay. OSError where it cannot be.

    Args:
        new: FileExistsError where there is a file.
        sync: have it on the disk before it is moved; without, a crash of the machine may leave an empty file.
        alone: nobody else writes there. Then the file beside it always has the same name, and one that a killed process
            left is taken by the next.
    """
    mark = "" if alone else f".{_here()}.{secrets.token_hex(4)}"
    temporary = path.with_name(f".{path.name[:40]}{mark}.tmp")
    if not alone:
        _clear_left(path)
    flags = os.O_WRONLY | os.O_CREAT | getattr(os, "O_BINARY", 0) | (os.O_TRUNC if alone else os.O_EXCL)
    try:
        with os.fdopen(os.open(temporary, flags, 0o666), "wb") as stream:
            stream.write(data)
            stream.flush()
            if sync:
                os.fsync(stream.fileno())
        if os.path.lexists(path):
            there = path.lstat().st_mode
            if new:
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
            if not stat.S_ISREG(there):
                raise OSError(errno.EINVAL, "is no regular file", str(path))
            os.chmod(temporary, stat.S_IMODE(there) & 0o777)
        os.replace(temporary, path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise
    if sync:
        _settle(path.parent)


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """A folder to be filled inside, then moved to `path` whole; one that is there is deleted then. OSError."""
    mark = f"{_here()}.{secrets.token_hex(4)}"
    made, old = (path.with_name(f".{path.name[:40]}.{mark}.{ending}") for ending in ("tmp", "old"))
    _clear_left(path)
    try:
        yield made
        if path.exists():
            os.replace(path, old)
        try:
            os.replace(made, path)
        except OSError:
            if old.exists():
                os.replace(old, path)
            raise
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _here() -> str:
    """This process, as part of a name: the machine, because folders are shared between machines, and its number."""
    machine = hashlib.sha256(platform.node().encode()).hexdigest()[:6]
    return f"{machine}.{os.getpid()}"


_LEFT = re.compile(r"\.(?:([0-9a-f]{6})\.)?([0-9]+)(?:\.[0-9a-f]{8})?\.(?:tmp|old)")


def _clear_left(path: Path) -> None:
    """Delete what processes of this machine that are no longer there have left beside `path`."""
    start = f".{path.name[:40]}"
    with suppress(OSError):
        for left in [entry for entry in os.listdir(path.parent) if entry.startswith(start)]:
            found = _LEFT.fullmatch(left, len(start))
            machine = _here().partition(".")[0]
            if found and found[1] in (None, machine) and not _runs(int(found[2])):
                beside = path.with_name(left)
                if beside.is_dir() and not beside.is_symlink():
                    shutil.rmtree(beside, ignore_errors=True)
                else:
                    beside.unlink(missing_ok=True)


def _runs(process: int) -> bool:
    """Whether there is a process of this number; where that cannot be told, as if there were."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # of another user
        return True
    return True


def _exists(name: str) -> SpecError:
    return SpecError(name, allowed="exists", advice="give --force to replace it (in Python force=True)")


def _unwritable(name: str, error: OSError) -> SpecError:
    return SpecError(name, allowed=f"cannot be written: {error.strerror or error}")


def _settle(folder: Path) -> None:
    """Have the folder's entry on the disk too, where the system can; the file itself is already whole."""
    if os.name != "posix":
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:  # a folder one may write to but not read
        return
    try:
        os.fsync(handle)
    except OSError:  # file systems that cannot
        pass
    finally:
        os.close(handle)
