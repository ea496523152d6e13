"""Constants of the hyperelastic laws of the chamber. The energies themselves are in `model/chamber.py`.

Energies are per unit reference volume [Pa] of an incompressible material with principal stretches l1, l2, l3;
I1, I2 are the usual invariants. Single constants may be zero or negative; the initial shear modulus must be positive.
"""

from __future__ import annotations

from typing import ClassVar

from mckibben.spec.bellows import Bellows
from mckibben.spec.custom import CustomLaw
from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantities, quantity, spec
from mckibben.spec.moduli import LARGEST, MODULI, check_modulus
from mckibben.spec.rubber import Rubber
from mckibben.units import Number, is_traced

__all__ = [
    "LAWS",
    "ArrudaBoyce",
    "Bellows",
    "CustomLaw",
    "Gent",
    "Law",
    "MooneyRivlin",
    "NeoHookean",
    "Ogden",
    "Rubber",
    "Yeoh",
]


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
        check_modulus("c1", self.shear_modulus, "2 (c1 + c2)")

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
        check_modulus("mu", self.shear_modulus, "sum(mu_i alpha_i)/2")

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


@spec("chamber.law")
class ArrudaBoyce:
    """Arruda-Boyce: mu sum of a_k (I1^k - 3^k)/lambda_m^(2k-2), k = 1 to 5: chains that lock near lambda_m.

    The eight-chain law (Arruda and Boyce 1993) with the usual series a = 1/2, 1/20, 11/1050, 19/7000, 519/673750, where
    I1 = l1^2 + l2^2 + l3^2 in the principal stretches. Its chains are stretched by sqrt(I1/3). The initial shear
    modulus mu0 is above mu, by 3/5/lambda_m^2 and smaller terms:

        mu0 = mu (1 + 3/(5 L^2) + 99/(175 L^4) + 513/(875 L^6) + 42039/(67375 L^8)),   L = lambda_m

    Five terms do not lock: against the chains' own law the stress is 0.5 % too low at 0.6 lambda_m, 10 % at 0.8 and
    34 % at 0.9, and it stays finite beyond. Take `Gent` where the rubber comes closer to its limit.

    Args:
        mu: modulus of the chains [Pa], above 0: below the initial shear modulus, by 2.4 % for lambda_m = 5.
        lambda_m: chain stretch sqrt(I1/3) at which the chains would lock (no unit), above 1.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> law = mk.ArrudaBoyce(mu="17 kPa", lambda_m=5)
    >>> round(law.shear_modulus)  # Pa
    17424
    """

    name: ClassVar[str] = "arruda-boyce"
    mu: Reads[float] = quantity(
        "Pa", display="kPa", meaning="modulus of the chains", low=0.0, low_open=True, size=MODULI
    )
    lambda_m: Reads[float] = quantity(
        "1", meaning="chain stretch at which chains lock", low=1.0, low_open=True, size=(1.0, 1e6)
    )

    @property
    def shear_modulus(self) -> Number:
        x = self.lambda_m**-2
        return self.mu * (1.0 + x * (3 / 5 + x * (99 / 175 + x * (513 / 875 + x * (42039 / 67375)))))


Law = MooneyRivlin | NeoHookean | Yeoh | Ogden | Gent | ArrudaBoyce | Rubber | Bellows | CustomLaw
LAWS: dict[str, type] = {
    law.name: law for law in (MooneyRivlin, NeoHookean, Yeoh, Ogden, Gent, ArrudaBoyce, Rubber, Bellows, CustomLaw)
}
"""The laws by their name in files."""
