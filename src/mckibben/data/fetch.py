"""Files fetched from where their authors publish them, and checksums that they are held against from then on."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mckibben import disk
from mckibben.spec.errors import SpecError

__all__ = ["check_unchanged", "fetch", "place_of"]

CHECKSUMS = "checksums.txt"
"""What lies beside the files: the SHA-256 of each as first fetched, in the form that `sha256sum --check` reads.

None comes with this package, since the files are not part of it.
"""
_INSTEAD = "or give the folder= that holds the files"


def place_of(name: str) -> Path:
    """The folder of this user for the files of a set."""
    from platformdirs import user_data_dir

    return Path(user_data_dir("mckibben", appauthor=False)) / "samples" / name


def fetch(folder: Path, addresses: Mapping[str, str]) -> None:
    """Put into a folder those files, by name, that are not there yet, each from its address.

    Raises:
        SpecError: where pooch is missing, or an address cannot be reached or holds another file than it did.
    """
    pooch, known = _pooch(), _known(folder)
    for name in (name for name in addresses if not (folder / name).is_file()):
        try:
            pooch.retrieve(addresses[name], known.get(name), fname=name, path=folder)
        except OSError as error:  # of the connection, and of the disk
            said = f"cannot be fetched from {addresses[name]}: {type(error).__name__}"
            raise SpecError(name, allowed=said, advice=f"go online, {_INSTEAD}") from error
        except ValueError as error:
            said = f"at {addresses[name]} is no longer what it was: its SHA-256 was {known[name]}"
            raise SpecError(
                name, allowed=said, advice=f"take it out of {folder / CHECKSUMS} if that is right"
            ) from error
        known[name] = _sha256(folder / name)
        lines = (f"{known[name]}  {name}\n" for name in sorted(known))
        disk.write(folder / CHECKSUMS, "".join(lines).encode(), force=True)


def check_unchanged(folder: Path) -> None:
    """SpecError where a file of a folder is no longer what was fetched."""
    for name, known in _known(folder).items():
        if (folder / name).is_file() and _sha256(folder / name) != known:
            said = f"in {folder} is not the file that was fetched: its SHA-256 is not {known}"
            raise SpecError(name, allowed=said, advice="delete it, and fetch it again with download=True")


def _known(folder: Path) -> dict[str, str]:
    file = folder / CHECKSUMS
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    return {name: known for known, _, name in (line.partition("  ") for line in lines)}


def _sha256(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _pooch() -> Any:
    try:
        import pooch
    except ImportError as error:
        raise SpecError("download", True, "takes pooch", f'pip install "mckibben[lab]", {_INSTEAD}') from error
    pooch.get_logger().setLevel(logging.WARNING)
    return pooch
