"""The fittings of a muscle, where they are more than two rigid planes: what they add in series with the braid."""

from __future__ import annotations

from mckibben.spec.declared import Reads
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import quantity, spec

__all__ = ["Fittings"]


@spec("fittings")
class Fittings:
    """What fittings and mounting add in series with the braid: a spring, a piece that does not contract, or both.

    The length h of the muscle is then that of the braid, what the fittings give way, and what lies dead under them,
    braid + C F + dead length. A contraction is of that whole, 1 - h/(H0 + dead length), as a lab measures it; the
    `length` of the braid stays H0. So a short muscle contracts less than a long one, and with a compliance it loses
    force: measured Festo muscles of one diameter lose 30 % from 382 to 83 mm (theory page). The spring stores C F^2/2;
    the dead length stores nothing, and its volume is not counted.

    Args:
        compliance: C of both fittings together [m/N], above 0: hold the muscle, pull, and divide what the fittings move
            by the force. Rigid where it is left out.
        dead_length: length of both fittings together that is measured with the muscle and neither contracts nor
            lengthens [m]; 0 where it is left out.

    Raises:
        SpecError: for a value out of range, or where neither is given.

    >>> muscle = mk.presets.paper().replace("fittings", mk.Fittings(compliance="0.01 mm/N"))
    >>> round(mk.solve(muscle, length="115 mm", pressure="1 bar").force, 2)  # N; 101.22 N with rigid fittings
    96.74
    >>> muscle = mk.presets.paper().replace("fittings", mk.Fittings(dead_length="7 mm"))
    >>> round(mk.solve(muscle, length="122 mm", pressure="1 bar").force, 2)  # N
    101.22
    """

    compliance: Reads[float | None] = quantity(
        "m/N", meaning="compliance of both fittings together, in series with the braid", low=0.0, low_open=True,
        size=(1e-12, 1.0), source="theory page, fittings that give way", default=None,
    )  # fmt: skip
    dead_length: Reads[float | None] = quantity(
        "m", meaning="length of both fittings together that does not contract", low=0.0, size=(1e-9, 1e3),
        source="theory page, dead length", default=None, doubt=(0.5, 1e3),
    )  # fmt: skip

    def __attrs_post_init__(self) -> None:
        if self.compliance is None and self.dead_length is None:
            raise SpecError("fittings", allowed="are given nothing", advice="give compliance, dead_length or both")
