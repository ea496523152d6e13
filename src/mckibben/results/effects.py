"""What `effects()` gives: how much each effect that can be switched on matters at one state. Nothing here computes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs

from mckibben.shown import Shown
from mckibben.spec import Muscle

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["QUANTITIES", "Effects"]

QUANTITIES: dict[str, tuple[str, str]] = {
    "force": ("N", "axial force"),
    "volume": ("m^3", "volume inside the braid"),
    "middle_radius": ("m", "radius at mid-length"),
    "peak_fibre_tension": ("N", "largest tension of a fibre"),
}
"""What an effect changes: unit and meaning."""


@attrs.frozen(eq=False)
class Effects(Shown):
    """The size of each effect for one muscle at one length and pressure.

    It is what `effects` gives. `data` holds, over `effect`, each of force, volume, middle_radius and
    peak_fibre_tension `without` and `with` the effect, in SI units; `switch` says what to put into a case file,
    `assumed` whether a number had to be assumed for it, `time` how long a state takes with it, as a multiple of the
    time without, and `reason` why there are no numbers where there are none.

    Args:
        muscle: the muscle.
        length: distance between the fittings [m].
        pressure: gauge pressure [Pa].
        data: xarray Dataset over `effect` and `state` ("without", "with").

    >>> found = mk.effects(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> round(float(found.table.loc["stretch of the fibres", "force [%]"]), 1)
    -8.9
    """

    muscle: Muscle
    length: float
    pressure: float
    data: xr.Dataset

    @property
    def table(self) -> Any:
        """DataFrame with a row for each effect, the largest change of the force first, and those without numbers last:
        changes in per cent, the time it takes, what to switch on, and why there is nothing to tell."""  # fmt: skip
        frame = self.data[["time", "switch", "reason"]].to_dataframe()
        for place, name in enumerate(QUANTITIES):
            frame.insert(place, f"{name} [%]", self.change(name))
        frame.index.name = None
        order = frame["force [%]"].abs().sort_values(ascending=False, kind="stable", na_position="last").index
        return frame.loc[order]

    def change(self, name: str) -> Any:
        """Change of a quantity by each effect, in per cent of what it is without."""
        without, with_it = (self.data[name].sel(state=state).values for state in ("without", "with"))
        return 100.0 * (with_it / without - 1.0)

    def __repr__(self) -> str:
        return f"<Effects: {self.data.sizes['effect']} effects, {self.data.attrs['title']}>"
