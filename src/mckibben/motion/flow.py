"""The flow of air through a valve or an orifice, by ISO 6358, and the numbers of air."""

from __future__ import annotations

import math

from mckibben.spec.constants import HEAT_RATIO, ROOM_TEMPERATURE

__all__ = ["GAMMA", "GAS", "HEAT", "LAMINAR", "NORMAL", "RHO", "TEMPERATURE", "mass_flow"]

GAS = 287.05
"""Gas constant of air [J/kg/K]."""
GAMMA = HEAT_RATIO
"""Ratio of its heat capacities."""
HEAT = GAS * GAMMA / (GAMMA - 1.0)
"""Its heat capacity at constant pressure [J/kg/K]."""
RHO, TEMPERATURE = 1.185, ROOM_TEMPERATURE
"""Density [kg/m^3] and temperature [K] to which sonic conductances refer (ISO 8778)."""
NORMAL = 1.2928
"""Mass of a normal cubic metre [kg], at 0 degC and 1.01325 bar (DIN 1343)."""
LAMINAR = 0.999
"""Ratio of pressures above which the flow is straight in their difference: its slope has no bound otherwise."""


def mass_flow(C: float, b: float, before: float, temperature: float, after: float) -> float:
    """Mass flow [kg/s] from an absolute pressure [Pa] at a temperature [K] to a lower one.

    C is the sonic conductance [m^3/s/Pa] and b the critical ratio.
    """
    choked = C * RHO * before * math.sqrt(TEMPERATURE / temperature)
    ratio = after / before
    if ratio <= b:
        return choked
    if ratio < LAMINAR:
        return choked * math.sqrt(1.0 - ((ratio - b) / (1.0 - b)) ** 2)
    edge = max(LAMINAR, b)
    return choked * math.sqrt(1.0 - ((edge - b) / (1.0 - b)) ** 2) * (1.0 - ratio) / (1.0 - edge)
