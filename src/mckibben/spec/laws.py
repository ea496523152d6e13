"""Constants of the hyperelastic laws of the chamber. The energies themselves are in `model/chamber.py`.

Energies are per unit reference volume [Pa] of an incompressible material with principal stretches l1, l2, l3;
I1, I2 are the usual invariants. Single constants may be zero or negative; the initial shear modulus must be positive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantities, quantity, spec
from mckibben.units import Number, UnitError, is_traced, show, to_si

__all__ = ["LAWS", "Constants", "CustomLaw", "Gent", "Law", "MooneyRivlin", "NeoHookean", "Ogden", "Yeoh"]

MODULI = (1e-3, 1e12)
"""Sizes of moduli that are computed [Pa]: from far below any gel to diamond."""
LARGEST = (0.0, MODULI[1])


def _check_modulus(field: str, modulus: Number, formula: str) -> None:
    """Raise unless the initial shear modulus is positive; traced numbers cannot be judged."""
    if not is_traced(modulus) and not modulus > 0.0:
        said = f"the initial shear modulus {formula} is {show(modulus, 'kPa')}: it must be above 0 kPa"
        raise SpecError(f"chamber.law.{field}", allowed=said)
    if not is_traced(modulus) and not MODULI[0] <= modulus <= 1e3 * MODULI[1]:
        low, high = (show(limit, "kPa") for limit in (MODULI[0], 1e3 * MODULI[1]))
        said = f"the initial shear modulus {formula} is {show(modulus, 'kPa')}, beyond what can be computed"
        raise SpecError(f"chamber.law.{field}", allowed=f"{said}: {low} to {high}", advice="check the units")


@spec("chamber.law")
class MooneyRivlin:
    """Mooney-Rivlin: c1 (I1 - 3) + c2 (I2 - 3); initial shear modulus 2 (c1 + c2).

    The paper's law (Eq. 25). I1 = l1^2 + l2^2 + l3^2 and I2 = l1^-2 + l2^-2 + l3^-2 in the principal stretches.

    Args:
        c1: factor of I1 - 3 [Pa]. A bare number is SI; text has its unit ("8.5 kPa").
        c2: factor of I2 - 3 [Pa], 0 by default. One of the two may be negative.

    Raises:
        SpecError: if the initial shear modulus is not above 0.

    >>> law = mk.MooneyRivlin(c1="8.5 kPa", c2="1.5 kPa")
    >>> law.shear_modulus
    20000.0
    """

    name: ClassVar[str] = "mooney-rivlin"
    c1: Reads[float] = quantity("Pa", display="kPa", meaning="factor of I1 - 3", source="Eqs. (20-28)", size=LARGEST)
    c2: Reads[float] = quantity(
        "Pa", display="kPa", meaning="factor of I2 - 3", source="Eqs. (20-28)", size=LARGEST, default=0.0
    )

    def __attrs_post_init__(self) -> None:
        _check_modulus("c1", self.shear_modulus, "2 (c1 + c2)")

    @property
    def shear_modulus(self) -> Number:
        return 2.0 * (self.c1 + self.c2)


@spec("chamber.law")
class NeoHookean:
    """Neo-Hookean: c1 (I1 - 3); initial shear modulus 2 c1.

    I1 = l1^2 + l2^2 + l3^2 in the principal stretches.

    Args:
        c1: factor of I1 - 3 [Pa], above 0: half the shear modulus, a sixth of Young's modulus.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> chamber = mk.Chamber(thickness="1 mm", law=mk.NeoHookean(c1="8.5 kPa"))
    >>> chamber.law.shear_modulus
    17000.0
    """

    name: ClassVar[str] = "neo-hookean"
    c1: Reads[float] = quantity("Pa", display="kPa", meaning="factor of I1 - 3", low=0.0, low_open=True, size=MODULI)

    @property
    def shear_modulus(self) -> Number:
        return 2.0 * self.c1


@spec("chamber.law")
class Yeoh:
    """Yeoh: c1 (I1 - 3) + c2 (I1 - 3)^2 + c3 (I1 - 3)^3; initial shear modulus 2 c1.

    I1 = l1^2 + l2^2 + l3^2 in the principal stretches. With c2 < 0 and c3 > 0 the rubber softens, then stiffens
    (Yeoh 1993).

    Args:
        c1: factor of I1 - 3 [Pa], above 0.
        c2: factor of (I1 - 3)^2 [Pa], 0 by default.
        c3: factor of (I1 - 3)^3 [Pa], 0 by default.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> law = mk.Yeoh(c1="60 kPa", c2="-2 kPa", c3="0.3 kPa")
    >>> law.shear_modulus
    120000.0
    """

    name: ClassVar[str] = "yeoh"
    c1: Reads[float] = quantity("Pa", display="kPa", meaning="factor of I1 - 3", low=0.0, low_open=True, size=MODULI)
    c2: Reads[float] = quantity("Pa", display="kPa", meaning="factor of (I1 - 3)^2", size=LARGEST, default=0.0)
    c3: Reads[float] = quantity("Pa", display="kPa", meaning="factor of (I1 - 3)^3", size=LARGEST, default=0.0)

    @property
    def shear_modulus(self) -> Number:
        return 2.0 * self.c1


@spec("chamber.law")
class Ogden:
    """Ogden: sum of mu_i/alpha_i (l1^a + l2^a + l3^a - 3), a = alpha_i; initial shear modulus sum(mu_i alpha_i)/2.

    l1, l2, l3 are the principal stretches (Ogden 1972). Some books write 2 mu_i/alpha_i^2 for mu_i/alpha_i: multiply
    their mu_i by 2/alpha_i.

    Args:
        mu: list of moduli mu_i [Pa], one for each term.
        alpha: list of exponents alpha_i, as many as mu, none of them 0.

    Raises:
        SpecError: if the lists are not equally long, an exponent is 0 or the initial shear modulus is not above 0.

    >>> law = mk.Ogden(mu=["130 kPa", "-15 kPa"], alpha=[1.3, -2.0])
    >>> law.shear_modulus
    99500.0
    """

    name: ClassVar[str] = "ogden"
    mu: Reads[tuple[float, ...]] = quantities("Pa", display="kPa", meaning="moduli mu_i", size=LARGEST)
    alpha: Reads[tuple[float, ...]] = quantities("1", meaning="exponents alpha_i, none zero", size=(1e-3, 100.0))

    def __attrs_post_init__(self) -> None:
        if len(self.mu) != len(self.alpha):
            said = f"must have as many numbers as mu ({len(self.mu)})"
            raise SpecError("chamber.law.alpha", self.alpha, said)
        for index, alpha in enumerate(self.alpha):
            if not is_traced(alpha) and alpha == 0.0:
                raise SpecError(f"chamber.law.alpha[{index}]", alpha, "must not be 0")
        _check_modulus("mu", self.shear_modulus, "sum(mu_i alpha_i)/2")

    @property
    def shear_modulus(self) -> Number:
        return 0.5 * sum(mu * alpha for mu, alpha in zip(self.mu, self.alpha, strict=True))


@spec("chamber.law")
class Gent:
    """Gent: -mu Jm/2 ln(1 - (I1 - 3)/Jm), defined while I1 - 3 < Jm; initial shear modulus mu.

    I1 = l1^2 + l2^2 + l3^2 in the principal stretches. The rubber locks, with a stress that grows without bound, as
    I1 - 3 comes close to Jm (Gent 1996).

    Args:
        mu: initial shear modulus [Pa], above 0.
        Jm: largest value of I1 - 3 (no unit), above 0.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> muscle = mk.presets.paper().replace("chamber.law", mk.Gent(mu="17 kPa", Jm=12))
    >>> muscle.chamber.law
    Gent(mu='17 kPa', Jm=12.0)
    """

    name: ClassVar[str] = "gent"
    mu: Reads[float] = quantity(
        "Pa", display="kPa", meaning="initial shear modulus", low=0.0, low_open=True, size=MODULI
    )
    Jm: Reads[float] = quantity(
        "1", meaning="limit of I1 - 3, chains stretched out", low=0.0, low_open=True, size=(1e-3, 1e9)
    )

    @property
    def shear_modulus(self) -> Number:
        return self.mu


class Constants(Mapping[str, Number]):
    """Named SI numbers that cannot change and compare by value, as a spec must."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Number]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: str) -> Number:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        return repr(self._items)


def _read_constants(value: Any, field: str, declared: Declared) -> Constants:
    if not isinstance(value, Mapping):
        raise SpecError(field, value, "must be a mapping from name to number", 'write constants={"a": 1.0}')
    read = {}
    for key, item in value.items():
        if not isinstance(key, str):
            raise SpecError(field, key, "must have text as names")
        try:
            # The unit of a user's own constant is not known here, so only bare SI numbers make sense.
            read[key] = to_si(item, "1")
        except UnitError as error:
            raise SpecError(f"{field}.{key}", item, str(error), "constants of a custom law are SI numbers") from error
    return Constants(read)


def _read_function(value: Any, field: str, declared: Declared) -> Any:
    if callable(value):
        return value
    raise SpecError(field, value, "must be a function of (l1, l2, l3, constants)", "it gives the energy density in Pa")


@spec("chamber.law")
class CustomLaw:
    """A law of the user's own: function(l1, l2, l3, constants) -> energy density [Pa], written with jax.numpy.

    Among the stretches with l1 l2 l3 = 1, the energy must be least, and zero, at l1 = l2 = l3 = 1. A muscle with such a
    law can be solved, varied and differentiated, but not written to a case file. docs/adding_a_law.md has an example
    that is solved, and says how a law becomes part of the package.

    Args:
        function: function of (l1, l2, l3, constants) that gives the energy per unit reference volume [Pa], where
            constants is a dict. JAX differentiates it twice: use jax.numpy in place of numpy, and no `if` on stretches.
        constants: named numbers in SI units, without text. They are what sweeps and sensitivities can vary; numbers
            written into the function are not.

    Raises:
        SpecError: if the function cannot be called, or a constant is not a bare number.

    >>> def neo_hookean(l1, l2, l3, constants):
    ...     return constants["c1"] * (l1**2 + l2**2 + l3**2 - 3.0)
    >>> law = mk.CustomLaw(neo_hookean, constants={"c1": 8.5e3})
    >>> law.function(1.0, 1.0, 1.0, law.constants)
    0.0
    """

    name: ClassVar[str] = "custom"
    function: Callable[..., Any] = declare(
        Declared(kind="function", read=_read_function, meaning="energy density [Pa] of (l1, l2, l3, constants)")
    )
    constants: Reads[Constants] = declare(
        Declared(kind="constants", read=_read_constants, meaning="named SI numbers handed to the function", default={})
    )


Law = MooneyRivlin | NeoHookean | Yeoh | Ogden | Gent | CustomLaw
LAWS: dict[str, type] = {law.name: law for law in (MooneyRivlin, NeoHookean, Yeoh, Ogden, Gent, CustomLaw)}
"""The laws by their name in files."""
