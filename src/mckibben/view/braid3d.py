"""The braid in space: fibres over and under each other, the chamber's wall, the end fittings.

Fibres of one hand lie over those of the other at every second crossing, as in a plain weave: on the way from one
crossing to the next a fibre goes smoothly from half a diameter outside of the surface of centre lines, which the model
computes, to half a diameter inside of it. The pictures draw the wall inside the fibres, on whichever side the model has
it.
"""

from __future__ import annotations

import math

import attrs
import numpy as np

from mckibben.results.result import Result
from mckibben.spec import Muscle
from mckibben.spec.winding import extremes
from mckibben.view.mesh import Mesh, cut_face, disc, pipe, surface
from mckibben.view.tube import Floats, Tube

SHARE = 0.35
"""Display diameter of a fibre whose diameter is not known, over the room between neighbours of one hand as made."""
POINTS = 6
"""Most points along a fibre from one crossing to the next."""
CROSSINGS = 120_000
"""Most crossings that are drawn, counted on both hands; braids with more are drawn with fewer fibres."""
BUDGET = 20_000
"""About how many points are made along all fibres together: more of them than pixels, and files that stay handy."""
SECTOR = math.radians(100.0)
"""Angle that is cut out of a muscle which is cut open."""
FITTING = 0.4
"""Length of the end fittings over R0. They are no part of the model."""
SKIN = 0.02
"""Thickness over R0 with which bellows are drawn whose wall is not told."""


@attrs.frozen
class Body:
    """What is drawn of one state: the surface of centre lines, how thick fibres and wall are, what is cut out."""

    tube: Tube
    diameter: float  #: of a fibre as drawn [m]
    fibres: int  #: that are drawn, both hands together
    wall: Floats | None  #: thickness of the wall along v [m]; None for a bare braid
    cut: float | None = None  #: middle of the sector that is cut out [rad]

    @classmethod
    def of(cls, result: Result, state: int, cut: float | None = None) -> Body:
        """One state of a result."""
        tube, muscle = Tube.of(result, state), result.muscle
        made = wall_made(muscle)
        wall = None if made is None else made * result.column("stretch_thickness")[state]
        return cls(tube, display_diameter(muscle), drawn_fibres(tube), wall, cut)

    @property
    def kept(self) -> tuple[float, float] | None:
        """The angles [rad] between which the muscle is left; None for all around."""
        half = SECTOR / 2.0
        return None if self.cut is None else (self.cut + half, self.cut + 2.0 * np.pi - half)

    def centre_line(self, start: float, hand: int, v: Floats, weave: bool = True) -> tuple[Floats, Floats]:
        """Points (n, 3) [m] and normals of the surface along the fibre of a hand (1 or -1) that starts at an angle."""
        phi = start + hand * self.tube.turned(v)
        normal = self.tube.normal(v, phi)
        points = self.tube.point(v, phi)
        return (points + hand * self._over(v)[:, None] * normal if weave else points), normal

    def fibre_pipes(self) -> Mesh:
        """All fibres as round bars."""
        per_hand, (points, sides) = self.fibres // 2, self._fineness()
        every = np.diff(self.crossings()).min() / points
        v = np.append(np.arange(0.0, self.tube.v[-1] * (1.0 - 1e-9), every), self.tube.v[-1])
        return Mesh.joined([
            pipe(*self.centre_line(start, hand, piece), self.diameter / 2.0, piece, sides)
            for hand in (1, -1)
            for start in 2.0 * np.pi * np.arange(per_hand) / per_hand
            for piece in self._pieces(float(start), hand, v)
        ])  # fmt: skip

    def crossings(self) -> Floats:
        """Material coordinates [m] at which fibres cross, from one end on."""
        if self.tube.turns is not None:
            apart = np.pi / (self.fibres // 2)
            last = max(float(self.tube.turned(self.tube.v[-1])), 1.5 * apart)
            return self.tube.reached(np.arange(0.0, last, apart))
        every = np.pi * self._turn / (self.fibres // 2)
        return np.arange(0.0, max(self.tube.v[-1], 1.5 * every), every)

    def chamber(self) -> Mesh | None:
        """The chamber's wall, with its planes where it is cut; None for a bare braid."""
        if self.wall is None:
            return None
        outer = self.tube.shifted(-self.diameter)
        inner = self.tube.shifted(-self.diameter - self.wall)
        faces = [surface(outer, self.kept), surface(inner, self.kept).turned_over()]
        if self.kept is not None:
            faces += [cut_face(outer, inner, self.kept[0], -1), cut_face(outer, inner, self.kept[1], 1)]
        return Mesh.joined(faces)

    def fittings(self) -> Mesh:
        """Drums around both ends that hide the ends of fibres and chamber."""
        return Mesh.joined([part for end in (0, -1) for part in self._drum(end)])

    def _drum(self, end: int) -> list[Mesh]:
        tube, out = self.tube, -1.0 if end == 0 else 1.0
        near, far = tube.z[end] - out * self.diameter, tube.z[end] + out * FITTING * tube.R0
        radius = float(tube.r[end]) + self.diameter + 0.04 * tube.R0
        v = tube.v[end] + np.array([0.0, 0.5, 1.0])  # apart, as its normals need
        z = np.linspace(min(near, far), max(near, far), 3)
        drum = Tube(v, np.full(3, radius), z, tube.R0, tube.theta0, 0)
        where = float(tube.v[end])
        return [
            attrs.evolve(part, v=np.full(len(part.v), where)) for part in (surface(drum), disc(drum, 0), disc(drum, -1))
        ]

    @property
    def _turn(self) -> float:
        """dv/dphi of a fibre [m] (Eq. 7); of a programmed braid at its first end."""
        return self.tube.R0 * math.tan(self.tube.theta0)

    def _over(self, v: Floats) -> Floats:
        """How far [m] fibres of hand 1 lie outside of the surface of centre lines: +-d/2 where they cross others."""
        return 0.5 * self.diameter * np.cos(self.fibres // 2 * self.tube.turned(v))

    def _fineness(self) -> tuple[int, int]:
        """Points from one crossing to the next, and sides of the bars."""
        share = BUDGET / (self.fibres * len(self.crossings()))
        return int(np.clip(share, 2, POINTS)), int(np.clip(5 + share / 2, 6, 10))

    def _pieces(self, start: float, hand: int, v: Floats) -> list[Floats]:
        """Material coordinates along the pieces of a fibre that are left."""
        if self.kept is None:
            return [v]
        low, high = self.kept
        first, last = sorted((start, start + hand * float(self.tube.turned(v[-1]))))
        pieces = []
        for turn in range(math.floor((first - high) / (2.0 * np.pi)), math.ceil((last - low) / (2.0 * np.pi)) + 1):
            ends = self.tube.reached((np.array([low, high]) + 2.0 * np.pi * turn - start) * hand)
            a, b = np.clip(np.sort(ends), 0.0, v[-1])
            if b - a > 1e-3 * self._turn:
                pieces.append(np.concatenate([[a], v[(v > a + 1e-9 * b) & (v < b - 1e-9 * b)], [b]]))
        return pieces


def wall_made(muscle: Muscle) -> float | None:
    """Thickness of the wall as made [m], or that with which it is drawn; None without a chamber."""
    if muscle.chamber is None:
        return None
    told = muscle.chamber.wall_thickness
    return SKIN * float(muscle.braid.radius) if told is None else float(told)


def display_diameter(muscle: Muscle) -> float:
    """Diameter [m] that a fibre is drawn with: its own, or where none is given a share of the room it has as made."""
    own = muscle.braid.fibre.diameter
    if own is not None:
        return float(own)
    braid = muscle.braid
    room = 2.0 * math.pi * float(braid.radius) * math.sin(extremes(braid)[0]) / (int(braid.fibres) // 2)
    return min(SHARE * room, 0.1 * float(braid.radius))


def drawn_fibres(tube: Tube) -> int:
    """How many fibres are drawn: all, or of a braid with very many crossings fewer, as if it had no more."""
    per_fibre = float(tube.turned(tube.v[-1])) / np.pi  # crossings, over the fibres of one hand
    most = 2 * int(math.sqrt(CROSSINGS / (2.0 * per_fibre)))
    return max(2, min(tube.fibres, most))
