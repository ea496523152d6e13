"""A rig as the numbers that its equations of motion need."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import attrs

from mckibben.motion.mapped import At, Mapped, RubbingAt
from mckibben.spec.air import Isothermal, WallHeat
from mckibben.spec.loads import Load, Pulley
from mckibben.spec.rig import Rig

__all__ = ["Plant", "without_rubber"]

NEAR = 1e-4
"""Distance from the pressures of a map, over their range, that counts as on an edge: a vented muscle is inside."""


@attrs.frozen
class Plant:
    """A rig as numbers."""

    rig: Rig
    charts: Sequence[Mapped]
    ats: list[At]
    rubs: dict[int, RubbingAt]  #: friction at the crossings, of the muscles that have it
    edges: list[tuple[float, float, float, float]]  #: of the pressures of the maps, and just beyond
    dead: list[float]  #: air [m^3] that is not inside the braid
    offsets: list[float]  #: the length of each muscle is offset + ratio x
    ratios: list[float]
    valves: list[tuple[float, float, float]]  #: conductance in and out, and critical ratio of pressures
    supplied: float
    source: float  #: temperature of the supply [K]
    atmosphere: float
    around: float  #: temperature around [K]
    isothermal: bool
    exponent: float
    wall: float  #: heat from the wall [W/K]
    damper: float | None
    series: float | None  #: stiffness of the viscous spring
    mass: float
    weight: float
    spring: float
    damping: float
    friction: float
    rest: float  #: where the spring of the load has no force
    outer: Callable[[float], float] | None
    sense: float
    stops: tuple[float | None, float | None]
    slackens: bool

    @classmethod
    def of(cls, rig: Rig, charts: Sequence[Any]) -> Plant:
        """A rig whose muscles have these maps."""
        load, viscosity, (offsets, ratios) = rig.load, rig.viscosity, _geometry(rig)
        rest = getattr(load, "spring_at", None)
        straight = isinstance(load, Load)
        assert rig.supply is not None
        return cls(
            rig=rig, charts=charts, ats=[chart.at for chart in charts], edges=[_edges(chart) for chart in charts],
            rubs={k: chart.rubbing_at for k, chart in enumerate(charts) if getattr(chart, "rubbing_at", None)},
            dead=[rig.tube + without_rubber(chart) for chart in charts], offsets=offsets, ratios=ratios,
            valves=[(valve.C, valve.venting, valve.b) for valve in rig.valves],
            supplied=rig.supplied, source=rig.supply.temperature, atmosphere=rig.atmosphere, around=rig.temperature,
            isothermal=isinstance(rig.air, Isothermal), exponent=rig.exponent,
            wall=rig.air.conductance if isinstance(rig.air, WallHeat) else 0.0,
            damper=None if viscosity is None else viscosity.damping,
            series=None if viscosity is None else viscosity.stiffness,
            mass=rig.mass, weight=load.mass * load.gravity if isinstance(load, Load) else 0.0,
            spring=getattr(load, "spring", 0.0), damping=getattr(load, "damping", 0.0),
            friction=getattr(load, "friction", 0.0), rest=0.0 if rest is None else rest,
            outer=load.push if isinstance(load, Load) else getattr(load, "torque", None),
            sense=1.0 if straight else -1.0,
            stops=(getattr(load, "stop_low", None), getattr(load, "stop_high", None)),
            slackens=bool(getattr(load, "slack", False)),
        )  # fmt: skip

    @property
    def n(self) -> int:
        """How many muscles it has."""
        return len(self.ats)


def _geometry(rig: Rig) -> tuple[list[Any], list[Any]]:
    """Offsets and ratios of the muscles."""
    load = rig.load
    if not isinstance(load, Pulley):
        return [0.0], [1.0]
    first = rig.muscle.rest_length if load.length is None else load.length
    if rig.antagonist is None:
        return [first], [-load.radius]
    second = load.antagonist_length if load.antagonist_length is not None else load.length
    if second is None:
        second = rig.antagonist.rest_length
    return [first, second], [-load.radius, load.radius]


def _edges(chart: Any) -> tuple[Any, Any, Any, Any]:
    first, last = chart.pressures
    near = NEAR * (last - first)
    return first - near, first, last, last + near


def without_rubber(chart: Any) -> Any:
    """Air less braid volume [m^3] of a muscle, which does not change."""
    if hasattr(chart, "apart"):  # one that has been asked before
        return chart.apart
    pressure = chart.pressures[0]
    h = 0.5 * sum(map(float, chart.lengths(pressure)))
    found = float(chart.air_volume(h, pressure)) - float(chart.at(h, pressure).volume)
    return found if math.isfinite(found) else 0.0
