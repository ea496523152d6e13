"""What `fit()` gives: best values, how sure they are, how far the model is from each point. Nothing is solved here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.shown import Shown
from mckibben.spec import Muscle
from mckibben.units import from_si, show

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["NUMBERS", "POINTS", "Fitted"]

NUMBERS = {
    "value": "best value", "error": "standard error", "low": "lower end of the interval",
    "high": "upper end of the interval", "from": "lower bound of the search", "to": "upper bound of the search",
    "start": "value of the muscle as given",
}  # fmt: skip
"""What is known of each free number, in its SI unit."""
POINTS = {
    "length": ("m", "measured length between the fittings"), "pressure": ("Pa", "measured pressure"),
    "force": ("N", "measured force"), "predicted": ("N", "force of the fitted muscle, offsets included"),
    "weight": ("1", "weight of the point"),
}  # fmt: skip
"""What is known of each point."""


@attrs.frozen(eq=False, repr=False)
class Fitted(Shown):
    """A muscle fitted to measured forces, as `fit` gives it; `muscle` is a muscle like any other.

    Args:
        muscle: the muscle with the best values.
        given: the muscle from which the fit began.
        data: xarray Dataset: of each free `number` its value, error, low, high and bounds (SI), `correlation`; of each
            `point` length, pressure, force, predicted (SI), test and branch.
        further: where several muscles were fitted together, those after the first.
    """

    muscle: Muscle
    given: Muscle
    data: xr.Dataset
    further: tuple[Muscle, ...] = ()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Fitted):
            return NotImplemented
        same = self.muscles == other.muscles and self.given == other.given
        return same and bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash((self.muscle, self.given))

    @property
    def muscles(self) -> tuple[Muscle, ...]:
        """All that were fitted together, in the order of their data."""
        return (self.muscle, *self.further)

    @property
    def rest_lengths(self) -> np.ndarray:
        """The length as made of each point's muscle [m]."""
        whole = np.array([float(muscle.rest_length) for muscle in self.muscles])
        of = self.data["of"].values if self.further else np.zeros(len(self.residuals), int)
        return np.asarray(whole[of])

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of what was free."""
        return tuple(str(name) for name in self.data["number"].values)

    @property
    def values(self) -> dict[str, float]:
        """Best values by name, SI."""
        return dict(zip(self.numbers, self.data["value"].values.tolist(), strict=True))

    @property
    def residuals(self) -> np.ndarray:
        """Predicted less measured force [N] at every point."""
        return np.asarray(self.data["predicted"].values - self.data["force"].values)

    @property
    def rms(self) -> float:
        """Root of the mean square of the residuals [N]."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def largest(self) -> float:
        """Largest residual by size [N]."""
        return float(np.abs(self.residuals).max())

    @property
    def percent(self) -> float:
        """`rms` in per cent of the largest measured force; NaN where all of them are zero, as of free contractions."""
        return self.share(self.rms)

    def share(self, force: float) -> float:
        """A force [N] in per cent of the largest measured one; NaN where all of them are zero."""
        most = float(np.abs(self.data["force"].values).max())
        return 100.0 * force / most if most else float("nan")

    @property
    def goodness(self) -> str:
        """`rms`, in parts of the largest measured force too where there is one, in words."""
        said = "" if np.isnan(self.percent) else f" ({self.percent:.2g} % of the largest force)"
        return f"rms {self.rms:.3g} N{said}"

    @property
    def explained(self) -> float:
        """Share of the variance of the measured forces that the fit explains, R squared; NaN where they do not vary."""
        force = self.data["force"].values
        spread = float(np.sum((force - force.mean()) ** 2))
        return 1.0 - float(np.sum(self.residuals**2)) / spread if spread else float("nan")

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

    def test(self, name: str) -> Any:
        """The points of one test, as a Dataset."""
        return self.data.isel(point=np.flatnonzero(self.data["test"].values == name))

    def __repr__(self) -> str:
        counts = f"{len(self.numbers)} numbers to {len(self.residuals)} points"
        counts += f" of {len(self.muscles)} muscles" if self.further else ""
        return f"<Fit: {counts}, {self.goodness}>"
