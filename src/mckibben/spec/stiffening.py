"""Fibres that stiffen as they are bent and twisted: `Stiffening`."""

from __future__ import annotations

from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import count, quantity, spec

__all__ = ["Stiffening"]

_SOURCE = "theory page, fibres that stiffen"


@spec("stiffening")
class Stiffening:
    """Bending and twist whose energy grows faster than quadratically, as the paper's last sentence suggests.

    A strain x away from its stress-free value u0 (a curvature or a twist, Eqs. 14-18) meets the moment
    B x (1 + (x/c)^(n - 2)): that of the paper while x is small, twice as much at x = c.

    Args:
        curvature: the strain c at which the moment has doubled [1/m], above 0.
        exponent: n of the fastest growing term of the energy, even: 4 (default), 6, 8, 10 or 12.

    Raises:
        SpecError: for a value out of range, or an odd exponent.

    >>> fibre = mk.Fibre(diameter="0.25 mm", E="3 GPa", nu=0.4, stiffening=mk.Stiffening(curvature="20 1/m"))
    >>> muscle = mk.presets.paper().replace("braid.fibre", fibre)
    >>> round(mk.solve(muscle, length="55 mm", pressure=0.0).force, 2)  # N; -3.2 N of fibres that do not stiffen
    -3.82
    """

    curvature: Reads[float] = quantity(
        "1/m", meaning="strain at which a fibre's moment has doubled", low=0.0, low_open=True, size=(1e-6, 1e9),
        source=_SOURCE,
    )  # fmt: skip
    exponent: Reads[int] = count(
        meaning="exponent of the energy's fastest growing term; even", low=4, high=12, source=_SOURCE, default=4,
        static=True,
    )  # fmt: skip

    def __attrs_post_init__(self) -> None:
        if self.exponent % 2:
            raise SpecError("stiffening.exponent", self.exponent, "must be even", "4, 6, 8, 10 or 12")
