"""What the fittings hold: `Ends`."""

from enum import StrEnum

__all__ = ["Ends"]


class Ends(StrEnum):
    """What the fittings hold: radius and slope (clamped), the radius only (pinned), nothing (free).

    With the braid angle theta and the slope angle psi of the wall, at both ends:

    CLAMPED: theta = theta0 and psi = 0; the fibres are built into the fitting. The default.
    PINNED: theta = theta0; the radius is held, the fibres swing freely.
    FREE: the radius is free. Away from the ends the muscle is the uniform cylinder of the textbooks.

    The words do as well: `ends="pinned"` is read as Ends.PINNED and compares equal to it. Another word is a SpecError.

    >>> muscle = mk.presets.paper().replace("ends", "pinned")
    >>> muscle.ends == mk.Ends.PINNED == "pinned"
    True
    """

    CLAMPED = "clamped"
    PINNED = "pinned"
    FREE = "free"
