"""The fittings of a muscle, where they are not rigid."""

from __future__ import annotations

from mckibben.spec.declared import Reads
from mckibben.spec.fields import quantity, spec

__all__ = ["Fittings"]


@spec("fittings")
class Fittings:
    """Fittings and mounting that give way like a spring in series with the braid.

    The length of the muscle is then that of the braid and what the fittings give way, h + C F. So a muscle loses force
    with length: measured Festo muscles of one diameter lose 30 % from 382 to 83 mm, which no rigid fitting explains
    (theory page). Energy C F^2/2 is stored in them.

    Args:
        compliance: C of both fittings together [m/N], above 0: hold the muscle, pull, and divide what the fittings move
            by the force.

    Raises:
        SpecError: for a compliance out of range.

    >>> muscle = mk.presets.paper().replace("fittings", mk.Fittings(compliance="0.01 mm/N"))
    >>> round(mk.solve(muscle, length="115 mm", pressure="1 bar").force, 2)  # N; 101.22 N with rigid fittings
    96.74
    """

    compliance: Reads[float] = quantity(
        "m/N", meaning="compliance of both fittings together, in series with the braid", low=0.0, low_open=True,
        size=(1e-12, 1.0), source="theory page, fittings that give way",
    )  # fmt: skip
