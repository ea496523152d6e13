"""A map as a look-up table: MATLAB's .mat with breakpoints as Simulink takes them, Modelica's tables, and JSON."""

from __future__ import annotations

import io
import json
import math

import numpy as np

from mckibben.potential.chart import Chart
from mckibben.potential.grid import grid

__all__ = ["as_json", "as_mat", "as_modelica"]

_TITLE = b"MATLAB 5.0 MAT-file, made by mckibben"
"""In place of what scipy writes, which has the date: equal maps are equal files."""


def as_mat(chart: Chart, lengths: int, pressures: int) -> bytes:
    """MATLAB's format 5: breakpoints `length` and `pressure`, tables over (length, pressure), notes as text."""
    from scipy.io import savemat

    content = io.BytesIO()
    found = grid(chart, lengths, pressures)
    tables = {name: np.asarray(value, float) for name, value in found.tables.items()}
    savemat(content, {"length": found.length, "pressure": found.pressure, **tables, "notes": "\n".join(chart.told),
                      "force_error": found.error}, oned_as="column")  # fmt: skip
    made = content.getvalue()
    return _TITLE.ljust(116) + made[116:]


def as_modelica(chart: Chart, lengths: int, pressures: int) -> str:
    """Tables for `Modelica.Blocks.Tables.CombiTable2Ds`, each by its name: pressures in the first row, lengths in the
    first column, SI; the notes as comments."""
    found = grid(chart, lengths, pressures)
    lines = [
        "#1",
        *(f"# {line}" for line in chart.told),
        f"# force, straight between points: within {found.error:.3g} N",
    ]
    for name, values in found.tables.items():
        lines.append(
            f"double {name}({lengths + 1},{pressures + 1})  # {found.units[name]}, over length [m], pressure [Pa]"
        )
        rows = np.column_stack([[0.0, *found.length], np.vstack([found.pressure, np.asarray(values, float)])])
        lines += [" ".join(map(repr, row)) for row in rows.tolist()]
    return "\n".join(lines) + "\n"


def as_json(chart: Chart, lengths: int, pressures: int) -> str:
    """One object: breakpoints, tables over [length][pressure], errors, notes; SI."""
    found = grid(chart, lengths, pressures)
    tables = {name: np.asarray(value, float).tolist() for name, value in found.tables.items()}
    about = chart.data.attrs
    held = {
        "length": found.length.tolist(), "pressure": found.pressure.tolist(), **tables,
        "errors": {"force": chart.force_error, "volume": chart.volume_error, "largest_radius": chart.radius_error,
                   **({} if math.isnan(chart.stiffness_error) else {"stiffness": chart.stiffness_error}),
                   "force_between_breakpoints": found.error},
        "units": found.units, "notes": list(chart.told), "mckibben_version": str(about["mckibben_version"]),
    }  # fmt: skip
    return json.dumps(held, indent=1) + "\n"
