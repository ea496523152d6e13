"""A motion ↔ NetCDF-4, equal number by number; and its states over time as a CSV table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mckibben.files.stored import checked
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.results.motion import OF_MUSCLES, OF_RIG, Motion
from mckibben.results.rows import headed

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save", "save_csv"]

_ABOUT = {"rig": str, "title": str, "notes": str, "reason": str, "events": str, "method": str, "assumed": str,
          "mckibben_version": str, "load": str, "tolerance": float,
          "supplied": float, "atmosphere": float, "temperature": float, "steps": int}  # fmt: skip
"""Attributes that a file must have."""


def save(motion: Motion, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a motion as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    return written(motion.data, "motion", path, force)


def of(stored: xr.Dataset, name: str) -> Motion:
    """The motion that a file of this name holds; SpecError where it holds something else."""
    dims = ("time", "muscle") if "muscle" in stored.sizes else ("time",)
    needed = {name: (dims, "f") for name in OF_MUSCLES} | {name: (("time",), "f") for name in ("time", *OF_RIG)}
    needed |= {"inside": (dims, "b"), "slack": (dims, "b"), "moves": (("time",), "U")}
    return Motion(checked(stored, name, "motion", needed, _ABOUT, ("time", "muscle")))


def save_csv(motion: Motion, path: str | PathLike[str], force: bool = False) -> Path:
    """Write what was seen at each time in SI units, of two muscles side by side."""
    data, text = motion.data, io.StringIO(newline="")
    heads, columns = [], []
    for name in ("time", *(str(one) for one in data.data_vars)):
        values, unit = np.asarray(data[name].values), str(data[name].attrs.get("units", ""))
        several = values.ndim == 2
        for k in range(values.shape[1] if several else 1):
            heads.append(headed(f"{name}_{data['muscle'].values[k]}" if several else name, unit))
            columns.append((values[:, k] if several else values).tolist())
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([_cell(value) for value in row] for row in zip(*columns, strict=True))
    return write(path, _notes(motion), text.getvalue(), force)


def _cell(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _notes(motion: Motion) -> Iterator[str]:
    about = motion.data.attrs
    yield f"the motion of {about['title']}, made by mckibben {about['mckibben_version']}"
    yield f"method {about['method']}, tolerance {about['tolerance']:g}, {about['steps']} steps"
    yield f"assumed, not measured: {about['assumed'] or 'nothing'}"
    if motion.reason:
        yield f"not complete: {motion.reason}"
    yield from (f"note: {line}" for line in motion.notes)
    for name, variable in motion.data.data_vars.items():
        yield f"{name}: {variable.attrs.get('long_name', '')}"
    yield "units are SI, in brackets (air consumed in normal litres); force > 0 pulls the fittings together"
    yield ""
    yield "the rig (TOML):"
    yield from str(about["rig"]).splitlines()
