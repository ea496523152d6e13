"""Constants of air and of the earth that several modules take for granted, SI."""

__all__ = ["ATMOSPHERE", "GRAVITY", "HEAT_RATIO", "ROOM_TEMPERATURE"]

ATMOSPHERE = 101325.0
"""Standard atmosphere [Pa]."""
GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2]."""
HEAT_RATIO = 1.4
"""Ratio of the heat capacities of air."""
ROOM_TEMPERATURE = 293.15
"""20 degC [K], the temperature to which sonic conductances refer (ISO 8778)."""
