"""What `fit_motion()` gives: the rig with the best values, how sure they are, how far it is from what was measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from mckibben.results.found import Found
from mckibben.spec.rig import Rig
from mckibben.units import show

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MOMENTS", "MotionFit"]

MOMENTS = {
    "time": "time", "measured": "measured value", "predicted": "value of the fitted rig",
    "size": "standard deviation of a measured value",
}  # fmt: skip
"""What is known of each measured value: SI, by its `quantity`."""


@attrs.frozen(eq=False, repr=False)
class MotionFit(Found):
    """A rig fitted to a measured motion, as `fit_motion` gives it; `rig` is a rig like any other.

    Args:
        rig: the rig with the best values.
        given: the rig from which the fit began.
        data: xarray Dataset: of each free `number` its value, error, low, high and bounds (SI), `correlation`; of each
            measured value (`point`) its time, quantity, measured, predicted and size (SI).

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> seen = mk.simulate(rig, until="0.4 s", points=21)
    >>> table = {"time [s]": seen.time, "pressure [Pa]": seen.pressure}
    >>> start = mk.Rig(
    ...     muscle=rig.muscle, load=rig.load, supply=rig.supply, command=1.0, valve=mk.Valve(C="0.2 L/s/bar", b=0.3)
    ... )
    >>> found = mk.fit_motion(start, mk.read_recording(table), {"valve.C": "0.05 L/s/bar to 0.3 L/s/bar"})
    >>> print(round(1e8 * found.rig.valve.C, 4), found.undetermined)  # L/s/bar
    0.1 ()
    """

    rig: Rig
    given: Rig
    data: xr.Dataset

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MotionFit):
            return NotImplemented
        return self.rig == other.rig and self.given == other.given and bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash(self.numbers)

    @property
    def quantities(self) -> tuple[str, ...]:
        """What was measured."""
        return tuple(dict.fromkeys(str(name) for name in self.data["quantity"].values))

    def residuals(self, quantity: str) -> np.ndarray:
        """Predicted less measured values of a quantity, SI, over time."""
        chosen = self.data["quantity"].values == quantity
        return np.asarray((self.data["predicted"].values - self.data["measured"].values)[chosen])

    @property
    def rms(self) -> dict[str, float]:
        """Root of the mean square of the residuals of each quantity, SI."""
        return {name: float(np.sqrt(np.mean(self.residuals(name) ** 2))) for name in self.quantities}

    def __repr__(self) -> str:
        units = {"length": "mm", "pressure": "bar", "force": "N", "angle": "deg"}
        told = ", ".join(f"{name} {show(rms, units[name], 3)}" for name, rms in self.rms.items())
        return f"<MotionFit: {len(self.numbers)} numbers to {self.data.sizes['point']} values, rms {told}>"
