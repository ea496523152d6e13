"""`Rig`: one muscle or two, what they move, where their air comes from, and who commands the valves."""

from __future__ import annotations

from typing import Any

from mckibben.spec.air import AIRS, Isothermal, Polytropic, Supply, Valve, WallHeat, temperature_field
from mckibben.spec.constants import ATMOSPHERE, HEAT_RATIO
from mckibben.spec.controls import CONTROLS, PID, Controlled, Controller
from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import part, quantity, spec
from mckibben.spec.loads import LOADS, FixedEnd, Load, Pulley, Viscosity
from mckibben.spec.muscle import Muscle
from mckibben.spec.plausible import CONTROLLED
from mckibben.spec.signal import Signal
from mckibben.spec.signals import SIGNALS, resolved
from mckibben.units import Number, is_traced, show

__all__ = ["Rig"]


def _read_command(value: Any, field: str, declared: Declared) -> Any:
    if isinstance(value, (PID, Controller)):
        return value
    if isinstance(value, Signal):
        return resolved(value, "1", field, -1.0, 1.0)
    if (isinstance(value, (int, float)) and not isinstance(value, bool)) or is_traced(value):
        from mckibben.spec.signal import Constant

        try:
            return resolved(Constant(value), "1", field, -1.0, 1.0)
        except SpecError as error:
            raise SpecError(field, value, error.allowed, error.advice) from error
    names = ", ".join(cls.__name__ for cls in (*SIGNALS.values(), *CONTROLS.values()))
    raise SpecError(field, value, f"must be a number from -1 to 1, or one of {names}", "such as mk.Jump(1.0)")


def _command(meaning: str) -> Any:
    kinds = (*SIGNALS.values(), *CONTROLS.values())
    return declare(
        Declared(kind="signal", read=_read_command, meaning=meaning, default=None, unit="1", low=-1.0, high=1.0,
                 parts=kinds)
    )  # fmt: skip


def _gauge(meaning: str, **about: Any) -> Any:
    return quantity("Pa", meaning=meaning, low=-0.9e5, high=1e8, doubt=CONTROLLED["Pa"], **about)


@spec("rig")
class Rig:
    """What `simulate` sets in motion: muscle, load, supply, valve, and the command of the valve over time.

    Args:
        muscle: the muscle; with friction at its crossings only where nothing goes slack.
        load: `FixedEnd` (isometric), `Load` (a mass on a line) or `Pulley`.
        supply: where the air comes from.
        valve: through what it goes.
        command: of the valve, from -1 (vent) over 0 (closed) to 1 (fill): a number, a signal (`Jump`, `Ramp`, `Sine`,
            `PWM`, `Series`), a `PID` or a `Controller`.
        antagonist: a second muscle on the same pulley, which pulls the other way.
        antagonist_valve: its valve, where it is another.
        antagonist_command: its command; the negative of the first one where it is left out.
        air: what the air does with its heat: `Isothermal`, `Polytropic` or `WallHeat`.
        tube: volume [m^3] between valve and muscle, of each muscle.
        viscosity: what the rubber adds when a muscle moves.
        pressure: gauge pressure at the start [Pa].
        antagonist_pressure: that of the second muscle, where it is another.
        temperature: around the rig [K], and of the air at the start.
        atmosphere: pressure around the rig [Pa].

    Raises:
        SpecError: for a rig without air (no supply or no valve), a supply at or below the atmosphere, or parts that
            do not go together.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.Load(mass="2 kg", damping="20 N s/m"),
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.05 L/s/bar", b=0.3), command=mk.Jump(1.0, at="0.1 s"),
    ... )
    >>> rig.load.mass, rig.command(0.2)
    (2.0, 1.0)
    """

    muscle: Muscle = part(Muscle, meaning="the muscle")
    load: Any = part(*LOADS.values(), meaning="what it moves")
    supply: Supply | None = part(Supply, meaning="where its air comes from", default=None)
    valve: Valve | None = part(Valve, meaning="through what the air goes", default=None)
    command: Any = _command("command of the valve, from -1 (vent) to 1 (fill); 0")
    antagonist: Muscle | None = part(Muscle, meaning="second muscle, which pulls the other way", default=None)
    antagonist_valve: Valve | None = part(Valve, meaning="its valve, where it is another", default=None)
    antagonist_command: Any = _command("its command; the negative of the first one")
    air: Any = part(*AIRS.values(), meaning="what the air does with its heat", default=Isothermal())
    tube: Reads[float] = quantity(
        "m^3", meaning="volume between valve and muscle", low=0.0, high=1.0, doubt=(0.5, 1e6), default=0.0
    )
    viscosity: Viscosity | None = part(Viscosity, meaning="what rubber adds when it moves", default=None)
    pressure: Reads[float] = _gauge("gauge pressure at the start", default=0.0)
    antagonist_pressure: Reads[float | None] = _gauge("that of the second muscle, where it is another", default=None)
    temperature: Reads[float] = temperature_field("temperature around the rig")
    atmosphere: Reads[float] = quantity(
        "Pa", meaning="pressure around the rig", low=1e4, high=2e5, default=ATMOSPHERE, doubt=CONTROLLED["Pa"]
    )

    def __attrs_post_init__(self) -> None:
        for name, advice in (("supply", 'mk.Supply(gauge="6 bar")'), ("valve", 'mk.Valve(C="0.3 L/s/bar", b=0.3)')):
            if getattr(self, name) is None:
                raise SpecError(
                    f"rig.{name}", allowed="is missing: a rig without air does not move", advice=f"such as {advice}"
                )
        for name, muscle in (("muscle", self.muscle), ("antagonist", self.antagonist)):
            if muscle is not None and muscle.friction is not None and getattr(self.load, "slack", False):
                said = "does not go with slack = true: where a slack muscle has no force depends on the path"
                raise SpecError(
                    f"{name}.friction", allowed=said, advice=f'leave it out: {name}.replace("friction", None)'
                )
        if self.antagonist is not None and not isinstance(self.load, Pulley):
            said = f"two muscles need a pulley, not {type(self.load).__name__}"
            raise SpecError("rig.load", allowed=said, advice='such as mk.Pulley(radius="20 mm", inertia="1e-3 kg m^2")')
        for name in ("antagonist_valve", "antagonist_command", "antagonist_pressure"):
            if self.antagonist is None and getattr(self, name) is not None:
                raise SpecError(f"rig.{name}", allowed="is given without an antagonist", advice="give rig.antagonist")
        self.supplied  # noqa: B018  # absolute and gauge mixed up are found here
        for command in (self.command, self.antagonist_command):
            if isinstance(command, PID) and command.of == Controlled.ANGLE and not isinstance(self.load, Pulley):
                raise SpecError("pid.of", "angle", "is that of a pulley", "hold the length instead")
        for name in ("pressure", "antagonist_pressure"):
            start = getattr(self, name)
            if start is None or any(is_traced(one) for one in (start, self.atmosphere, self.supplied)):
                continue
            if start + self.atmosphere > self.supplied * (1.0 + 1e-9):
                said = f"must be at most that of the supply, {show(self.supplied - self.atmosphere, 'Pa', 5)} gauge"
                raise SpecError(f"rig.{name}", show(start, "Pa"), said, "pressures of a muscle are gauge")

    @property
    def supplied(self) -> Number:
        """Absolute pressure of the supply [Pa]."""
        assert self.supply is not None
        return self.supply.over(self.atmosphere)

    @property
    def muscles(self) -> tuple[Muscle, ...]:
        """The muscle, and the second one where there is one."""
        return (self.muscle,) if self.antagonist is None else (self.muscle, self.antagonist)

    @property
    def valves(self) -> tuple[Valve, ...]:
        """The valve of each muscle."""
        assert self.valve is not None
        return (self.valve, self.antagonist_valve or self.valve)[: len(self.muscles)]

    @property
    def pressures(self) -> tuple[Number, ...]:
        """Gauge pressure of each muscle at the start [Pa]."""
        second = self.pressure if self.antagonist_pressure is None else self.antagonist_pressure
        return (self.pressure, second)[: len(self.muscles)]

    @property
    def fixed(self) -> bool:
        """Whether nothing moves but air."""
        return isinstance(self.load, FixedEnd)

    @property
    def turns(self) -> bool:
        """Whether a pulley turns."""
        return isinstance(self.load, Pulley)

    @property
    def mass(self) -> Number:
        """Mass [kg] or moment of inertia [kg m^2]; 0 where nothing moves."""
        return self.load.mass if isinstance(self.load, Load) else self.load.inertia if self.turns else 0.0

    @property
    def exponent(self) -> Number:
        """Exponent n of the balance of energy of the air."""
        return self.air.n if isinstance(self.air, Polytropic) else HEAT_RATIO if isinstance(self.air, WallHeat) else 1.0
