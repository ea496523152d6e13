"""How the fibres of a braid as made wind around it, of one angle or programmed: for pictures, tables and estimates."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["angle_along", "extremes", "fibre_length", "turned"]

Floats = NDArray[np.float64]
LOOKED_AT = 401
"""Places at which the least and the largest angle are looked for."""
GAUSS = 16
"""Points of an integral from one place to the next."""


def angle_along(braid: Any, share: Any) -> Floats:
    """Braid angle [rad] from the parallels as made, at shares v/H0 of the length."""
    share = np.asarray(share, float)
    if braid.angle_profile is None:
        return np.full(share.shape, float(braid.angle))
    from scipy.interpolate import CubicSpline, PchipInterpolator  # here, because it takes half a second to import

    through = CubicSpline if braid.angle_profile.between == "spline" else PchipInterpolator
    return np.asarray(through(*_given(braid))(share))


def extremes(braid: Any) -> tuple[float, float]:
    """Least and largest braid angle [rad] as made."""
    angles = angle_along(braid, np.linspace(0.0, 1.0, LOOKED_AT))
    return float(angles.min()), float(angles.max())


def fibre_length(braid: Any) -> float:
    """Length of a fibre as made [m], from fitting to fitting: H0/sin(theta0), or the integral of that."""
    H0 = float(braid.length)
    if braid.angle_profile is None:
        return H0 / math.sin(float(braid.angle))
    return H0 * float(_integral(braid, lambda angle: 1.0 / np.sin(angle), _given(braid)[0])[-1])


def turned(braid: Any, share: Any) -> Floats:
    """Angle [rad] by which a fibre has gone around the braid at rising shares of its length: that of dv/(R0 tan)."""
    unit, share = float(braid.length) / float(braid.radius), np.asarray(share, float)
    if braid.angle_profile is None:
        return share * unit / math.tan(float(braid.angle))
    ends = np.unique(np.concatenate([share, _given(braid)[0]]))
    return unit * np.interp(share, ends, _integral(braid, lambda angle: 1.0 / np.tan(angle), ends))


def _given(braid: Any) -> tuple[Floats, Floats]:
    """Shares of the length, and the angles there, over the whole length."""
    x = np.array([0.0, *map(float, braid.angle_profile.places)])
    y = np.array([float(braid.angle), *map(float, braid.angle_profile.angle)])
    if not braid.angle_profile.mirrored:
        return x, y
    return np.concatenate([x, 1.0 - x[-2::-1]]), np.concatenate([y, y[-2::-1]])


def _integral(braid: Any, density: Callable[[Floats], Floats], ends: Floats) -> Floats:
    """Integral of a function of the angle over shares, from the first of the ends to each."""
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    width = np.diff(ends)
    shares = ends[:-1, None] + width[:, None] * (0.5 + 0.5 * points)
    return np.concatenate([[0.0], np.cumsum(0.5 * width * (density(angle_along(braid, shares)) @ weights))])
