"""`sample_data()`: published measurements by name, from a folder with the files as their authors publish them.

None of these files is part of the package, and none is downloaded: what is here are the facts that the files leave out.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import attrs

from mckibben.data.read import read
from mckibben.data.values import Data
from mckibben.spec.errors import SpecError, nearest

__all__ = ["sample_data"]


@attrs.frozen
class Sample:
    """A published set: where it is from, its licence, and what its files do not say."""

    about: str
    address: str
    licence: str
    files: dict[str, tuple[str, str]]  #: by name of the file: pressure held, length without force at it
    rest_length: str
    notes: tuple[str, ...]


SAMPLES = {
    "quadsegrity": Sample(
        about="a home-made muscle, 850 mm long, pulled at 0.5 mm/s at 3, 4, 5 and 6 bar",
        address="https://github.com/martantoine/QuadSegrity, folder Experiences/session1/McKibbenBig",
        licence="MIT, (c) 2024 Antoine Vincent Martin",
        files={
            "3 bars.csv": ("3 bar", "660 mm"), "4 bars.csv": ("4 bar", "635 mm"), "5 bars.csv": ("5 bar", "630 mm"),
            "6 bars.csv": ("6 bar", "624 mm"),
        },
        rest_length="850 mm",
        notes=("pressures are the nominal ones, taken as gauge", "the free length at 6 bar is that at 5.8 bar"),
    ),
}  # fmt: skip


def sample_data(name: str, folder: str | PathLike[str] | None = None) -> Data:
    """Published measurements by name, read from a folder that holds the files of their authors.

    The files are not part of this package, and it downloads none: get them from where they are published (the error
    without a folder says where, and under which licence). What the files leave out, such as the pressure that was held,
    is added, and said in `data.assumptions` with source and licence.

    Args:
        name: "quadsegrity": a home-made muscle pulled at 3, 4, 5 and 6 bar (loading only).
        folder: where the files are. Those that are not there are left out; at least one must be.

    Returns:
        A `Data`.

    Raises:
        SpecError: for an unknown name, no folder, or a folder without the files.

    >>> try:
    ...     mk.sample_data("quadsegrity")
    ... except mk.SpecError as error:
    ...     print(error.advice)
    get them from https://github.com/martantoine/QuadSegrity, folder Experiences/session1/McKibbenBig (MIT, ...
    """
    if name not in SAMPLES:
        raise SpecError("sample_data", name, "is no known set", nearest(str(name), SAMPLES))
    sample = SAMPLES[name]
    where = f"get them from {sample.address} ({sample.licence}), then give their folder="
    if folder is None:
        raise SpecError("sample_data", name, f"its files ({sample.about}) are not part of this package", where)
    there = [file for file in sample.files if (Path(folder) / file).is_file()]
    if not there:
        raise SpecError("folder", str(folder), "holds none of " + ", ".join(sample.files), where)
    held = {"pressure": {Path(file).stem: sample.files[file][0] for file in there}}
    held |= {"free_length": {Path(file).stem: sample.files[file][1] for file in there}}
    data = read([Path(folder) / file for file in there], {}, held=held | {"rest_length": sample.rest_length})
    told = (f"from {sample.address}; {sample.licence}", *sample.notes)
    return attrs.evolve(data, assumptions=(*told, *data.assumptions))
