"""What a muscle moves: nothing, a mass on a line, or a pulley; and what its rubber adds when it moves."""

from __future__ import annotations

from typing import Any, ClassVar

import attrs

from mckibben.spec.constants import GRAVITY
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, spec, switch
from mckibben.spec.plausible import CONTROLLED
from mckibben.spec.signals import signal_field
from mckibben.units import Number, is_traced, show

__all__ = ["LOADS", "FixedEnd", "Load", "Pulley", "Viscosity"]


def _length(meaning: str, **about: Any) -> Any:
    about = {"default": None} | about
    return quantity("m", meaning=meaning, low=0.0, low_open=True, size=(1e-6, 1e3), doubt=CONTROLLED["m"], **about)


def _positive(unit: str, meaning: str, **about: Any) -> Any:
    return quantity(unit, meaning=meaning, low=0.0, high=1e12, **about)


def _angle(meaning: str) -> Any:
    return quantity("rad", meaning=meaning, low=-100.0, high=100.0, default=None)


def _stops(owner: str, low: Number | None, high: Number | None, unit: str) -> None:
    if low is not None and high is not None and not (is_traced(low) or is_traced(high)) and not low < high:
        said = f"must be above the other end, {show(low, unit)}"
        raise SpecError(f"{owner}.stop_high", show(high, unit), said)


@spec("fixed")
class FixedEnd:
    """A muscle held at one length: nothing moves but air.

    Args:
        length: distance between the fittings [m].

    Raises:
        SpecError: for a length out of range.

    >>> mk.FixedEnd(length="100 mm").length
    0.1
    """

    kind: ClassVar[str] = "fixed"
    length: Reads[float] = _length("distance between the fittings", default=attrs.NOTHING)


@spec("load")
class Load:
    """A mass that hangs from the muscle, or slides on a line with it; with a spring, a damper, friction, end stops.

    What moves is the length h between the fittings: m h'' = m g + push - F - damping h' - spring (h - spring_at).

    Args:
        mass: the mass [kg].
        gravity: acceleration along the muscle that lengthens it [m/s^2]; 0 for a mass on a table.
        spring: stiffness of a spring beside the muscle [N/m], which pulls it towards `spring_at`.
        spring_at: length [m] at which the spring has no force; that at the start.
        damping: force per speed [N s/m].
        friction: force [N] of a sliding guide, whatever the speed (Coulomb).
        push: further force that lengthens the muscle [N]: a number or a signal.
        stop_low: shortest length [m]: an end stop, from which nothing bounces.
        stop_high: longest length [m].
        slack: the mass hangs on a cable, which does not push: the muscle goes slack instead.
        start: length at the start [m]; that of the equilibrium where it is left out.

    Raises:
        SpecError: for a value out of range, or end stops in the wrong order.

    >>> mk.Load(mass="5 kg", damping="20 N s/m").gravity
    9.80665
    """

    kind: ClassVar[str] = "load"
    mass: Reads[float] = quantity("kg", meaning="mass", low=0.0, low_open=True, high=1e6, size=(1e-9, 1e6))
    gravity: Reads[float] = quantity(
        "m/s^2", meaning="acceleration along the muscle that lengthens it", low=-1e4, high=1e4, default=GRAVITY
    )
    spring: Reads[float] = _positive("N/m", "stiffness of a spring beside the muscle", default=0.0)
    spring_at: Reads[float | None] = _length("length at which the spring has no force; that at the start")
    damping: Reads[float] = _positive("N s/m", "force per speed", default=0.0)
    friction: Reads[float] = _positive("N", "force of a sliding guide", default=0.0)
    push: Any = signal_field("N", "further force that lengthens the muscle")
    stop_low: Reads[float | None] = _length("shortest length, an end stop")
    stop_high: Reads[float | None] = _length("longest length, an end stop")
    slack: Reads[bool] = switch(meaning="the mass hangs on a cable, which does not push", default=False)
    start: Reads[float | None] = _length("length at the start; that of the equilibrium")

    def __attrs_post_init__(self) -> None:
        _stops("load", self.stop_low, self.stop_high, "m")


@spec("pulley")
class Pulley:
    """A pulley that muscles turn by cables: one against a spring, or two against each other.

    What moves is the angle q: inertia q'' = radius (F1 - F2) - damping q' - spring q - torque. The first muscle is
    shorter by radius times q than at angle 0, the second one longer.

    Args:
        radius: of the pulley [m].
        inertia: moment of inertia of all that turns [kg m^2].
        spring: torque per angle [N m] of a spring, without torque at angle 0.
        damping: torque per angular speed [N m s].
        friction: torque of the bearing [N m], whatever the speed (Coulomb).
        torque: torque against the first muscle [N m]: a number or a signal.
        length: length of each muscle at angle 0 [m]; as made where it is left out.
        antagonist_length: that of the second one, where it is another.
        stop_low: lowest angle [rad], an end stop.
        stop_high: highest angle [rad].
        slack: the cables do not push: a muscle goes slack instead.
        start: angle at the start [rad]; that of the equilibrium where it is left out.

    Raises:
        SpecError: for a value out of range, or end stops in the wrong order.

    >>> mk.Pulley(radius="20 mm", inertia="1e-3 kg m^2").radius
    0.02
    """

    kind: ClassVar[str] = "pulley"
    radius: Reads[float] = quantity(
        "m", meaning="radius of the pulley", low=0.0, low_open=True, size=(1e-6, 1e2), high=1e2, doubt=(1.0, 1e3)
    )
    inertia: Reads[float] = quantity(
        "kg m^2", meaning="moment of inertia", low=0.0, low_open=True, high=1e6, size=(1e-12, 1e6)
    )
    spring: Reads[float] = _positive("N m", "torque per angle of a spring", default=0.0)
    damping: Reads[float] = _positive("N m s", "torque per angular speed", default=0.0)
    friction: Reads[float] = _positive("N m", "torque of the bearing", default=0.0)
    torque: Any = signal_field("N m", "torque against the first muscle")
    length: Reads[float | None] = _length("length of each muscle at angle 0; as made")
    antagonist_length: Reads[float | None] = _length("that of the second one, where it is another")
    stop_low: Reads[float | None] = _angle("lowest angle, an end stop")
    stop_high: Reads[float | None] = _angle("highest angle, an end stop")
    slack: Reads[bool] = switch(meaning="the cables do not push", default=False)
    start: Reads[float | None] = _angle("angle at the start; that of the equilibrium")

    def __attrs_post_init__(self) -> None:
        _stops("pulley", self.stop_low, self.stop_high, "rad")


@spec("viscosity")
class Viscosity:
    """What rubber and braid add to the force when the muscle moves: a damper, alone or in series with a spring.

    Alone it is the model of Kelvin and Voigt, with a spring the standard linear solid: the force that a step of length
    adds fades with the time constant damping / stiffness. It acts beside the muscle of the map.

    Args:
        damping: force per speed [N s/m].
        stiffness: stiffness of the spring in series [N/m]; none where it is left out.

    Raises:
        SpecError: for a value out of range.

    >>> mk.Viscosity(damping="30 N s/m", stiffness="60 N/m").time
    0.5
    """

    damping: Reads[float] = quantity("N s/m", meaning="force per speed", low=0.0, low_open=True, high=1e9)
    stiffness: Reads[float | None] = quantity(
        "N/m", meaning="stiffness of the spring in series; none", low=0.0, low_open=True, high=1e12, default=None
    )

    @property
    def time(self) -> float:
        """Time constant by which the force fades [s]; 0 without a spring."""
        return 0.0 if self.stiffness is None else self.damping / self.stiffness


LOADS: dict[str, type] = {cls.kind: cls for cls in (FixedEnd, Load, Pulley)}
"""The loads by their words in files."""
