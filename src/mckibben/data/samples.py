"""`sample_data()`: published measurements by name, from where their authors publish them or from a folder.

None of these files is part of the package: what is here are their addresses, and the facts that they leave out.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from urllib.parse import quote

import attrs

from mckibben.data.fetch import check_unchanged, fetch, place_of
from mckibben.data.read import read
from mckibben.data.values import Data
from mckibben.spec.errors import SpecError, nearest

__all__ = ["sample_data"]


@attrs.frozen
class Sample:
    """A published set: where it is from, its licence, and what its files do not say."""

    about: str
    source: str
    licence: str
    root: str  #: beginning of the addresses
    files: dict[str, tuple[str, str, str]]  #: by name: rest of the address, pressure held, length without force at it
    rest_length: str
    notes: tuple[str, ...]


_BIG = "47fca86f27fdb5d22e50ad8d4254384e2bcb7e2e/Experiences/session1/McKibbenBig"
_BIG_BEFORE = "3b79575596efb18046a6291d0cfdf37decb3bf04/experiences/session1/McKibbenBig"
"""Commits and folders: the first curve is known from an earlier commit than the others."""

SAMPLES = {
    "quadsegrity": Sample(
        about="a home-made muscle, 850 mm long, pulled at 0.5 mm/s at 3, 4, 5 and 6 bar",
        source="https://github.com/martantoine/QuadSegrity, folder Experiences/session1/McKibbenBig",
        licence="MIT, (c) 2024 Antoine Vincent Martin",
        root="https://raw.githubusercontent.com/martantoine/QuadSegrity",
        files={
            "3 bars.csv": (_BIG_BEFORE, "3 bar", "660 mm"), "4 bars.csv": (_BIG, "4 bar", "635 mm"),
            "5 bars.csv": (_BIG, "5 bar", "630 mm"), "6 bars.csv": (_BIG, "6 bar", "624 mm"),
        },
        rest_length="850 mm",
        notes=("pressures are the nominal ones, taken as gauge", "the free length at 6 bar is that at 5.8 bar"),
    ),
}  # fmt: skip


def sample_data(name: str, folder: str | PathLike[str] | None = None, *, download: bool = False) -> Data:
    """Published measurements by name, from a folder with the files of their authors, or fetched from them.

    The files are not part of this package. What they leave out, such as the pressure that was held, is added, and said
    in `data.assumptions` with source and licence.

    Args:
        name: "quadsegrity": a home-made muscle pulled at 3, 4, 5 and 6 bar (loading only).
        folder: where the files are. Those that are not there are left out; at least one must be. By default a folder
            of yours for what was downloaded.
        download: fetch what is not in the folder yet, from a fixed commit (takes pooch, of the extra `[lab]`; 9 MB). A
            file's SHA-256 is kept beside it, and a file that is another one afterwards is refused.

    Returns:
        A `Data`.

    Raises:
        SpecError: for an unknown name, a folder without the files, no connection, or a file that has changed.

    >>> try:
    ...     mk.sample_data("quadsegrity", folder="nowhere")
    ... except mk.SpecError as error:
    ...     print(error.advice)
    fetch them with download=True, or get them from https://github.com/martantoine/QuadSegrity, folder ...
    """
    if name not in SAMPLES:
        raise SpecError("sample_data", name, "is no known set", nearest(str(name), SAMPLES))
    sample = SAMPLES[name]
    place = place_of(name) if folder is None else Path(folder)
    if download:
        files = {file: f"{sample.root}/{rest}/{quote(file)}" for file, (rest, *_) in sample.files.items()}
        fetch(place, files)
    check_unchanged(place)
    there = [file for file in sample.files if (place / file).is_file()]
    if not there:
        advice = f"fetch them with download=True, or get them from {sample.source} ({sample.licence})"
        raise SpecError("sample_data", name, f"its files ({sample.about}) are not in {place}", advice)
    held = {"pressure": {Path(file).stem: sample.files[file][1] for file in there}}
    held |= {"free_length": {Path(file).stem: sample.files[file][2] for file in there}}
    data = read([place / file for file in there], {}, held=held | {"rest_length": sample.rest_length})
    told = (f"from {sample.source}; {sample.licence}", *sample.notes)
    return attrs.evolve(data, assumptions=(*told, *data.assumptions))
