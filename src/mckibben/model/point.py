"""The state at a material point, by name: what every pointwise function of the mechanics takes.

A further field of the model is one more name here; it is None where an effect is off. A rate that is integrated along
the length takes a `Point` in which that integral, and what is integrated after it, is None: it must not depend on them.
"""

from typing import Any, NamedTuple

from mckibben.model.parameters import Number, Parameters

__all__ = ["Made", "Point", "made_angle"]


class Made(NamedTuple):
    """How the braid was made at a place, where that varies along its length."""

    angle: Any  #: braid angle theta0 [rad], an `angle.Known`
    rate: Any  #: its derivative theta0' by v [rad/m]


class Point(NamedTuple):
    """State at one material point, or at many: each part is a number or an array of one shape.

    Taking psi instead of the paper's theta' removes the square root of Eq. (12) and lets a bulge overhang its fitting.
    An angle may be an `angle.Known`, whose sine and cosine are at hand.
    """

    theta: Any  #: braid angle [rad] from the parallels
    psi: Any  #: slope angle of the meridian [rad]
    kappa: Any  #: its derivative psi' = d psi/dv [rad/m]
    stretch: Any = None  #: stretch lambda of the fibres; None where they do not stretch
    excess: Any = None  #: theta' beyond that of fibres that do not stretch in a braid of one angle [rad/m]
    roll: Any = None  #: angle phi [rad] by which a fibre's section turns about it; None where crossings hinder it
    roll_rate: Any = None  #: its derivative phi' = d phi/dv [rad/m]
    give: Any = None  #: by how much the fittings give way, over H0: the same at all points; None where they are rigid
    blown: Any = None  #: hoop stretch, of R0, of a chamber that may leave the braid; None where it never does
    slide: Any = None  #: how far along v [m] the chamber's rubber here was mounted from; None where it never slides
    slide_rate: Any = None  #: its derivative by v
    made: Any = None  #: how the braid was made here, a `Made`; None where it has one angle

    @classmethod
    def cylinder(cls, theta: Number) -> "Point":
        """The uniform cylinder at a braid angle [rad]: no slope, no curvature of the meridian."""
        return cls(theta, 0.0 * theta, 0.0 * theta)


def made_angle(at: Point, p: Parameters) -> Any:
    """Braid angle theta0 [rad] as made, at the place of a state: a number or `angle.Known`."""
    return p.theta0 if at.made is None else at.made.angle
