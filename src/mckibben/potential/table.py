"""The numbers of a map ↔ the Dataset in which it is kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

from mckibben.potential.evaluate import ORDERS, Table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["NUMBERS", "derived", "table_of", "variables_of"]

NUMBERS = ("length_middle", "length_half", "first", "last", "soft", "q_middle", "q_half", "width", "least_radius")
"""Single numbers of a map."""


def derived(c: np.ndarray, half_length: float, half_q: float) -> np.ndarray:
    """The series (n, m) of a potential and its derivatives (8, n, m), by length and by q."""
    found = np.zeros((len(ORDERS), *c.shape))
    for k, (by_length, by_q) in enumerate(ORDERS):
        one = chebyshev.chebder(c, by_length, scl=1.0 / half_length, axis=0) if by_length else c
        one = chebyshev.chebder(one, by_q, scl=1.0 / half_q, axis=1) if by_q else one
        found[k, : one.shape[0], : one.shape[1]] = one
    return found


def variables_of(table: Table) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]:
    """The variables that hold a map."""
    values = (*table.length, table.first, table.last, table.soft, *table.q, table.width, table.least)
    return {
        "potential": (("i", "j"), table.series[0], {"units": "J", "long_name": "series of the potential"}),
        "radius": (("i_radius", "j_radius"), table.radius, {"units": "m", "long_name": "series of the largest radius"}),
        "low": (("low_knot", "what"), table.low, {"units": "m", "long_name": "shortest length and its slope by y"}),
        "high": (("high_knot", "what"), table.high, {"units": "m", "long_name": "longest length and its slope by y"}),
        "springs": (("side", "what"), table.springs, {"long_name": "force [N] and stiffness [N/m] beyond each edge"}),
        "numbers": (("number",), np.array([float(one) for one in values]), {"long_name": "scales, SI"}),
        "number": (("number",), np.array(NUMBERS), {}),
    }


def table_of(data: xr.Dataset) -> Table:
    """The map that a Dataset holds."""
    a, b, first, last, soft, q, q_half, width, least = data["numbers"].values.tolist()
    series = derived(np.asarray(data["potential"].values, float), b, q_half)
    low, high, springs, radius = (np.asarray(data[name].values, float) for name in ("low", "high", "springs", "radius"))
    return Table(
        series, np.array([a, b]), first, last, soft, np.array([q, q_half]), low, high, width, springs, radius, least
    )
