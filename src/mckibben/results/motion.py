"""What `simulate()` gives: a rig in motion, over time. Nothing is computed here."""

from __future__ import annotations

import json
import tomllib
from typing import TYPE_CHECKING

import attrs
import numpy as np

from mckibben.shown import Shown
from mckibben.spec.rig import Rig
from mckibben.spec.rigtext import rig_from_mapping
from mckibben.units import show

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["HANGING", "OF_MUSCLES", "OF_RIG", "TURNING", "Motion"]

OF_MUSCLES: dict[str, tuple[str, str]] = {
    "length": ("m", "distance between the fittings; of a slack muscle its own length"),
    "speed": ("m/s", "rate of the length"),
    "force": ("N", "force with which its ends pull, viscosity included"),
    "pressure": ("Pa", "gauge pressure"),
    "pressure_absolute": ("Pa", "absolute pressure"),
    "temperature": ("K", "temperature of the air inside"),
    "mass": ("kg", "mass of the air inside, tube included"),
    "volume": ("m^3", "volume of the air inside, tube included"),
    "inflow": ("kg/s", "mass flow from the supply"),
    "outflow": ("kg/s", "mass flow to the atmosphere"),
    "command": ("1", "command that has reached the valve: -1 vents, 0 closes, 1 fills"),
    "mass_in": ("kg", "mass of air taken from the supply"),
    "mass_out": ("kg", "mass of air given to the atmosphere"),
    "enthalpy": ("J", "enthalpy that came in with air less that which left"),
    "heat": ("J", "heat that came in through the wall"),
    "internal": ("J", "internal energy of the air"),
    "stored": ("J", "energy stored in the muscle, viscous spring included"),
    "work": ("J", "work done on what it moves"),
}
"""What is known of each muscle over time: unit and meaning."""
OF_RIG: dict[str, tuple[str, str]] = {
    "kinetic": ("J", "kinetic energy of the load"),
    "potential": ("J", "energy of the load in gravity and its spring, from 0 at the start"),
    "lost": ("J", "energy lost in dampers, friction, end stops and rubber"),
    "pushed": ("J", "work of the push or torque from outside"),
    "consumed": ("L", "air taken from the supply, in normal litres (0 degC, 1.01325 bar)"),
    "balance": ("J", "energy that came in less what is there and what was lost: the error of the integration"),
}
"""What is known of the whole."""
TURNING = {"angle": ("rad", "angle of the pulley"), "angular_speed": ("rad/s", "its rate")}
"""What is known of a pulley too."""
HANGING = {"position": ("m", "length that a straight cable would give the muscle: where the load is")}
"""What is known too of a load on a cable that may go slack."""


@attrs.frozen(eq=False, repr=False)
class Motion(Shown):
    """A rig in motion, as `simulate` gives it.

    Args:
        data: xarray Dataset over `time` [s] with all that was seen, SI; of two muscles over `muscle` too.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> motion = mk.simulate(rig, until="1 s")
    >>> motion
    <Motion: "paper" held at 100 mm, 1 s, 0.07 normal litres>
    >>> motion.complete, motion.inside, float(motion.force[-1].round(1))  # N
    (True, True, 90.5)
    """

    data: xr.Dataset

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motion):
            return NotImplemented
        return bool(self.data.identical(other.data))

    def __hash__(self) -> int:
        return hash(str(self.data.attrs["rig"]))

    @property
    def rig(self) -> Rig:
        """The rig. SpecError where its controller was a Python function, which is not kept."""
        return rig_from_mapping(tomllib.loads(str(self.data.attrs["rig"])))

    @property
    def time(self) -> np.ndarray:
        """Times [s]."""
        return np.asarray(self.data["time"].values)

    @property
    def length(self) -> np.ndarray:
        """Length of the muscle [m] at each time; of two muscles (time, muscle), as all that is a muscle's."""
        return self.of("length")

    @property
    def speed(self) -> np.ndarray:
        """Rate of the length [m/s]."""
        return self.of("speed")

    @property
    def force(self) -> np.ndarray:
        """Force with which the muscle pulls [N]."""
        return self.of("force")

    @property
    def pressure(self) -> np.ndarray:
        """Gauge pressure [Pa]."""
        return self.of("pressure")

    @property
    def angle(self) -> np.ndarray:
        """Angle of the pulley [rad]."""
        return self.of("angle")

    @property
    def consumed(self) -> float:
        """Air taken from the supply in all, in normal litres."""
        return float(self.data["consumed"].values[-1])

    def of(self, name: str) -> np.ndarray:
        """A variable by its name, as an array."""
        return np.asarray(self.data[name].values)

    @property
    def complete(self) -> bool:
        """Whether the end was reached."""
        return not self.reason

    @property
    def reason(self) -> str:
        """Why it stopped before the end; empty where it did not."""
        return str(self.data.attrs["reason"])

    @property
    def inside(self) -> bool:
        """Whether all states lie in the range of the map."""
        return bool(self.data["inside"].values.all())

    @property
    def notes(self) -> tuple[str, ...]:
        """What must be known of the numbers, in sentences."""
        return tuple(line for line in str(self.data.attrs["notes"]).split("\n") if line)

    @property
    def events(self) -> pd.DataFrame:
        """DataFrame of what happened when: end stops, friction that held, cables that went slack."""
        import pandas as pd

        return pd.DataFrame(json.loads(self.data.attrs["events"]), columns=["time", "event"])

    @property
    def several(self) -> bool:
        """Whether there are two muscles."""
        return "muscle" in self.data.sizes

    def summary(self) -> pd.DataFrame:
        """DataFrame for people: the first, last, least and largest value of what moves, and air and energy."""
        import pandas as pd

        rows = {}
        names = [
            *(name for name in TURNING if name in self.data),
            "length",
            "speed",
            "force",
            "pressure",
            "temperature",
        ]
        for name in names:
            values, unit = self.of(name), str(self.data[name].attrs["units"])
            several = values.ndim == 2
            for k in range(values.shape[1] if several else 1):
                one = values[:, k] if several else values
                head = f"{name} of the {self.data['muscle'].values[k]}" if several else name
                rows[head] = [show(float(x), unit, 4) for x in (one[0], one[-1], one.min(), one.max())]
        for name in ("lost", "consumed", "balance"):
            one, unit = self.of(name), str(self.data[name].attrs["units"])
            rows[name] = [f"{float(x):.3g} {unit}" for x in (one[0], one[-1], one.min(), one.max())]
        return pd.DataFrame(rows, index=["first", "last", "least", "largest"]).T

    def __repr__(self) -> str:
        end = show(float(self.time[-1]), "s", 4)
        held = str(self.data.attrs["title"])
        told = "" if self.complete else f"; {self.reason}"
        return f"<Motion: {held}, {end}, {self.consumed:.3g} normal litres{told}>"
