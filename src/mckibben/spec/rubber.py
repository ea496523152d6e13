"""`Rubber`: a law for a start without test data, from one stiffness or from a durometer's reading."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, read_quantity, spec
from mckibben.units import Number, is_traced, show

__all__ = ["Rubber", "stiffness_of_shore"]

_SOURCE = "Gent 1958"
_READING = re.compile(
    r"(?:shore[\s-]*)?(?:(?P<lead>00|[a-z]+)[\s-]*)?(?P<number>[+-]?\d[\d.,]*)[\s-]*(?:shore[\s-]*)?(?P<tail>00|[a-z]+)?",
    re.IGNORECASE,
)
"""A hardness with its scale before or after it: "30A", "Shore A 30", "OO-30"."""
_MEASURE = 'hang a weight on a strip and give E instead (recipe "Rubber without test data")'


def stiffness_of_shore(shore: Number) -> Number:
    """Young's modulus [Pa] of a rubber by its Shore A hardness (Gent 1958)."""
    return 1e6 * 0.0981 * (56.0 + 7.62336 * shore) / (0.137505 * (254.0 - 2.54 * shore))


def _read_shore(value: Any, field: str, declared: Declared) -> Number:
    if not isinstance(value, str):
        return read_quantity(value, field, declared)
    found = _READING.fullmatch(value.strip())
    if found is None or [scale.upper() for scale in (found["lead"], found["tail"]) if scale] not in ([], ["A"]):
        said = 'must be a Shore A hardness, such as "30A": no other scale is turned into a stiffness'
        raise SpecError(field, value, said, _MEASURE)
    try:
        return read_quantity(found["number"], field, declared)
    except SpecError as error:  # it names the number alone
        raise SpecError(field, value, error.allowed, error.advice) from error


def _explained(shore: float) -> str:
    return f"{show(shore, '1')} A ({_estimate(shore)})"


def _estimate(shore: float) -> str:
    return f"E = {show(stiffness_of_shore(shore), 'MPa', 3)}, estimated by {_SOURCE}"


@spec("chamber.law")
class Rubber:
    """Rubber without test data: neo-Hookean with c1 = E/6, from Young's modulus E or from Shore A hardness.

    Give one of the two. E is that of small strains; the rubber is incompressible, so that its shear modulus is E/3.
    Without it, a durometer will do for a start, by the relation of Gent (1958, Rubber Chem. Technol. 31):

        E [MPa] = 0.0981 (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)),   S = shore

    That is an estimate: the muscle counts "chamber.law.shore" as `assumed`, and it is marked wherever such values show.
    How good it is depends on the rubber. Other relations in use differ: log10(E [MPa]) = 0.0235 S - 0.6403, which is
    quoted as Ruess's, gives the same within 10 % from 20 to 35 A, 1.4 times as much at 50 A and 1.9 times as much at
    80 A. A rubber whose chains lock early reads harder than its E (Qi, Joyce and Boyce 2003).

    Args:
        E: Young's modulus at small strain [Pa], above 0: "1 MPa".
        shore: hardness on Shore's scale A, from 20 to 80: "30A", "A30" or the bare number 30. Other scales (D, 00) are
            refused.

    Raises:
        SpecError: for a value out of range or without its unit, another scale, both of them or neither.

    >>> mk.Rubber(E="1.2 MPa").shear_modulus  # Pa
    400000.0
    >>> soft = mk.Rubber(shore="30A")
    >>> round(soft.youngs_modulus / 1e6, 2)  # MPa
    1.14
    >>> "chamber.law.shore" in mk.presets.paper().replace("chamber.law", soft).assumed
    True
    """

    name: ClassVar[str] = "rubber"
    E: Reads[float | None] = quantity(
        "Pa", display="MPa", meaning="Young's modulus", low=0.0, low_open=True, size=(1e2, 1e12), default=None
    )
    shore: Reads[float | None] = quantity(
        "1", meaning="Shore A hardness, from which E is estimated", low=20.0, high=80.0, source=_SOURCE,
        advice=f"outside that range, {_MEASURE}", default=None, explain=_explained, read=_read_shore,
    )  # fmt: skip

    def __attrs_post_init__(self) -> None:
        if self.E is not None and self.shore is not None:
            raise SpecError("chamber.law", allowed="both E and shore are given", advice="give one of them")
        if self.E is None and self.shore is None:
            said, advice = "neither E nor shore is given", 'give E = "1 MPa" or shore = "30A", with your own number'
            raise SpecError("chamber.law", allowed=said, advice=advice)

    def __remark__(self) -> str:
        """The stiffness that a hardness stands for."""
        return "" if self.shore is None or is_traced(self.shore) else _estimate(self.shore)

    @property
    def estimated(self) -> tuple[str, ...]:
        """Names of the fields that a muscle marks as assumed whatever its maker says."""
        return () if self.shore is None else ("shore",)

    @property
    def youngs_modulus(self) -> Number:
        return stiffness_of_shore(self.shore) if self.E is None else self.E

    @property
    def c1(self) -> Number:
        """The constant of the neo-Hookean law that this is."""
        return self.youngs_modulus / 6.0

    @property
    def shear_modulus(self) -> Number:
        return 2.0 * self.c1
