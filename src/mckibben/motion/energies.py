"""What is known of a rig from its states and what was seen of its muscles: air, energies, and whether they add up.

The arrays are those of NumPy or of JAX.
"""

from __future__ import annotations

from typing import Any

from mckibben.motion.flow import GAMMA, NORMAL
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, PER
from mckibben.results.motion import OF_MUSCLES

__all__ = ["of_muscles", "of_rig"]


def of_muscles(plant: Plant, y: Any, seen: dict[str, Any]) -> dict[str, Any]:
    """The variables of the muscles, (time, muscle) each."""
    parts = y[:, FIRST : FIRST + PER * plant.n].reshape(len(y), plant.n, PER)
    names = ("mass_in", "mass_out", "enthalpy", "heat", "work")
    inside = {name: parts[:, :, 4 + j] for j, name in enumerate(names)}
    found = {name: seen[name].astype(float) for name in OF_MUSCLES if name in seen} | inside
    found["pressure_absolute"] = parts[:, :, 0]
    found["internal"] = parts[:, :, 0] * seen["volume"] / (GAMMA - 1.0)
    return found


def of_rig(plant: Plant, y: Any, muscles: dict[str, Any]) -> dict[str, Any]:
    """The variables of the whole, energies from 0 at the start."""
    x, v = y[:, 0], y[:, 1]

    def since(values: Any) -> Any:
        return (values - values[0]).sum(axis=1)

    found = {} if not plant.rig.turns else {"angle": x, "angular_speed": v}
    if plant.slackens and not plant.rig.turns:
        found["position"] = x
    found["kinetic"] = 0.5 * plant.mass * v**2
    found["potential"] = -plant.weight * (x - x[0]) + 0.5 * plant.spring * (
        (x - plant.rest) ** 2 - (x[0] - plant.rest) ** 2
    )
    found["lost"], found["pushed"] = y[:, 2], y[:, 3]
    found["consumed"] = 1e3 * muscles["mass_in"].sum(axis=1) / NORMAL
    came = since(muscles["enthalpy"]) + since(muscles["heat"]) + found["pushed"]
    there = since(muscles["internal"]) + since(muscles["stored"]) + plant.atmosphere * since(muscles["volume"])
    found["balance"] = came - there - found["kinetic"] + found["kinetic"][0] - found["potential"] - found["lost"]
    return found
