"""Triangles in space as plain numbers: surfaces, tubes and closed solids of revolution."""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np
from numpy.typing import NDArray

from mckibben.view.tube import Floats, Tube

Ints = NDArray[np.int64]
AROUND = 96
"""Facets around a surface of revolution."""


@attrs.frozen
class Mesh:
    """Triangles: points (n, 3) [m], faces (m, 3) seen from outside against the clock, outward normals (n, 3), v (n)."""

    points: Floats
    faces: Ints
    normals: Floats
    v: Floats  #: material coordinate of each point [m], where fields are looked up

    @classmethod
    def joined(cls, parts: Sequence[Mesh]) -> Mesh:
        """Several as one."""
        if not parts:
            return cls(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3)), np.zeros(0))
        before = np.cumsum([0, *(len(part.points) for part in parts)])
        return cls(
            np.concatenate([part.points for part in parts]),
            np.concatenate([part.faces + first for part, first in zip(parts, before, strict=False)]),
            np.concatenate([part.normals for part in parts]),
            np.concatenate([part.v for part in parts]),
        )

    def turned_over(self) -> Mesh:
        """The same surface seen from its other side."""
        return attrs.evolve(self, faces=self.faces[:, ::-1], normals=-self.normals)

    def volume(self) -> float:
        """Volume [m^3] that a closed surface holds."""
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def grid(points: Floats, normals: Floats, v: Floats) -> Mesh:
    """A surface from points (a, b, 3) in rows; seen from outside, the second index runs to the left of the first."""
    rows, across = points.shape[:2]
    index = np.arange(rows * across).reshape(rows, across)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Mesh(points.reshape(-1, 3), faces, normals.reshape(-1, 3), np.broadcast_to(v, (rows, across)).ravel())


def surface(tube: Tube, sector: tuple[float, float] | None = None) -> Mesh:
    """A surface of revolution; with `sector` between two angles [rad] only."""
    v = tube.even()[:, None]
    start, end = sector or (0.0, 2.0 * np.pi)
    phi = np.linspace(start, end, 1 + max(2, round(AROUND * (end - start) / (2.0 * np.pi))))[None, :]
    return grid(tube.point(v, phi), tube.normal(v, phi), v)


def cut_face(outer: Tube, inner: Tube, phi: float, side: int) -> Mesh:
    """The plane of a wall's cut along the half plane at phi [rad], facing towards larger phi (side 1) or smaller."""
    v = outer.even()[:, None]
    points = np.concatenate([outer.point(v, phi), inner.point(v, phi)], axis=1)
    normal = side * np.array([-np.sin(phi), np.cos(phi), 0.0])
    made = grid(points, np.broadcast_to(normal, points.shape).copy(), v)
    return made if side > 0 else attrs.evolve(made, faces=made.faces[:, ::-1])


def disc(tube: Tube, end: int) -> Mesh:
    """The flat disc that closes a surface of revolution at its first (end = 0) or last (-1) circle."""
    phi = np.linspace(0.0, 2.0 * np.pi, AROUND + 1)[:-1]
    v = float(tube.v[end])
    points = np.concatenate([[[0.0, 0.0, float(tube.z[end])]], tube.point(v, phi)])
    ring = 1 + np.arange(AROUND)
    faces = np.stack([np.zeros_like(ring), np.roll(ring, -1), ring], axis=1)
    normals = np.tile([0.0, 0.0, -1.0], (AROUND + 1, 1))
    made = Mesh(points, faces, normals, np.full(AROUND + 1, v))
    return made if end == 0 else made.turned_over()


def solid(tube: Tube) -> Mesh:
    """The closed solid inside a surface of revolution: every edge has two faces, no point comes twice."""
    v, phi = tube.even()[:, None], np.linspace(0.0, 2.0 * np.pi, AROUND + 1)[None, :-1]
    side = grid(tube.point(v, phi), tube.normal(v, phi), v)
    first = np.arange(0, len(side.points), AROUND)[:-1]
    seam = first + AROUND - 1
    a, b, c, d = seam, first, first + AROUND, seam + AROUND
    round_ = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    ends = [disc(tube, 0), disc(tube, -1)]
    count = len(side.points)
    rings = (np.arange(AROUND), count - AROUND + np.arange(AROUND))
    number = [np.concatenate([[count + k], ring]) for k, ring in enumerate(rings)]  # of the discs' points in the whole
    return Mesh(
        np.concatenate([side.points, *(end.points[:1] for end in ends)]),
        np.concatenate([side.faces, round_, *(n[end.faces] for n, end in zip(number, ends, strict=True))]),
        np.concatenate([side.normals, *(end.normals[:1] for end in ends)]),
        np.concatenate([side.v, *(end.v[:1] for end in ends)]),
    )


def pipe(centres: Floats, outwards: Floats, radius: float, v: Floats, sides: int) -> Mesh:
    """A round bar along centres (n, 3), closed at both ends; `outwards` are directions from which its sides begin."""
    along = np.gradient(centres, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    up = outwards - np.sum(outwards * along, axis=1, keepdims=True) * along
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    across = np.cross(along, up)
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)[None, :, None]
    normals = np.cos(angle) * up[:, None, :] + np.sin(angle) * across[:, None, :]
    mantle = grid(centres[:, None, :] + radius * normals, normals, v[:, None])
    return Mesh.joined([mantle, *(_cap(mantle, centres, along, end, sides) for end in (0, -1))])


def _cap(mantle: Mesh, centres: Floats, along: Floats, end: int, sides: int) -> Mesh:
    """The disc that closes a bar."""
    ring = mantle.points.reshape(len(centres), sides + 1, 3)[end, :-1]
    points = np.concatenate([centres[[end]], ring])
    index = 1 + np.arange(sides)
    faces = np.stack([np.zeros_like(index), np.roll(index, -1), index], axis=1)
    made = Mesh(points, faces, np.tile(-along[end], (len(points), 1)), np.full(len(points), float(mantle.v[end])))
    return made if end == 0 else made.turned_over()
