"""What `fit()` gives: best values, how sure they are, how far the model is from each point. Nothing is solved here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.results.found import Found
from mckibben.spec import Muscle

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["POINTS", "Fitted"]

POINTS = {
    "length": ("m", "measured length between the fittings"), "pressure": ("Pa", "measured pressure"),
    "force": ("N", "measured force"), "predicted": ("N", "force of the fitted muscle, offsets included"),
    "weight": ("1", "weight of the point"),
}  # fmt: skip
"""What is known of each point."""


@attrs.frozen(eq=False, repr=False)
class Fitted(Found):
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

    def test(self, name: str) -> Any:
        """The points of one test, as a Dataset."""
        return self.data.isel(point=np.flatnonzero(self.data["test"].values == name))

    def __repr__(self) -> str:
        counts = f"{len(self.numbers)} numbers to {len(self.residuals)} points"
        counts += f" of {len(self.muscles)} muscles" if self.further else ""
        return f"<Fit: {counts}, {self.goodness}>"
