"""Text or pint quantity <-> SI float, and how numbers are shown. All knowledge of units is here.

Inside the package every number is SI (m, N, Pa, rad, m^3, N m^2). A bare number is taken as SI; text needs its
unit ("12.5 mm"), except a plain zero. Units are looked up in one cached pint registry, imported on first use; the
usual units need none of it.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import lru_cache
from numbers import Real
from typing import Any, TypeAlias

import numpy as np

__all__ = [
    "DISPLAY",
    "Number",
    "Quantity",
    "UnitError",
    "from_si",
    "is_traced",
    "is_unit",
    "scaled",
    "show",
    "split",
    "to_si",
]

Quantity: TypeAlias = Any
"""What a user may give as a number: an SI float, text with a unit, or a pint quantity."""

Number: TypeAlias = Any
"""An SI float, or the JAX array or tracer that takes its place while JAX differentiates or compiles."""

DISPLAY = {
    "m": "mm", "Pa": "bar", "rad": "deg", "m^3": "mL", "N m^2": "N mm^2", "N m": "N mm", "J": "mJ", "m/N": "mm/N",
    "m^3/s/Pa": "L/s/bar", "Pa/m": "MPa/mm",
}  # fmt: skip
"""The unit each SI unit is shown in, where it is not itself."""

_USUAL = {
    "m": ("m", 1.0), "mm": ("m", 1e-3), "cm": ("m", 1e-2), "um": ("m", 1e-6),
    "Pa": ("Pa", 1.0), "kPa": ("Pa", 1e3), "MPa": ("Pa", 1e6), "GPa": ("Pa", 1e9), "bar": ("Pa", 1e5),
    "rad": ("rad", 1.0), "deg": ("rad", math.pi / 180.0), "N": ("N", 1.0), "mN": ("N", 1e-3), "kN": ("N", 1e3),
    "m^3": ("m^3", 1.0), "mL": ("m^3", 1e-6), "N m^2": ("N m^2", 1.0), "N mm^2": ("N m^2", 1e-6),
    "N m": ("N m", 1.0), "N mm": ("N m", 1e-3), "J": ("J", 1.0), "mJ": ("J", 1e-3),
}  # fmt: skip
"""The usual units with their SI unit and factor, which need no pint; a test compares them with pint's."""

_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.DOTALL)
_COMMA = re.compile(r",(\d+)\s*(.*)", re.DOTALL)
"""What follows the digits before a decimal comma: "12,5 mm"."""
# Only names, one-digit powers and separators reach pint, whose own reader would evaluate any arithmetic ("9**9**9").
_WORD = r"[A-Za-zµμ]+(?: ?(?:\^|\*\*) ?-?\d)?"
_UNIT = re.compile(rf"(?:1 ?/ ?)?{_WORD}(?:(?: ?[*/] ?| ){_WORD})*")


class UnitError(ValueError):
    """A value cannot be read as a number in the wanted unit. The message says what is wrong, `advice` what to write."""

    def __init__(self, problem: str, advice: str = "") -> None:
        super().__init__(problem)
        self.advice = advice


def is_traced(value: object) -> bool:
    """True for JAX arrays and tracers. They are SI numbers already, and are neither read nor checked."""
    return hasattr(value, "aval")


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint  # here, because importing pint takes as long as everything else together

    return pint.UnitRegistry()


@lru_cache(maxsize=512)
def _factor(unit: str, wanted: str) -> float:
    """Factor from `unit` to the SI unit `wanted`; UnitError when unknown or of another kind."""
    clean = unit.replace("°", "deg").replace("·", " ").replace("²", "^2").replace("³", "^3").replace("⁴", "^4")
    clean = re.sub(r"/ ?\(([^()]*)\)", _divided, re.sub(r"\s+", " ", clean)).strip()
    example = f"write a unit of the same kind as {DISPLAY.get(wanted, wanted)}"
    if wanted == "1":
        if clean in ("", "dimensionless"):
            return 1.0
        if clean == "%":
            return 0.01
        raise UnitError("must be a plain number without a unit", f'leave out "{unit}"')
    if clean in _USUAL and wanted in _USUAL:
        kind, factor = _USUAL[clean]
        if kind == wanted:
            return factor
        raise UnitError(f'has the wrong kind of unit, "{_short(unit)}"', example)
    return _looked_up(clean, unit, wanted, example)


def _divided(found: re.Match[str]) -> str:
    """What brackets below a stroke hold, unit by unit: "/(s bar)" is "/s/bar"."""
    return "".join(f"/{word}" for word in re.split(r"[ *]+", found[1].strip()))


def _looked_up(clean: str, unit: str, wanted: str, example: str) -> float:
    """Factor from a unit to the SI unit `wanted`, looked up with pint."""
    if not _UNIT.fullmatch(clean):
        raise UnitError(f'has an unreadable unit "{_short(unit)}"', example)
    registry = _registry()
    try:
        scale, kind = registry.get_root_units(registry.parse_units(clean))
        wanted_scale, wanted_kind = registry.get_root_units(registry.parse_units(wanted))
    except Exception as error:  # pint raises many kinds for unknown, offset and malformed units
        raise UnitError(f'has an unknown unit "{_short(unit)}"', example) from error
    # Root units and not dimensions are compared: to pint an angle and a percentage have the same dimension.
    if kind != wanted_kind:
        raise UnitError(f'has the wrong kind of unit, "{_short(unit)}"', example)
    factor = float(scale) / float(wanted_scale)
    tidy = float(f"{factor:.10g}")  # decimal prefixes: 1e-6, not 9.999999999999999e-07
    return tidy if math.isclose(tidy, factor, rel_tol=1e-14) else factor


def _short(text: object, width: int = 40) -> str:
    line = " ".join(str(text).split())
    return line if len(line) <= width else line[: width - 3] + "..."


def _scaled(number: str, factor: float) -> float:
    """number * factor, correctly rounded for decimal factors so that "12.5 mm" is exactly 0.0125."""
    digits = repr(factor)
    if len(digits) <= 8:
        return float(Decimal(number) * Decimal(digits))
    return float(number) * factor


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise UnitError("must be a finite number")
    return value


def to_si(value: Quantity, unit: str) -> Number:
    """`value` as a float in the SI unit `unit` ("m", "N", "Pa", "rad", "m^3", "N m^2", "1").

    Numbers are taken as SI; text and pint quantities are converted. JAX arrays and tracers come back untouched.
    Raises UnitError for a wrong or missing unit, for true/false, NaN, infinity and anything that is no number.
    """
    if is_traced(value):
        return value
    if isinstance(value, str):
        return _from_text(value, unit)
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        units = format(value.units, "D")
        return _finite(_scaled(repr(to_si(value.magnitude, "1")), _factor(units, unit)))
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (Real, Decimal)):
        raise UnitError("must be a number", _example(unit))
    try:
        return _finite(float(value))
    except (OverflowError, ValueError) as error:
        raise UnitError("must be a finite number") from error


def split(text: str) -> tuple[str, str] | None:
    """The number and the unit (maybe empty) of a text, unread; None if it does not begin with a number."""
    found = _NUMBER.fullmatch(text.strip())
    return None if found is None else (found.group(1), found.group(2))


def _from_text(text: str, unit: str) -> float:
    found = split(text)
    if found is None:
        raise UnitError("must be a number", _example(unit))
    number, written = found
    comma = _COMMA.fullmatch(written)
    if comma:
        pointed = f"{number}.{comma[1]} {comma[2]}".rstrip()
        raise UnitError("has a comma in its number", f'write a decimal point: "{pointed}"')
    try:
        plain = float(number)
        if not written and unit != "1":
            if plain == 0.0:
                return 0.0
            raise UnitError("needs a unit", _example(unit))
        return _finite(_scaled(number, _factor(written, unit)))
    except (OverflowError, ArithmeticError) as error:
        raise UnitError("must be a finite number") from error


def _example(unit: str) -> str:
    examples = {"m": '"12.5 mm"', "Pa": '"1 bar"', "rad": '"37 deg"', "N": '"20 N"', "m^3": '"40 mL"'}
    examples |= {"N m^2": '"0.5 N mm^2"', "m/N": '"0.01 mm/N"', "1/m": '"20 1/m"', "1": "0.4"}
    return "write it like " + examples.get(unit, f'"1 {unit}"')


def scaled(values: Any, unit: str, wanted: str) -> Any:
    """An array of numbers in `unit` as numbers in the SI unit `wanted`; UnitError for a wrong or unknown unit.

    12.5 in mm is 0.0125 as text is: where the factor is one over a whole number, that number divides.
    """
    factor = _factor(unit, wanted)
    parts = round(1.0 / factor)
    return values / parts if parts > 1 and math.isclose(parts * factor, 1.0, rel_tol=1e-15) else values * factor


@lru_cache(maxsize=512)
def is_unit(text: str) -> bool:
    """Whether a text is the name of a unit: "mm", "%", "kg"; not an empty one."""
    clean = text.strip()
    if clean in _USUAL or clean == "%":
        return True
    try:
        return bool(_UNIT.fullmatch(clean)) and bool(_registry().parse_units(clean))
    except Exception:  # pint raises many kinds for unknown units
        return False


def from_si(value: Any, unit: str) -> Any:
    """An SI number or array in `unit`: from_si(0.0125, "mm") is 12.5."""
    return value if unit == "1" else value / _factor(unit, _si_of(unit))


_SI = (
    "m", "N", "Pa", "rad", "m^3", "N m^2", "J", "J/m", "1/m", "m^2", "N/m", "m/N", "kg", "kg/m^3", "J/kg", "s", "K",
    "1/s", "m/s", "rad/s", "m/s^2", "N s/m", "N m s", "kg m^2", "W/K", "kg/s", "m^3/s", "m^3/s/Pa",
    "Pa/m",
)  # fmt: skip
"""SI units of what the package knows."""


@lru_cache(maxsize=128)
def _si_of(unit: str) -> str:
    """The package's SI unit for the kind of `unit`."""
    if unit in _USUAL:
        return _USUAL[unit][0]
    for candidate in _SI:
        try:
            _factor(unit, candidate)
        except UnitError:
            continue
        return candidate
    raise UnitError(f'unknown unit "{_short(unit)}"')


def show(value: Any, unit: str, digits: int = 6) -> str:
    """An SI number as text for people: show(0.0125, "m") is "12.5 mm", show(3e9, "GPa") is "3 GPa".

    `unit` is the SI unit, shown as DISPLAY says, or the unit to show directly. The text reads back with `to_si`.
    """
    if is_traced(value):
        return repr(value)
    shown = DISPLAY.get(unit, unit)
    number = float(from_si(value, shown))
    text = f"{number + 0.0:.{digits}g}"
    return text if shown == "1" else f"{text} {shown}"
