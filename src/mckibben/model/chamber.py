"""Hyperelastic laws of the incompressible chamber, one plain function each: energy density [Pa] from three stretches.

Each law may use that the product of the stretches is 1.
"""

from .. import spec
from ..lazy import jnp
from .kinematics import stretches
from .parameters import Law, Number, Parameters


def mooney_rivlin(l1: Number, l2: Number, l3: Number, constants: tuple[Number, Number]) -> Number:
    """c1 (I1 - 3) + c2 (I2 - 3) (the paper's, Eq. 25); shear modulus 2 (c1 + c2)."""
    c1, c2 = constants
    return c1 * (l1**2 + l2**2 + l3**2 - 3.0) + c2 * (l1**-2 + l2**-2 + l3**-2 - 3.0)


def neo_hookean(l1: Number, l2: Number, l3: Number, constants: tuple[Number]) -> Number:
    """c1 (I1 - 3); shear modulus 2 c1."""
    return constants[0] * (l1**2 + l2**2 + l3**2 - 3.0)


def yeoh(l1: Number, l2: Number, l3: Number, constants: tuple[Number, Number, Number]) -> Number:
    """c1 (I1 - 3) + c2 (I1 - 3)^2 + c3 (I1 - 3)^3 (Yeoh 1993); shear modulus 2 c1."""
    c1, c2, c3 = constants
    x = l1**2 + l2**2 + l3**2 - 3.0
    return x * (c1 + x * (c2 + x * c3))


def ogden(l1: Number, l2: Number, l3: Number, constants: tuple[tuple[Number, ...], tuple[Number, ...]]) -> Number:
    """Sum of mu_i/alpha_i (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3) (Ogden 1972); shear modulus sum mu_i alpha_i/2."""
    total = 0.0 * l1
    for mu, alpha in zip(*constants, strict=True):
        total = total + mu / alpha * (l1**alpha + l2**alpha + l3**alpha - 3.0)
    return total


def gent(l1: Number, l2: Number, l3: Number, constants: tuple[Number, Number]) -> Number:
    """-mu Jm/2 ln(1 - (I1 - 3)/Jm) (Gent 1996): the chains lock at I1 - 3 = Jm; NaN beyond."""
    mu, Jm = constants
    return -0.5 * mu * Jm * jnp.log1p(-(l1**2 + l2**2 + l3**2 - 3.0) / Jm)


LAWS: dict[type, Law] = {
    spec.MooneyRivlin: mooney_rivlin,
    spec.NeoHookean: neo_hookean,
    spec.Yeoh: yeoh,
    spec.Ogden: ogden,
    spec.Gent: gent,
}


def no_chamber(l1: Number, l2: Number, l3: Number, constants: tuple[()]) -> Number:
    """The bare braid: no energy."""
    return 0.0 * l1


def law_of(muscle: "spec.Muscle") -> Law:
    """The function of the muscle's chamber law (static: another function means another compilation)."""
    if muscle.chamber is None:
        return no_chamber
    law = muscle.chamber.law
    return law.function if isinstance(law, spec.CustomLaw) else LAWS[type(law)]


def chamber_density(theta: Number, p: Parameters, law: Law) -> Number:
    """Energy of the chamber per unit v [J/m]: A0 psi(C) (Eq. 26)."""
    return p.A0 * law(*stretches(theta, p), p.law)
