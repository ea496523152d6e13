"""Hyperelastic laws of the incompressible chamber: energy density [Pa] from three stretches, one plain function each.

A law is one value, the object of `spec.laws` with its constants, which rides inside the parameters. Each function may
use that the product of the stretches is 1. To add a law, see docs/adding_a_law.md.
"""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp

from mckibben.model.parameters import Number
from mckibben.spec.errors import SpecError
from mckibben.spec.laws import ArrudaBoyce, CustomLaw, Gent, MooneyRivlin, NeoHookean, Ogden, Yeoh

__all__ = ["LAWS", "energy_density"]


def mooney_rivlin(l1: Number, l2: Number, l3: Number, law: MooneyRivlin) -> Number:
    """c1 (I1 - 3) + c2 (I2 - 3) (the paper's, Eq. 25); shear modulus 2 (c1 + c2)."""
    return law.c1 * (l1**2 + l2**2 + l3**2 - 3.0) + law.c2 * (l1**-2 + l2**-2 + l3**-2 - 3.0)


def neo_hookean(l1: Number, l2: Number, l3: Number, law: NeoHookean) -> Number:
    """c1 (I1 - 3); shear modulus 2 c1."""
    return law.c1 * (l1**2 + l2**2 + l3**2 - 3.0)


def yeoh(l1: Number, l2: Number, l3: Number, law: Yeoh) -> Number:
    """c1 (I1 - 3) + c2 (I1 - 3)^2 + c3 (I1 - 3)^3 (Yeoh 1993); shear modulus 2 c1."""
    x = l1**2 + l2**2 + l3**2 - 3.0
    return x * (law.c1 + x * (law.c2 + x * law.c3))


def ogden(l1: Number, l2: Number, l3: Number, law: Ogden) -> Number:
    """Sum of mu_i/alpha_i (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3) (Ogden 1972); shear modulus sum mu_i alpha_i/2."""
    total = 0.0 * l1
    for mu, alpha in zip(law.mu, law.alpha, strict=True):
        total = total + mu / alpha * (l1**alpha + l2**alpha + l3**alpha - 3.0)
    return total


def gent(l1: Number, l2: Number, l3: Number, law: Gent) -> Number:
    """-mu Jm/2 ln(1 - (I1 - 3)/Jm) (Gent 1996): the chains lock at I1 - 3 = Jm; NaN beyond."""
    return -0.5 * law.mu * law.Jm * jnp.log1p(-(l1**2 + l2**2 + l3**2 - 3.0) / law.Jm)


EIGHT_CHAINS = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)
"""Of the energy of eight chains in I1/lambda_m^2 (Arruda and Boyce 1993)."""


def arruda_boyce(l1: Number, l2: Number, l3: Number, law: ArrudaBoyce) -> Number:
    """mu times the sum of a_k (I1^k - 3^k)/lambda_m^(2k-2), k = 1 to 5; the differences without cancellation."""
    first = l1**2 + l2**2 + l3**2
    total, difference, power, shrink = 0.0 * l1, 0.0 * l1, 1.0, 1.0
    for factor in EIGHT_CHAINS:
        difference = first * difference + power * (first - 3.0)  # I1^k - 3^k from the one before
        total = total + factor * shrink * difference
        power, shrink = 3.0 * power, shrink / law.lambda_m**2
    return law.mu * total


def custom(l1: Number, l2: Number, l3: Number, law: CustomLaw) -> Number:
    """The user's own function of the stretches and its named constants; SpecError where it fails."""
    try:
        return law.function(l1, l2, l3, dict(law.constants))
    except Exception as error:
        said = f"fails with {type(error).__name__}: {str(error).partition(chr(10))[0]}"
        advice = "write it with jax.numpy, and without `if` on the stretches"
        raise SpecError("chamber.law.function", allowed=said, advice=advice) from error


LAWS: dict[type, Callable[[Number, Number, Number, Any], Number]] = {
    MooneyRivlin: mooney_rivlin,
    NeoHookean: neo_hookean,
    Yeoh: yeoh,
    Ogden: ogden,
    Gent: gent,
    ArrudaBoyce: arruda_boyce,
    CustomLaw: custom,
}
"""The energy of each kind of law; `Rubber` is a `NeoHookean` by the time it is here."""


def energy_density(l1: Number, l2: Number, l3: Number, law: Any) -> Number:
    """Energy per unit reference volume [Pa] at three principal stretches; zero for the bare braid, without a law."""
    return 0.0 * l1 if law is None else LAWS[type(law)](l1, l2, l3, law)
