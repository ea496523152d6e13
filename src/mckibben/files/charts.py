"""A map ↔ NetCDF-4, equal number by number; and force, volume and slopes on a grid as a CSV table."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from mckibben.files.stored import checked, muscle_in
from mckibben.files.stored import write as written
from mckibben.files.table import write
from mckibben.potential.chart import Chart
from mckibben.potential.grid import table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["of", "save", "save_csv"]

_NEEDED: dict[str, tuple[tuple[str, ...], str]] = {
    "potential": (("i", "j"), "f"), "radius": (("i_radius", "j_radius"), "f"), "low": (("low_knot", "what"), "f"),
    "high": (("high_knot", "what"), "f"), "springs": (("side", "what"), "f"), "numbers": (("number",), "f"),
    "number": (("number",), "U"),
    **{f"check_{name}": (("check",), "f") for name in ("length", "pressure", "force", "volume", "radius")},
}  # fmt: skip
"""What a file must have: dimensions, and NumPy's letter of the kind of data."""
_ABOUT = {
    "muscle": str, "notes": str, "mckibben_version": str, "converged": int, "tolerance": float, "rubber_inside": float,
    "asked_shortest": float, "asked_longest": float,
    **{f"{name}_error": float for name in ("force", "volume", "radius")},
    **{f"largest_{name}": float for name in ("force", "volume", "radius")},
}  # fmt: skip
"""Attributes that a file must have."""
_STIFF: dict[str, tuple[tuple[str, ...], str]] = {"check_stiffness": (("check",), "f")}
_ABOUT_STIFF = {"stiffness_error": float, "largest_stiffness": float}
"""What maps have since the error of their stiffness is measured."""
_RUBS: dict[str, tuple[tuple[str, ...], str]] = {
    "friction": (("i_friction", "j_friction"), "f"), "sticking": (("i_friction", "j_friction"), "f"),
    **{f"check_branch_{name}": (("check_branch",), "f")
       for name in ("length", "pressure", "shortening", "lengthening")},
}  # fmt: skip
_ABOUT_RUBS = {"friction_error": float, "sticking_error": float, "largest_friction": float}
"""What that of a muscle with friction must have too."""


def save(chart: Chart, path: str | PathLike[str], force: bool = False) -> Path:
    """Write a map as a NetCDF-4 file; SpecError if the file exists (without `force`) or cannot be written."""
    return written(chart.data, "chart", path, force)


def of(stored: xr.Dataset, name: str) -> Chart:
    """The map that a file of this name holds; SpecError where it holds something else."""
    needed, about = _NEEDED, _ABOUT
    if "stiffness_error" in stored.attrs:
        needed, about = needed | _STIFF, about | _ABOUT_STIFF
    data = checked(stored, name, "chart", needed, about, ("number",))
    muscle = muscle_in(name, data.attrs["muscle"])
    if muscle.friction is not None:
        data = checked(stored, name, "chart", needed | _RUBS, about | _ABOUT_RUBS, ("number",))
    return Chart(muscle, data)


def save_csv(chart: Chart, path: str | PathLike[str], force: bool = False) -> Path:
    """Write force, volume and slopes on a grid of lengths and pressures, in SI units."""
    return write(path, iter(chart.told), table(chart), force)
