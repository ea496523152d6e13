"""Writing a file whole or not at all: into a temporary file beside it, to the disk, then into its place.

Whenever the process is killed, the name holds the old file or the new one, never a part of either.
"""

from __future__ import annotations

import os
import tempfile
from os import PathLike
from pathlib import Path

from mckibben.spec.errors import SpecError

__all__ = ["check_target", "settle", "write"]


def check_target(path: str | PathLike[str], force: bool = False) -> Path:
    """The file that a later `write` to `path` will make (links are followed). SpecError, in one line, if it could not.

    Call it before long work, so that no result is lost for want of a place.
    """
    name = str(path)
    if not name or "\0" in name:
        raise SpecError("file", name, "is no name of a file")
    try:
        target = Path(os.path.realpath(path))
        folder, exists, is_folder = target.parent, target.exists(), target.is_dir()
        if is_folder:
            raise SpecError(name, allowed="is a folder", advice="give the name of a file")
        if exists and not force:
            raise SpecError(name, allowed="exists", advice="give --force to replace it (in Python force=True)")
        if not folder.is_dir():
            raise SpecError(name, allowed=f"there is no folder {folder}", advice="make it first")
        with tempfile.TemporaryFile(dir=folder):  # the only test of a folder that holds on every system
            pass
    except OSError as error:
        raise _unwritable(name, error) from error
    return target


def write(path: str | PathLike[str], data: bytes | memoryview, force: bool = False) -> Path:
    """Write `data` as the file at `path`; the path itself. SpecError if it exists (without `force`) or cannot be."""
    target = check_target(path, force)
    temporary: Path | None = None
    try:
        handle, made = tempfile.mkstemp(prefix=f".{target.name[:40]}.", suffix=".tmp", dir=target.parent)
        temporary = Path(made)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, _mode(target))
        if not force and target.exists():  # made by someone else in the meantime
            raise SpecError(str(path), allowed="exists", advice="give --force to replace it (in Python force=True)")
        os.replace(temporary, target)
        temporary = None
    except OSError as error:
        raise _unwritable(str(path), error) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
    settle(target.parent)
    return target


def _unwritable(name: str, error: OSError) -> SpecError:
    return SpecError(name, allowed=f"cannot be written: {error.strerror or error}")


def _mode(target: Path) -> int:
    """Permissions of the file that is replaced, else those any new file gets (temporary files are private)."""
    if target.exists():
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def settle(folder: Path) -> None:
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
