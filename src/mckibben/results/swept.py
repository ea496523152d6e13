"""`Swept`: what a sweep gave in short, beside its Dataset: `data.mckibben`. Nothing is solved here."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from mckibben.shown import Shown, shown_as
from mckibben.spec import SpecError
from mckibben.units import DISPLAY, from_si

__all__ = ["Swept", "is_sweep", "said"]

RESULTS = {
    "length": "mm", "contraction": "%", "force": "N", "pressure": "bar", "volume": "mL", "largest_radius": "mm",
    "peak_fibre_tension": "N",
}  # fmt: skip
"""Variables of the table, and the units in which people see them."""
MOST = 5_000_000
"""States up to which all are looked at to show a sweep; a store of more is left on the disk."""
FEW = 4
"""Values of a field that are named one by one."""


def is_sweep(data: Any) -> bool:
    """Whether a value is the Dataset of a sweep, or part of one that still says how its states came out."""
    return isinstance(data, xr.Dataset) and "sweep" in data.attrs and {"verdict", "status"} <= set(data.data_vars)


class Swept(Shown):
    """A sweep in short: `data.mckibben` of the Dataset that `sweep` gave, which stays a Dataset like any other.

    Args:
        data: the Dataset, or part of it (`data.isel(...)`).
    """

    def __init__(self, data: xr.Dataset) -> None:
        self._data = data  # whatever looks through the attributes of some Dataset gets here

    @property
    def data(self) -> xr.Dataset:
        """The Dataset itself. SpecError for one that is none of a sweep."""
        if not is_sweep(self._data):
            said = "is for what sweep gave, with its verdict and status"
            raise SpecError("mckibben", allowed=said, advice="keep these variables: data.isel(...), not data[[...]]")
        return self._data

    @property
    def fields(self) -> Any:
        """DataFrame for people: each field that varies, its values, and how many there are."""
        import pandas as pd

        names = [str(name) for name in self.data.coords if name != "step"]
        rows = {name: {"values": _values(self.data[name]), "count": self.data[name].size} for name in names}
        return pd.DataFrame.from_dict(rows, orient="index", columns=["values", "count"])

    @property
    def counts(self) -> dict[str, int]:
        """How many states came out how, by the words of their verdicts; those that are none left out."""
        return _counted(self.data["verdict"])

    @property
    def statuses(self) -> dict[str, int]:
        """How far how many designs came: complete, incomplete, wrong input, failed, pending."""
        return _counted(self.data["status"])

    @property
    def table(self) -> Any:
        """DataFrame for people: the least and the largest value of each result among the stable states."""
        import pandas as pd

        stable = self.data["verdict"] == 0
        rows = {}
        for name, unit in RESULTS.items():
            if name not in self.data:
                continue
            values = self.data[name].where(stable).values
            if np.isfinite(values).any():
                ends = [_shown(value, unit) for value in (np.nanmin(values), np.nanmax(values))]
                rows[f"{name.replace('_', ' ')} [{unit}]"] = dict(zip(("from", "to"), ends, strict=True))
        return pd.DataFrame.from_dict(rows, orient="index", columns=["from", "to"])

    @property
    def large(self) -> bool:
        """Whether there are too many states to look at all of them for showing."""
        return self.data["verdict"].size > MOST

    def __repr__(self) -> str:
        if not is_sweep(self._data):
            return "<Sweep: this Dataset is none>"
        data = self.data
        kind = str(data.attrs["title"]).rpartition(", ")[2]
        sizes = " x ".join(f"{name} {size}" for name, size in data.sizes.items() if name != "step")
        designs = f"{data['status'].size} designs" + (f" ({sizes})" if sizes else "")
        steps = f"{data.sizes['step']} states each" if data.sizes.get("step", 1) > 1 else "one state each"
        if self.large:
            return f"<Sweep: {designs}, {kind}, {steps}>"
        return f"<Sweep: {designs}, {kind}, {steps}; designs: {said(self.statuses)}; states: {said(self.counts)}>"


def said(counts: dict[str, int]) -> str:
    """Counts in words: "28 stable, 2 unstable"."""
    return ", ".join(f"{count} {word}" for word, count in counts.items())


def _counted(flags: xr.DataArray) -> dict[str, int]:
    """How often each word of a variable of small whole numbers stands there, the most frequent first."""
    words = dict(zip(flags.attrs["flag_values"], str(flags.attrs["flag_meanings"]).split(), strict=True))
    values, counts = np.unique(flags.values, return_counts=True)
    found = {words[int(value)].replace("_", " "): int(count) for value, count in zip(values, counts, strict=True)}
    return dict(sorted(found.items(), key=lambda item: -item[1]))


def _values(coordinate: xr.DataArray) -> str:
    """The values of a field in words, in the unit that people see."""
    values = np.atleast_1d(coordinate.values)
    if values.dtype.kind not in "if":
        words = list(dict.fromkeys(map(str, values)))
        return ", ".join(words[:FEW]) + (", ..." if len(words) > FEW else "")
    unit = str(coordinate.attrs.get("units", "1"))
    shown = DISPLAY.get(unit, unit)
    texts = [_shown(value, shown) for value in (values if len(values) <= FEW else (values.min(), values.max()))]
    listed = ", ".join(texts) if len(values) <= FEW else " to ".join(texts)
    return listed if shown == "1" else f"{listed} {shown}"


def _shown(value: float, unit: str) -> str:
    if not math.isfinite(value):
        return "-"
    shown = 100.0 * float(value) if unit == "%" else float(from_si(float(value), unit))
    return f"{shown:.4g}" if abs(shown) > 1e-9 else "0"


def _html(data: xr.Dataset) -> str | None:
    return Swept(data)._repr_html_() if is_sweep(data) else None


def _text(data: xr.Dataset) -> str | None:
    return repr(Swept(data)) if is_sweep(data) else None


_register: Any = xr.register_dataset_accessor
_register("mckibben")(Swept)
shown_as(xr.Dataset, _html, _text)
