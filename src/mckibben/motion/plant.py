"""The equations of motion of a rig: rates of its state, by the mode in which it is.

The state is x (length, or angle of a pulley), its speed, what was lost to friction and what was pushed in, and for each
supply, mass given to the atmosphere, and enthalpy, heat and work so far. The equations are on the theory page.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import attrs

from mckibben.motion.flow import GAMMA, GAS, HEAT, mass_flow
from mckibben.motion.mapped import At, Mapped
from mckibben.spec.air import Isothermal, WallHeat
from mckibben.spec.loads import Load, Pulley
from mckibben.spec.rig import Rig

__all__ = ["FIRST", "PER", "Mode", "Plant", "Rates", "Seen"]

FIRST, PER = 4, 9
"""Place of the first muscle's numbers in the state, and how many each has."""
NEAR = 1e-4
"""Distance from the pressures of a map, over their range, that counts as on an edge: a vented muscle is inside."""


class Seen(NamedTuple):
    """What is to be seen of one muscle at one time, SI."""

    length: float
    speed: float
    force: float  #: what its end pulls with, viscosity included
    pressure: float  #: gauge
    temperature: float
    mass: float
    inflow: float  #: from the supply [kg/s]
    outflow: float  #: to the atmosphere
    command: float
    volume: float  #: of the air, tube included
    stored: float  #: energy stored in the muscle, its viscous spring included
    inside: bool
    slack: bool


class Rates(NamedTuple):
    """Rates of the state, and what is seen on the way."""

    state: list[float]
    muscles: list[Seen]
    push: float  #: resultant along x without friction [N, or N m]


@attrs.frozen
class Mode:
    """How a rig moves: "free", "stuck" by friction, or at a stop, "low" or "high"; and which muscles are slack."""

    moves: str = "free"
    sliding: float = 0.0
    slack: tuple[bool, ...] = (False, False)


class Plant:
    """A rig as numbers. `mode` and `commands` change from one stretch of time to the next."""

    def __init__(self, rig: Rig, charts: Sequence[Mapped], rest: float = 0.0) -> None:
        self.rig, self.n = rig, len(rig.muscles)
        self.charts = charts
        self.ats: list[At] = [chart.at for chart in charts]
        self.edges = [_edges(chart) for chart in charts]
        self.dead = [rig.tube + _without_rubber(chart) for chart in charts]
        self.mode = Mode()
        self.commands: list[Callable[[float], float]] = [lambda t: 0.0] * self.n
        self.supplied, self.atmosphere, self.around = rig.supplied, rig.atmosphere, rig.temperature
        assert rig.supply is not None
        self.source = rig.supply.temperature
        self.valves = [(valve.C, valve.venting, valve.b) for valve in rig.valves]
        self.isothermal = isinstance(rig.air, Isothermal)
        self.exponent = rig.exponent
        self.wall = rig.air.conductance if isinstance(rig.air, WallHeat) else 0.0
        viscosity = rig.viscosity
        self.damper = 0.0 if viscosity is None else viscosity.damping
        self.series = None if viscosity is None else viscosity.stiffness
        load = rig.load
        self.mass = rig.mass
        self.offsets, self.ratios = self._geometry()
        self.weight = load.mass * load.gravity if isinstance(load, Load) else 0.0
        self.spring, self.damping, self.friction = (
            getattr(load, name, 0.0) for name in ("spring", "damping", "friction")
        )
        at = getattr(load, "spring_at", None)
        self.rest = rest if at is None and isinstance(load, Load) else (at or 0.0)
        self.outer = load.push if isinstance(load, Load) else getattr(load, "torque", None)
        self.sense = 1.0 if isinstance(load, Load) else -1.0
        self.stops = (getattr(load, "stop_low", None), getattr(load, "stop_high", None))
        self.slackens = bool(getattr(load, "slack", False))

    def _geometry(self) -> tuple[list[float], list[float]]:
        """The length of each muscle is offset + ratio x."""
        load = self.rig.load
        if not isinstance(load, Pulley):
            return [0.0], [1.0]
        first = load.length or self.rig.muscle.rest_length
        if self.n == 1:
            return [first], [-load.radius]
        assert self.rig.antagonist is not None
        second = load.antagonist_length or load.length or self.rig.antagonist.rest_length
        return [first, second], [-load.radius, load.radius]

    def outside(self, t: float) -> float:
        """Force or torque from outside along x at a time."""
        return 0.0 if self.outer is None else self.sense * float(self.outer(t))

    def rates(self, t: float, y: Sequence[float]) -> Rates:
        """Rates of the state at a time."""
        mode, moves = self.mode, self.mode.moves == "free" and not self.rig.fixed
        x, v = y[0], (y[1] if moves else 0.0)
        outer = self.outside(t)
        push = self.weight + outer - self.damping * v - self.spring * (x - self.rest)
        lost = self.damping * v * v + self.friction * abs(v)
        state, muscles = [v, 0.0, lost, outer * v], []
        for k in range(self.n):
            part, seen, rubbed = self._muscle(k, t, y, x, v, mode.slack[k])
            push -= self.ratios[k] * seen.force
            state[2] += rubbed
            state += part
            muscles.append(seen)
        if moves:
            state[1] = (push - mode.sliding * self.friction) / self.mass
        return Rates(state, muscles, push)

    def _muscle(
        self, k: int, t: float, y: Sequence[float], x: float, v: float, slack: bool
    ) -> tuple[list[float], Seen, float]:
        """Rates of one muscle's numbers, what is seen of it, and what its rubber turns into heat."""
        p, T, own, q = y[FIRST + PER * k : FIRST + PER * k + 4]
        h = own if slack else self.offsets[k] + self.ratios[k] * x
        low, first, last, high = self.edges[k]
        P = p - self.atmosphere
        P = first if low < P < first else last if last < P < high else P
        found = self.ats[k](h, P)
        Vh, VP = found.volume_by_length, found.volume_by_pressure
        V = found.volume + self.dead[k]
        u = self.commands[k](t)
        inflow, outflow, carried, heat_rate = self._air(k, u, p, T)
        a = heat_rate + self.exponent * GAS * carried
        alpha, beta = self._lengthening(found, q, slack, self.ratios[k] * v)
        rate = (a - self.exponent * p * Vh * alpha) / (V + self.exponent * p * (VP + Vh * beta))
        speed = alpha + beta * rate
        volume_rate = Vh * speed + VP * rate
        m = p * V / (GAS * T)
        net = inflow - outflow
        warming = 0.0 if self.isothermal else T * (rate / p + volume_rate / V - net / m)
        enthalpy = HEAT * (carried if not self.isothermal else self._carried(inflow, outflow, T))
        heat = (rate * V + p * volume_rate) / (GAMMA - 1.0) - enthalpy + p * volume_rate
        force, drag, rubbed, stored = self._viscous(found.force, q, slack, speed)
        stored += found.potential + P * found.volume
        state = [rate, warming, speed, drag, inflow, outflow, enthalpy, heat, -force * speed]
        return state, Seen(h, speed, force, p - self.atmosphere, T, m, inflow, outflow, u, V, stored,
                           bool(found.inside), slack), rubbed  # fmt: skip

    def _air(self, k: int, u: float, p: float, T: float) -> tuple[float, float, float, float]:
        """Mass flows in and out, flow times temperature carried in, and pressure times volume by heat from the wall."""
        C, vent, b = self.valves[k]
        inflow = outflow = 0.0
        if u > 0.0:
            back = p > self.supplied
            inflow = (
                -mass_flow(C * u, b, p, T, self.supplied)
                if back
                else mass_flow(C * u, b, self.supplied, self.source, p)
            )
        elif u < 0.0:
            back = p < self.atmosphere
            outflow = (
                -mass_flow(-vent * u, b, self.atmosphere, self.around, p)
                if back
                else mass_flow(-vent * u, b, p, T, self.atmosphere)
            )
        if self.isothermal:
            return inflow, outflow, (inflow - outflow) * T, 0.0
        return inflow, outflow, self._carried(inflow, outflow, T), (GAMMA - 1.0) * self.wall * (self.around - T)

    def _carried(self, inflow: float, outflow: float, T: float) -> float:
        """Flow times the temperature that it brings or takes."""
        return inflow * (self.source if inflow > 0.0 else T) - outflow * (T if outflow > 0.0 else self.around)

    def _lengthening(self, found: object, q: float, slack: bool, speed: float) -> tuple[float, float]:
        """The speed of the muscle as alpha + beta times the rate of its pressure; a slack one stays without force."""
        if not slack:
            return speed, 0.0
        K, Vh = found.stiffness, found.volume_by_length  # type: ignore[attr-defined]
        if not self.damper:
            return 0.0, Vh / K
        if self.series is None:
            return -found.force / self.damper, 0.0  # type: ignore[attr-defined]
        return self.series * q / self.damper / (K + self.series), Vh / (K + self.series)

    def _viscous(self, force: float, q: float, slack: bool, speed: float) -> tuple[float, float, float, float]:
        """The force at the end of a muscle, the rate of the viscous spring's, power lost and energy stored in it."""
        if not self.damper:
            return (0.0 if slack else force), 0.0, 0.0, 0.0
        if self.series is None:
            return (0.0 if slack else force + self.damper * speed), 0.0, self.damper * speed * speed, 0.0
        drag = self.series * (speed - q / self.damper)
        return (0.0 if slack else force + q), drag, q * q / self.damper, 0.5 * q * q / self.series


def _edges(chart: Mapped) -> tuple[float, float, float, float]:
    first, last = chart.pressures
    near = NEAR * (last - first)
    return first - near, first, last, last + near


def _without_rubber(chart: Mapped) -> float:
    """Air less braid volume [m^3] of a muscle, which does not change."""
    pressure = chart.pressures[0]
    h = 0.5 * sum(map(float, chart.lengths(pressure)))
    found = float(chart.air_volume(h, pressure)) - float(chart.at(h, pressure).volume)
    return found if math.isfinite(found) else 0.0
