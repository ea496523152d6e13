"""A map on a grid of lengths and pressures, for look-up tables."""

from __future__ import annotations

import csv
import io

import attrs
import numpy as np

from mckibben.potential.chart import Chart
from mckibben.potential.evaluate import Values

__all__ = ["COLUMNS", "Grid", "grid", "table"]

COLUMNS = {
    "length": "m", "pressure": "Pa", "force": "N", "volume": "m^3", "stiffness": "N/m", "volume_by_length": "m^2",
    "volume_by_pressure": "m^3/Pa", "largest_radius": "m", "inside": "1",
}  # fmt: skip
"""What is told at every point, with units."""
LENGTHS, PRESSURES = 56, 31
"""Lengths and pressures of a grid where nothing else is asked for."""


@attrs.frozen(eq=False)
class Grid:
    """Breakpoints [m], [Pa] and the values over them (lengths, pressures); outside of the range they go on smoothly."""

    length: np.ndarray
    pressure: np.ndarray
    values: Values
    largest_radius: np.ndarray
    friction: np.ndarray | None  #: half of what lies between the sliding branches [N]; None for a muscle without
    error: float  #: largest error of the force [N] of linear interpolation between the breakpoints, in the range

    @property
    def tables(self) -> dict[str, np.ndarray]:
        """All but the breakpoints, by their names in `COLUMNS`."""
        own = self.values._asdict() | {"largest_radius": self.largest_radius}
        rubs = {} if self.friction is None else {"friction": self.friction}
        return {name: np.asarray(own[name]) for name in list(COLUMNS)[2:]} | rubs

    @property
    def units(self) -> dict[str, str]:
        """Of all that it holds."""
        return COLUMNS | ({} if self.friction is None else {"friction": "N"})


def grid(chart: Chart, lengths: int = LENGTHS, pressures: int = PRESSURES) -> Grid:
    """The map on so many lengths and pressures, even in both, as look-up tables want them."""
    table = chart.table
    h = np.linspace(float(table.low[:, 0].min()), float(table.high[:, 0].max()), lengths)
    P = np.linspace(*chart.pressures, pressures)
    values = chart.values(h[:, None], P)
    finer = [np.sort(np.concatenate([one, 0.5 * (one[1:] + one[:-1])])) for one in (h, P)]
    between = chart.values(finer[0][:, None], finer[1])
    off = np.abs(_between(_between(values.force).T).T - between.force)
    error = float(np.where(between.inside, off, 0.0).max()) + chart.force_error
    friction = None if chart.rubs is None else chart.friction(h[:, None], P)
    return Grid(h, P, values, chart.largest_radius(h[:, None], P), friction, error)


def _between(values: np.ndarray) -> np.ndarray:
    """Rows, and halfway rows between them."""
    found = np.empty((2 * len(values) - 1, *values.shape[1:]))
    found[::2], found[1::2] = values, 0.5 * (values[1:] + values[:-1])
    return found


def table(chart: Chart, lengths: int = LENGTHS, pressures: int = PRESSURES) -> str:
    """The grid as CSV, a line for each point."""
    found, text = grid(chart, lengths, pressures), io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    tables, units = found.tables, found.units
    inside = tables.pop("inside").ravel().astype(int).tolist()
    names = ["length", "pressure", *tables, "inside"]
    writer.writerow([f"{name} [{units[name]}]" if units[name] != "1" else name for name in names])
    columns = [*np.meshgrid(found.length, found.pressure, indexing="ij"), *tables.values()]
    for numbers, within in zip(np.stack([one.ravel() for one in columns], axis=1).tolist(), inside, strict=True):
        writer.writerow([*numbers, within])  # str of a float has all its digits
    return text.getvalue()
