"""Where a muscle's air comes from and through what it goes: supply, valve, and what the air does with its heat."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from mckibben.spec.constants import HEAT_RATIO, ROOM_TEMPERATURE
from mckibben.spec.declared import Declared, Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, read_quantity, spec
from mckibben.spec.plausible import CONTROLLED
from mckibben.units import Number, is_traced, show

__all__ = ["AIRS", "Isothermal", "Polytropic", "Supply", "Valve", "WallHeat", "temperature_field"]

ZERO_CELSIUS = 273.15


def _read_temperature(value: Any, field: str, declared: Declared) -> Number:
    """Kelvin; degrees Celsius are no multiple of them, and read here."""
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        value = f"{value.magnitude} {value.units:D}"
    if isinstance(value, str):
        found = re.fullmatch(r"\s*([-+.\deE]+)\s*(?:degC|°\s?C|celsius|degree_Celsius)\s*", value)
        if found:
            return read_quantity(ZERO_CELSIUS + float(found[1]), field, declared)
        if re.search(r"degF|°\s?F|fahrenheit|degree_C", value, re.IGNORECASE):
            raise SpecError(field, value, "must be a temperature in K or degC", 'such as "20 degC"')
    return read_quantity(value, field, declared)


def temperature_field(meaning: str, default: Any = ROOM_TEMPERATURE) -> Any:
    advice = 'write it like "20 degC" or "293 K"'
    return quantity("K", meaning=meaning, low=150.0, high=600.0, read=_read_temperature, advice=advice, default=default)


@spec("supply")
class Supply:
    """Air of constant pressure that a valve lets in.

    Say which pressure you mean: gauge is what a manometer shows, absolute counts from vacuum.

    Args:
        gauge: gauge pressure [Pa]; or
        absolute: absolute pressure [Pa], above that of the atmosphere.
        temperature: of the air [K], or text such as "20 degC".

    Raises:
        SpecError: where both pressures or none are given, or one out of range.

    >>> mk.Supply(gauge="6 bar").gauge  # Pa
    600000.0
    """

    gauge: Reads[float | None] = quantity(
        "Pa", meaning="gauge pressure", low=0.0, low_open=True, high=1e8, default=None, doubt=CONTROLLED["Pa"]
    )
    absolute: Reads[float | None] = quantity(
        "Pa", meaning="absolute pressure, in place of gauge", low=0.0, low_open=True, high=1e8, default=None,
        doubt=CONTROLLED["Pa"],
    )  # fmt: skip
    temperature: Reads[float] = temperature_field("temperature of the air")

    def __attrs_post_init__(self) -> None:
        both = 'give either gauge="6 bar" (what a manometer shows) or absolute="7 bar"'
        if self.gauge is not None and self.absolute is not None:
            raise SpecError("supply", allowed="is given both as gauge and as absolute pressure", advice=both)
        if self.gauge is None and self.absolute is None:
            raise SpecError("supply", allowed="has no pressure", advice=both)

    def over(self, atmosphere: Number) -> Number:
        """Its absolute pressure [Pa]. SpecError where that is not above the atmosphere's [Pa]."""
        if self.gauge is not None:
            return self.gauge + atmosphere
        assert self.absolute is not None
        if not is_traced(self.absolute) and not is_traced(atmosphere) and not self.absolute > atmosphere:
            said = f"must be above the atmosphere, {show(atmosphere, 'Pa', 5)}: absolute pressures count from vacuum"
            raise SpecError("supply.absolute", show(self.absolute, "Pa"), said, "give gauge= if a manometer shows that")
        return self.absolute


@spec("valve")
class Valve:
    """A valve by ISO 6358: its sonic conductance, and the ratio of pressures below which the flow is choked.

    A command of 1 opens it from the supply to the muscle, -1 from the muscle to the atmosphere, 0 closes it; what is
    between opens it in part, in proportion.

    Args:
        C: sonic conductance [m^3/s/Pa] (at 1 bar and 20 degC), such as "0.3 L/s/bar". A nominal flow Qn in L/min
            (6 to 5 bar) is about 250 times C in L/s/bar where b is 0.3: `Valve.nominal`.
        b: critical ratio of absolute pressures, 0 to below 1; most valves have 0.2 to 0.5.
        vent: sonic conductance from the muscle to the atmosphere, where it is not C.
        delay: dead time [s] from a command to what the valve does.

    Raises:
        SpecError: for a conductance that is none, or b outside 0 to 1.

    >>> mk.Valve(C="0.3 L/s/bar", b=0.3).C  # m^3/s/Pa
    3e-09
    """

    C: Reads[float] = quantity(
        "m^3/s/Pa", meaning="sonic conductance", low=0.0, low_open=True, high=1e-3, size=(1e-15, 1e-3),
        source="ISO 6358",
    )  # fmt: skip
    b: Reads[float] = quantity(
        "1", meaning="critical ratio of pressures", low=0.0, high=1.0, high_open=True, default=0.3, source="ISO 6358"
    )
    vent: Reads[float | None] = quantity(
        "m^3/s/Pa", meaning="sonic conductance to the atmosphere; C", low=0.0, low_open=True, high=1e-3,
        size=(1e-15, 1e-3), default=None, source="ISO 6358",
    )  # fmt: skip
    delay: Reads[float] = quantity(
        "s", meaning="dead time from a command to what the valve does", low=0.0, high=1e3, default=0.0
    )

    @classmethod
    def nominal(cls, flow: Any, b: float = 0.3, **others: Any) -> Valve:
        """The valve with a nominal flow [m^3/s] as catalogues print it: air of 1 bar and 20 degC, from 6 to 5 bar.

        Args:
            flow: such as "350 L/min".
            b: critical ratio.
            others: `vent` and `delay`.

        >>> 1e8 * mk.Valve.nominal("350 L/min").C  # L/s/bar
        1.376...
        """
        declared = Declared(kind="quantity", meaning="nominal flow", read=read_quantity, unit="m^3/s", low=0.0,
                            low_open=True, high=1e3)  # fmt: skip
        read = read_quantity(flow, "valve.flow", declared)
        probe = cls(C=1e-9, b=b)
        ratio = (5e5 + 1e5) / (6e5 + 1e5)
        return cls(C=read / (7e5 * probe.share(ratio)), b=b, **others)

    def share(self, ratio: float) -> float:
        """Part of the choked flow that flows at a ratio of pressures from 0 to 1."""
        return 1.0 if ratio <= self.b else (1.0 - ((ratio - self.b) / (1.0 - self.b)) ** 2) ** 0.5

    @property
    def venting(self) -> Number:
        """Sonic conductance to the atmosphere [m^3/s/Pa]."""
        return self.C if self.vent is None else self.vent


@spec("isothermal")
class Isothermal:
    """Air that always has the temperature around it: slow changes, or much surface.

    >>> mk.Isothermal().kind
    'isothermal'
    """

    kind: ClassVar[str] = "isothermal"


@spec("polytropic")
class Polytropic:
    """Air that keeps p V^n while nothing flows: n = 1 gives it time for its heat, n = 1.4 none (adiabatic).

    What flows in and out goes by the same n in place of 1.4 in the balance of energy (theory page, motion).

    Args:
        n: exponent, 1 to 1.4.

    Raises:
        SpecError: for an exponent out of range.

    >>> mk.Polytropic(n=1.2).n
    1.2
    """

    kind: ClassVar[str] = "polytropic"
    n: Reads[float] = quantity("1", meaning="exponent", low=1.0, high=HEAT_RATIO, default=HEAT_RATIO)


@spec("wall_heat")
class WallHeat:
    """Air that gives its heat to the wall, which keeps the temperature around it.

    Args:
        conductance: heat transfer coefficient times the area [W/K].

    Raises:
        SpecError: for a value out of range.

    >>> mk.WallHeat(conductance="0.5 W/K").conductance
    0.5
    """

    kind: ClassVar[str] = "wall-heat"
    conductance: Reads[float] = quantity("W/K", meaning="heat transfer coefficient times area", low=0.0, high=1e6)


AIRS: dict[str, type] = {cls.kind: cls for cls in (Isothermal, Polytropic, WallHeat)}
"""What air does with its heat, by its word in files."""
