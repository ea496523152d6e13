"""`textbook_force()`: the force of the textbook formulas on a muscle, to compare with."""

from typing import Any

import numpy as np

from mckibben.model.cylinder import cylinder_angle
from mckibben.model.parameters import parameters
from mckibben.model.textbook import virtual_work_force
from mckibben.spec import Muscle, SpecError
from mckibben.units import UnitError, to_si

__all__ = ["textbook_force"]


def textbook_force(muscle: Muscle, *, length: Any, pressure: Any) -> np.ndarray:
    """The force of the textbook formulas: a cylinder of inextensible fibres that stores no energy.

    Eq. (31) of the paper, Chou and Hannaford's formula and Tondu and Lopez's are one formula in three sets of
    variables: F = pi R0^2/cos^2(theta0) (3 sin^2(theta) - 1) P, with theta the braid angle at the length.

    Args:
        muscle: the specification, of which only the braid's radius, length and angle matter, and a dead length.
        length: distance between the fittings [m]: a number or text with a unit, or an array of numbers.
        pressure: gauge pressure [Pa], likewise; the two are broadcast.

    Returns:
        The force [N] as an array, positive where the muscle pulls its fittings together; NaN at a length that its
        fibres do not reach.

    Raises:
        SpecError: for what is no number of the right kind, and for a programmed braid.

    >>> muscle = mk.presets.paper()
    >>> curve = mk.run(muscle, mk.Isobaric(pressure="1 bar", length=["115 mm", "85 mm"]))
    >>> mk.textbook_force(muscle, length=curve.length, pressure=curve.pressure).round(2)  # N
    array([76.1 ,  6.66])
    >>> curve.force.round(2)  # by the model
    array([101.22,   6.66])
    """
    if muscle.braid.angle_profile is not None:
        said = "does not go with the textbook formulas, which know one braid angle"
        raise SpecError("braid.angle_profile", allowed=said, advice="compare a braid of one of its angles")
    p = parameters(muscle)
    h, P = np.broadcast_arrays(_numbers("length", length, "m"), _numbers("pressure", pressure, "Pa"))
    reached = p.active(h) * np.sin(float(p.theta0)) < float(p.H0)
    theta = cylinder_angle(np.where(reached, h, float(p.rest)), p)
    return np.where(reached, np.asarray(virtual_work_force(theta, P, p)), np.nan)


def _numbers(name: str, value: Any, unit: str) -> np.ndarray:
    """One number, with or without a unit, or an array of them in SI units."""
    try:
        if isinstance(value, (str, int, float)) or hasattr(value, "units"):
            return np.asarray(to_si(value, unit))
        return np.array([to_si(one, unit) for one in np.ravel(value)]).reshape(np.shape(value))
    except UnitError as error:
        raise SpecError(f"textbook_force.{name}", value, str(error), error.advice) from error
