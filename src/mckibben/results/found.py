"""Numbers that a fit found: best values, how sure they are, and which of them the data leave open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.shown import Shown
from mckibben.units import from_si, show

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["NUMBERS", "Found"]

NUMBERS = {
    "value": "best value", "error": "standard error", "low": "lower end of the interval",
    "high": "upper end of the interval", "from": "lower bound of the search", "to": "upper bound of the search",
    "start": "value of the muscle as given",
}  # fmt: skip
"""What is known of each free number, in its SI unit."""


class Found(Shown):
    """What all fits share; `data` has the numbers."""

    data: xr.Dataset

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of what was free."""
        return tuple(str(name) for name in self.data["number"].values)

    @property
    def values(self) -> dict[str, float]:
        """Best values by name, SI."""
        return dict(zip(self.numbers, self.data["value"].values.tolist(), strict=True))

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known to use the numbers: what is not determined, at a bound, assumed."""
        return tuple(line for line in str(self.data.attrs["notes"]).split("\n") if line)

    @property
    def converged(self) -> bool:
        """Whether the search came to an end by itself."""
        return bool(self.data.attrs["converged"])

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Numbers that the data do not determine."""
        return tuple(
            name for name, lost in zip(self.numbers, self.data["undetermined"].values.tolist(), strict=True) if lost
        )

    @property
    def correlation(self) -> Any:
        """DataFrame of the correlations of the numbers."""
        frame = self.data["correlation"].to_pandas()
        frame.columns.name = frame.index.name = None
        return frame

    @property
    def intervals(self) -> Any:
        """DataFrame, SI: `low` and `high` of each number at the level asked for."""
        import pandas as pd

        return pd.DataFrame({name: self.data[name].values for name in ("low", "high")}, index=list(self.numbers))

    @property
    def table(self) -> Any:
        """DataFrame for people, in usual units; a number that the data leave open has "not determined" for a value."""
        import pandas as pd

        rows = []
        for k in range(len(self.numbers)):
            at = {kind: float(self.data[kind].values[k]) for kind in NUMBERS}
            display = str(self.data["display"].values[k])
            lost = bool(self.data["undetermined"].values[k])
            rows.append(
                {
                    "value": "not determined" if lost else show(at["value"], display),
                    "error": "" if lost or not np.isfinite(at["error"]) else f"{from_si(at['error'], display):.3g}",
                    "interval": f"{from_si(at['low'], display):.6g} to {show(at['high'], display)}",
                    "bounds": f"{from_si(at['from'], display):.6g} to {show(at['to'], display)}",
                }
            )
        return pd.DataFrame(rows, index=list(self.numbers))
