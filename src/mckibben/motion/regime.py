"""The equations of motion of a rig: rates of its state, as long as its mode and the commands of its valves hold.

The state is x (length, or angle of a pulley), its speed, what was lost to friction and what was pushed in, and for each
muscle absolute pressure, temperature, its own length, force of the viscous spring, and mass taken from the supply, mass
given to the atmosphere, and enthalpy, heat and work so far. After these comes what the crossings of each muscle with
friction remember. The equations are on the page of motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import attrs

from mckibben.motion.crossings import rubbed
from mckibben.motion.flow import GAMMA, GAS, HEAT, mass_flow
from mckibben.motion.plant import Plant
from mckibben.units import Number

__all__ = ["FIRST", "PER", "Commanded", "Mode", "Rates", "Regime", "Seen"]

FIRST, PER = 4, 9
"""Place of the first muscle's numbers in the state, and how many each has."""
Commanded = Sequence[Callable[[Number], Number]]
"""The command of each muscle's valve by the time."""


class Seen(NamedTuple):
    """What is to be seen of one muscle at one time, SI."""

    length: Number
    speed: Number
    force: Number  #: what its end pulls with, viscosity included
    pressure: Number  #: gauge
    temperature: Number
    mass: Number
    inflow: Number  #: from the supply [kg/s]
    outflow: Number  #: to the atmosphere
    command: Number
    volume: Number  #: of the air, tube included
    stored: Number  #: energy stored in the muscle, its viscous spring included
    inside: Any
    slack: Any


class Rates(NamedTuple):
    """Rates of the state, and what is seen on the way."""

    state: list[Number]
    muscles: list[Seen]
    push: Number  #: resultant along x without friction [N, or N m]


@attrs.frozen
class Mode:
    """How a rig moves: "free", "stuck" by friction, or at a stop, "low" or "high"; and which muscles are slack."""

    moves: str = "free"
    sliding: float = 0.0
    slack: tuple[bool, ...] = (False, False)


@attrs.frozen
class Regime:
    """How a rig moves for some time: its mode, and the commands of its valves."""

    plant: Plant
    mode: Mode
    commands: Commanded

    @classmethod
    def closed(cls, plant: Plant, mode: Mode | None = None) -> Regime:
        """All valves closed; free to move unless told otherwise."""
        return cls(plant, mode or Mode(), [lambda t: 0.0] * plant.n)

    def outside(self, t: Number) -> Number:
        """Force or torque from outside along x at a time."""
        plant = self.plant
        return 0.0 if plant.outer is None else plant.sense * float(plant.outer(t))

    def rates(self, t: Number, y: Sequence[Number]) -> Rates:
        """Rates of the state at a time."""
        plant, mode = self.plant, self.mode
        x, v = y[0], self._speed(y)
        outer = self.outside(t)
        push = plant.weight + outer - plant.damping * v - plant.spring * (x - plant.rest)
        lost = plant.damping * v * v + self._slid(v)
        state, muscles, kept = [v, 0.0, lost, outer * v], list[Seen](), list[Number]()
        for k, command in enumerate(self.commands):
            part, seen, warmed = self._muscle(k, command(t), y, x, v, mode.slack[k])
            if k in plant.rubs:
                seen, rate, heat = self._rubbed(k, part, seen, y[FIRST + PER * plant.n + len(kept)])
                kept.append(rate)
                warmed += heat
            push -= plant.ratios[k] * seen.force
            state[2] += warmed
            state += part
            muscles.append(seen)
        state[1] = self._acceleration(push)
        return Rates(state + kept, muscles, push)

    def _speed(self, y: Sequence[Number]) -> Number:
        """Rate of x."""
        return y[1] if self.mode.moves == "free" and not self.plant.rig.fixed else 0.0

    def _slid(self, v: Number) -> Number:
        """Power lost to the friction of the load."""
        return self.plant.friction * abs(v)

    def _acceleration(self, push: Number) -> Number:
        """Rate of the speed."""
        plant, mode = self.plant, self.mode
        if mode.moves != "free" or plant.rig.fixed:
            return 0.0
        return (push - mode.sliding * plant.friction) / plant.mass

    def _on_edge(self, k: int, P: Number) -> Number:
        """A gauge pressure as a map is asked for it: one just beyond its pressures counts as on their edge."""
        low, first, last, high = self.plant.edges[k]
        return first if low < P < first else last if last < P < high else P

    def _rubbed(self, k: int, part: list[Number], seen: Seen, e: Number) -> tuple[Seen, float, float]:
        """A muscle's numbers with the friction at its crossings: what is seen, the rate of e, and heat."""
        plant = self.plant
        P = self._on_edge(k, seen.pressure)
        found = rubbed(plant.rubs[k], seen.length, P, seen.speed, part[0], e)
        part[8] -= found.force * seen.speed
        seen = seen._replace(force=seen.force + found.force, stored=seen.stored + found.stored)
        return seen, found.rate, found.lost

    def _muscle(
        self, k: int, u: Number, y: Sequence[Number], x: Number, v: Number, slack: Any
    ) -> tuple[list[Number], Seen, Number]:
        """Rates of one muscle's numbers, what is seen of it, and what its rubber turns into heat."""
        plant = self.plant
        p, T, own, q = y[FIRST + PER * k : FIRST + PER * k + 4]
        h = own if slack else plant.offsets[k] + plant.ratios[k] * x
        P = self._on_edge(k, p - plant.atmosphere)
        found = plant.ats[k](h, P)
        Vh, VP = found.volume_by_length, found.volume_by_pressure
        V = found.volume + plant.dead[k]
        inflow, outflow, carried, heat_rate = self._air(k, u, p, T)
        a = heat_rate + plant.exponent * GAS * carried
        alpha, beta = self._lengthening(found, q, slack, plant.ratios[k] * v)
        rate = (a - plant.exponent * p * Vh * alpha) / (V + plant.exponent * p * (VP + Vh * beta))
        speed = alpha + beta * rate
        volume_rate = Vh * speed + VP * rate
        m = p * V / (GAS * T)
        net = inflow - outflow
        warming = 0.0 if plant.isothermal else T * (rate / p + volume_rate / V - net / m)
        enthalpy = HEAT * (carried if not plant.isothermal else self._carried(k, inflow, outflow, T))
        heat = (rate * V + p * volume_rate) / (GAMMA - 1.0) - enthalpy + p * volume_rate
        force, drag, rubbed, stored = self._viscous(found.force, q, slack, speed)
        stored += found.potential + P * found.volume
        state = [rate, warming, speed, drag, inflow, outflow, enthalpy, heat, -force * speed]
        return state, Seen(h, speed, force, p - plant.atmosphere, T, m, inflow, outflow, u, V, stored,
                           found.inside, slack), rubbed  # fmt: skip

    def _air(self, k: int, u: Number, p: Number, T: Number) -> tuple[Number, Number, Number, Number]:
        """Mass flows in and out, flow times temperature carried in, and pressure times volume by heat from the wall."""
        plant = self.plant
        C, vent, b = plant.valves[k]
        inflow = outflow = 0.0
        if u > 0.0:
            back = p > plant.supplied
            inflow = (
                -mass_flow(C * u, b, p, T, plant.supplied)
                if back
                else mass_flow(C * u, b, plant.supplied, plant.source, p)
            )
        elif u < 0.0:
            back = p < plant.atmosphere
            outflow = (
                -mass_flow(-vent * u, b, plant.atmosphere, plant.around, p)
                if back
                else mass_flow(-vent * u, b, p, T, plant.atmosphere)
            )
        if plant.isothermal:
            return inflow, outflow, (inflow - outflow) * T, 0.0
        return inflow, outflow, self._carried(k, inflow, outflow, T), self._from_wall(T)

    def _from_wall(self, T: Number) -> Number:
        """Pressure times volume that the heat from the wall gives the air in a second."""
        return (GAMMA - 1.0) * self.plant.wall * (self.plant.around - T)

    def _carried(self, k: int, inflow: Number, outflow: Number, T: Number) -> Number:
        """Flow times the temperature that it brings or takes."""
        plant = self.plant
        return inflow * (plant.source if inflow > 0.0 else T) - outflow * (T if outflow > 0.0 else plant.around)

    def _lengthening(self, found: object, q: Number, slack: Any, speed: Number) -> tuple[Number, Number]:
        """The speed of the muscle as alpha + beta times the rate of its pressure; a slack one stays without force."""
        plant = self.plant
        if not slack:
            return speed, 0.0
        K, Vh = found.stiffness, found.volume_by_length  # type: ignore[attr-defined]
        if plant.damper is None:
            return 0.0, Vh / K
        if plant.series is None:
            return -found.force / plant.damper, 0.0  # type: ignore[attr-defined]
        return plant.series * q / plant.damper / (K + plant.series), Vh / (K + plant.series)

    def _viscous(self, force: Number, q: Number, slack: Any, speed: Number) -> tuple[Number, Number, Number, Number]:
        """The force at the end of a muscle, the rate of the viscous spring's, power lost and energy stored in it."""
        plant = self.plant
        if plant.damper is None:
            return (0.0 if slack else force), 0.0, 0.0, 0.0
        if plant.series is None:
            return (0.0 if slack else force + plant.damper * speed), 0.0, plant.damper * speed * speed, 0.0
        drag = plant.series * (speed - q / plant.damper)
        return (0.0 if slack else force + q), drag, q * q / plant.damper, 0.5 * q * q / plant.series
