"""`Place`: a state at which a measure looks at a muscle."""

from __future__ import annotations

from enum import StrEnum

import attrs

__all__ = ["By", "Place"]


class By(StrEnum):
    """What holds the muscle at a place, beside the pressure."""

    CONTRACTION = "contraction"
    LENGTH = "length"
    SHARE = "share"  # of the contraction that the muscle reaches freely at this pressure
    FORCE = "force"


@attrs.frozen
class Place:
    """One state of every design: a pressure [Pa], and a contraction, a length [m], a share or a force [N]."""

    pressure: float
    by: By
    at: float
    pull: float | None = None  #: force [N] for which the pressure is sought, up to the one given
