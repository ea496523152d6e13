"""What the tools on motions give: step response, frequency response, sized valve, air and energy of a cycle."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.spec.air import Valve
from mckibben.units import show

__all__ = ["Bode", "Cycle", "Sized", "StepResponse"]


@attrs.frozen(kw_only=True)
class StepResponse:
    """How a quantity goes from one value to another: times in s, values in SI.

    Args:
        of: name of the quantity.
        unit: its SI unit.
        start: value before the step.
        final: value to which it settles.
        delay: time from the step to a tenth of the way.
        rise: time from a tenth to nine tenths of the way.
        overshoot: how far it goes beyond the final value, over the way; 0 for none.
        peak: the furthest value.
        settling: time from the step until it stays within the band about the final value; NaN where it does not.
        band: half of that band, over the way.
    """

    of: str
    unit: str
    start: float
    final: float
    delay: float
    rise: float
    overshoot: float
    peak: float
    settling: float
    band: float

    def __str__(self) -> str:
        way = f"{self.of} from {show(self.start, self.unit, 4)} to {show(self.final, self.unit, 4)}"
        settled = f"settled after {self.settling:.3g} s" if self.settling == self.settling else "not settled"
        return f"{way}: rise {self.rise:.3g} s, overshoot {100.0 * self.overshoot:.1f} %, {settled}"


@attrs.frozen(kw_only=True, eq=False)
class Bode:
    """A frequency response: what a quantity does for a small sine of an input, about an equilibrium.

    Args:
        of: what answers.
        by: what is moved.
        frequency: [Hz].
        response: complex ratio of answer to input, SI.
        poles: of the linearised rig [1/s].
        at: the equilibrium: name of each number of the state -> value, SI.
    """

    of: str
    by: str
    frequency: np.ndarray
    response: np.ndarray
    poles: np.ndarray
    at: dict[str, float]

    @property
    def gain(self) -> np.ndarray:
        """Ratio of the amplitudes, SI."""
        return np.abs(self.response)

    @property
    def phase(self) -> np.ndarray:
        """Phase of the answer [rad], without jumps."""
        return np.unwrap(np.angle(self.response))

    @property
    def natural_frequency(self) -> float:
        """Frequency [Hz] of the least damped pair of poles; NaN where none swings."""
        swinging = self.poles[self.poles.imag > 0.0]
        if not len(swinging):
            return float("nan")
        least = swinging[np.argmax(swinging.real / np.abs(swinging))]
        return float(np.abs(least) / (2.0 * np.pi))

    @property
    def damping(self) -> float:
        """Damping ratio of that pair; NaN where none swings."""
        swinging = self.poles[self.poles.imag > 0.0]
        return float(np.min(-swinging.real / np.abs(swinging))) if len(swinging) else float("nan")


@attrs.frozen(kw_only=True)
class Sized:
    """A valve that is large enough.

    Args:
        valve: the valve.
        time: what it takes with it [s].
        nominal: its nominal flow [m^3/s] from 6 to 5 bar, as catalogues print it.
    """

    valve: Valve
    time: float
    nominal: float

    def __str__(self) -> str:
        flow = f"{6e4 * self.nominal:.3g} L/min"
        return f"C = {show(self.valve.C, 'm^3/s/Pa', 3)}, b = {self.valve.b:g} (nominal flow {flow}): {self.time:.3g} s"


@attrs.frozen(kw_only=True)
class Cycle:
    """Air and energy of one cycle, from its begin to its end in a motion; energies in J.

    Args:
        begin: when it begins [s].
        end: when it ends [s].
        air: air taken from the supply, in normal litres.
        exergy: work that the air taken could have done, let out to the atmosphere at constant temperature.
        delivered: work that the muscles did on the load where they pulled it.
        returned: work that the load did on the muscles.
        lost: energy lost in dampers, friction, stops and rubber.
        heat: heat that came in through the wall.
        drift: the largest change of length or angle from begin to end, over its range: 0 for a true cycle.
    """

    begin: float
    end: float
    air: float
    exergy: float
    delivered: float
    returned: float
    lost: float
    heat: float
    drift: float

    @property
    def efficiency(self) -> float:
        """Net work on the load over the exergy of the air; NaN where none was taken."""
        return (self.delivered - self.returned) / self.exergy if self.exergy > 0.0 else float("nan")

    def __str__(self) -> str:
        work = f"{self.delivered:.3g} J delivered, {self.returned:.3g} J returned"
        return f"{self.air:.3g} normal litres, {self.exergy:.3g} J of exergy; {work}; {100.0 * self.efficiency:.3g} %"
