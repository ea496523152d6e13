"""Words of signals and controllers: what is between two values, and what a controller looks at."""

from enum import StrEnum

__all__ = ["Between", "Seen"]


class Between(StrEnum):
    """What a series of values is between two times."""

    LINE = "line"
    HOLD = "hold"


class Seen(StrEnum):
    """What a controller holds at its target."""

    LENGTH = "length"
    ANGLE = "angle"
    FORCE = "force"
    PRESSURE = "pressure"
