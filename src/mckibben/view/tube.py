"""The muscle as numbers in space: a surface of revolution, and the fibres on it."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from mckibben.results.result import Result
from mckibben.spec import Muscle
from mckibben.spec.winding import turned

Floats = NDArray[np.float64]
FACETS = 40
"""Facets along the length and around the visible half."""
PLACES = 513
"""Places at which the way of a fibre around a programmed braid is known."""


@attrs.frozen
class Tube:
    """A surface of revolution with its fibres: v, r, z [m] along the meridian, and the braid as made."""

    v: Floats
    r: Floats
    z: Floats
    R0: float
    theta0: float
    fibres: int
    turns: tuple[Floats, Floats] | None = None
    """Of a programmed braid, at many v [m] how far a fibre has gone around there [rad]."""

    @classmethod
    def of(cls, result: Result, step: int) -> Tube:
        """The shape of one state of a result."""
        data, braid = result.data.isel(step=step), result.muscle.braid
        r, z = np.asarray(data["r"]), np.asarray(data["z"])
        made = float(braid.radius), float(braid.angle), int(braid.fibres)
        return cls(np.asarray(data["v"]), r, z, *made, _turns(result.muscle))

    @classmethod
    def cylinder(cls, muscle: Muscle, theta: float | None = None) -> Tube:
        """The uniform cylinder at braid angle theta [rad]: the muscle as made where none is given."""
        braid = muscle.braid
        R0, H0, theta0 = float(braid.radius), float(braid.length), float(braid.angle)
        turns = _turns(muscle) if theta is None else None
        theta = theta0 if theta is None else theta
        v = np.linspace(0.0, H0, 61)
        r = np.full(61, R0 * np.cos(theta) / np.cos(theta0))
        return cls(v, r, v * np.sin(theta) / np.sin(theta0), R0, theta0, int(braid.fibres), turns)

    def at(self, v: Any) -> tuple[Floats, Floats]:
        """r and z at material coordinates v."""
        return np.asarray(np.interp(v, self.v, self.r)), np.asarray(np.interp(v, self.v, self.z))

    def point(self, v: Any, phi: Any) -> Floats:
        """Points (..., 3) of the surface (Eq. 1)."""
        r, z = self.at(v)
        return np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z), axis=-1)

    def normal(self, v: Any, phi: Any) -> Floats:
        """Outward unit normals (..., 3) (Eq. 4)."""
        rate = tuple(np.interp(v, self.v, np.gradient(line, self.v, edge_order=2)) for line in (self.r, self.z))
        size = np.hypot(*rate)
        parts = rate[1] * np.cos(phi) / size, rate[1] * np.sin(phi) / size, -rate[0] / size
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def fibre(self, start: float, hand: int, count: int = 161) -> tuple[Floats, Floats]:
        """(v, phi) along one fibre: phi = start + hand v/(R0 tan(theta0)) (Eq. 7)."""
        v = np.linspace(self.v[0], self.v[-1], count)
        return v, start + hand * self.turned(v)

    def turned(self, v: Any) -> Floats:
        """How far [rad] a fibre has gone around at material coordinates v: the integral of dv/(R0 tan(theta0))."""
        if self.turns is None:
            return np.asarray(v / (self.R0 * np.tan(self.theta0)))
        return np.interp(v, *self.turns)

    def reached(self, turned: Any) -> Floats:
        """Material coordinates [m] at which a fibre has gone that far around; beyond the ends at the rate there."""
        if self.turns is None:
            return np.asarray(turned * (self.R0 * np.tan(self.theta0)))
        v, phi = self.turns
        first, last = (v[1] - v[0]) / (phi[1] - phi[0]), (v[-1] - v[-2]) / (phi[-1] - phi[-2])
        inside = np.interp(turned, phi, v)
        return inside + first * np.minimum(turned - phi[0], 0.0) + last * np.maximum(turned - phi[-1], 0.0)

    def even(self) -> Floats:
        """Material coordinates at nearly even steps along the meridian, somewhat closer together at the ends."""
        if len(self.v) <= 3:
            return self.v
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(self.r), np.diff(self.z)))])
        share = np.linspace(0.0, 1.0, 2 * FACETS + 1)
        share = share - 0.6 * np.sin(2.0 * np.pi * share) / (2.0 * np.pi)
        return np.interp(share * arc[-1], arc, self.v)

    def shifted(self, out: Any) -> Tube:
        """The surface at a distance [m], one or one per v, outwards along the normals."""
        normal = self.normal(self.v, 0.0)
        return attrs.evolve(self, r=np.maximum(self.r + out * normal[:, 0], 0.0), z=self.z + out * normal[:, 2])


def _turns(muscle: Muscle) -> tuple[Floats, Floats] | None:
    """How far a fibre of a programmed braid has gone around at many places; None for one angle."""
    if muscle.braid.angle_profile is None:
        return None
    share = np.linspace(0.0, 1.0, PLACES)
    return share * float(muscle.braid.length), turned(muscle.braid, share)
