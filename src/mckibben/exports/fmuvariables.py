"""The variables of an FMU: the muscle alone, or with a mass on it and a valve."""

from __future__ import annotations

from typing import Any

import attrs

from mckibben.spec.constants import ATMOSPHERE, GRAVITY, ROOM_TEMPERATURE

__all__ = ["Variable", "muscle_variables", "rig_variables"]


@attrs.frozen
class Variable:
    """One variable of an FMU, SI."""

    name: str
    kind: str  #: "parameter", "input" or "output"
    unit: str  #: as FMI says it; "" for pure numbers
    meaning: str
    start: float | bool | None = None  #: None for outputs
    flag: bool = False  #: a truth value


def _output(name: str, unit: str, meaning: str) -> Variable:
    return Variable(name, "output", unit, meaning)


INSIDE = Variable(
    "inside", "output", "", "whether the point is in the range of the map, where its error holds", None, True
)
STIFFNESS = _output("stiffness", "N/m", "slope of the force by the length at constant pressure")


def muscle_variables(length: float, pressure: float, rubs: bool = False) -> tuple[Variable, ...]:
    """Pressure and length in, force and more out; where crossings rub, that too."""
    branches = (
        "of crossings that all slip: the muscle pulls with force less friction as it shortens, plus as it lengthens"
    )
    slack = "whether the muscle hangs on a tendon, which does not push: no force below zero"
    return (
        Variable("pressure", "input", "Pa", "gauge pressure", pressure),
        Variable("length", "input", "m", "length between the fittings", length),
        Variable("slack", "parameter", "", slack, False, True),
        _output("force", "N", "force with which the muscle pulls its fittings together"),
        _output("volume", "m3", "volume inside the braid"),
        STIFFNESS,
        _output("volume_by_length", "m2", "slope of the volume by the length at constant pressure"),
        _output("volume_by_pressure", "m3/Pa", "slope of the volume by the pressure at constant length"),
        _output("largest_radius", "m", "largest radius along the muscle"),
        INSIDE,
        *((_output("friction", "N", branches),) if rubs else ()),
    )


def rig_variables(mass: float, pressures: tuple[float, float]) -> tuple[Variable, ...]:
    """Command of the valve and a push in, motion and air out."""

    def parameter(name: str, unit: str, start: Any, meaning: str) -> Variable:
        return Variable(name, "parameter", unit, meaning, start)

    return (
        Variable("command", "input", "", "of the valve: 1 fills, 0 closes, -1 vents; in between opens it in part", 0.0),
        Variable("push", "input", "N", "force that lengthens the muscle, beside the weight of the mass", 0.0),
        parameter("mass", "kg", mass, "mass that hangs on the muscle"),
        parameter("damping", "N.s/m", 20.0, "force against the motion, over the speed (assumed)"),
        parameter("gravity", "m/s2", GRAVITY, "acceleration that lengthens the muscle; 0 for a mass on a table"),
        parameter("supply", "Pa", pressures[1], "gauge pressure of the supply"),
        parameter("conductance", "m3/(s.Pa)", 1e-9, "sonic conductance from the supply, ISO 6358 (assumed)"),
        parameter("vent", "m3/(s.Pa)", 1e-9, "sonic conductance to the atmosphere, ISO 6358 (assumed)"),
        parameter("critical_ratio", "", 0.3, "ratio of pressures below which the flow is choked, ISO 6358 (assumed)"),
        parameter("tube", "m3", 0.0, "volume between valve and muscle"),
        parameter("exponent", "", 1.0, "of the air: 1 is isothermal, 1.4 is adiabatic"),
        parameter("atmosphere", "Pa", ATMOSPHERE, "absolute pressure around"),
        parameter("temperature_around", "K", ROOM_TEMPERATURE, "temperature around and of the supply"),
        parameter("pressure_start", "Pa", max(pressures[0], 0.0), "gauge pressure at the start"),
        parameter("length_start", "m", 0.0, "length at the start; 0 for the one at rest"),
        parameter("step", "s", 2e-3, "longest step of the integration within a step of communication"),
        _output("length", "m", "length between the fittings"),
        _output("speed", "m/s", "speed at which the length grows"),
        _output("force", "N", "force with which the muscle pulls its fittings together"),
        _output("pressure", "Pa", "gauge pressure in the muscle"),
        _output("air_volume", "m3", "volume of the air in muscle and tube"),
        _output("air_mass", "kg", "mass of the air in muscle and tube"),
        _output("temperature", "K", "temperature of that air"),
        _output("inflow", "kg/s", "mass flow from the supply"),
        _output("outflow", "kg/s", "mass flow to the atmosphere"),
        STIFFNESS,
        INSIDE,
    )  # fmt: skip
