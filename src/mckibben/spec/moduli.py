"""Sizes of the moduli of laws, and the check that all laws share: a positive initial shear modulus."""

from __future__ import annotations

from mckibben.spec.errors import SpecError
from mckibben.units import Number, is_traced, show

__all__ = ["LARGEST", "MODULI", "check_modulus"]

MODULI = (1e-3, 1e12)
"""Sizes of moduli that are computed [Pa]: from far below any gel to diamond."""
LARGEST = (0.0, MODULI[1])


def check_modulus(field: str, modulus: Number, formula: str) -> None:
    """Raise unless the initial shear modulus is positive; traced numbers cannot be judged."""
    if not is_traced(modulus) and not modulus > 0.0:
        said = f"the initial shear modulus {formula} is {show(modulus, 'kPa')}: it must be above 0 kPa"
        raise SpecError(f"chamber.law.{field}", allowed=said)
    if not is_traced(modulus) and not MODULI[0] <= modulus <= 1e3 * MODULI[1]:
        low, high = (show(limit, "kPa") for limit in (MODULI[0], 1e3 * MODULI[1]))
        said = f"the initial shear modulus {formula} is {show(modulus, 'kPa')}, beyond what can be computed"
        raise SpecError(f"chamber.law.{field}", allowed=f"{said}: {low} to {high}", advice="check the units")
