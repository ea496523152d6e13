"""The verdict on a state, in words that a lab user understands."""

import attrs
import numpy as np

from mckibben.results.verdict import Modes, Shape, Verdict

ADMISSIBLE = (Shape.ORDINARY, Shape.OVERHANG)


@attrs.frozen
class Judgement:
    """A verdict, the sentence that explains it, and the shape."""

    verdict: Verdict
    reason: str
    shape: Shape

    @classmethod
    def lost(cls, why: str) -> "Judgement":
        """No state was found."""
        return cls(Verdict.NOT_CONVERGED, why, Shape.ORDINARY)


END_PLANE_SLACK = 1e-3
"""How far behind its fitting, in end radii, the wall may pass before the state counts as inadmissible: less than any
real wall is thick, and enough to keep a pinned end that leans back by a hair."""


def clearance(psi: np.ndarray, z: np.ndarray, end_radius: float) -> float:
    """Room before the shape becomes inadmissible, over the end radius: negative behind the end plane or rolled up."""
    behind = min(float(z.min() - z[0]), float(z[-1] - z.max())) / end_radius + END_PLANE_SLACK
    return min(behind, np.pi - float(np.abs(psi).max()))


def shape_of(psi: np.ndarray, r: np.ndarray, z: np.ndarray) -> Shape:
    """Shape of one meridian, from its slope [rad], radius and height [m] at points along it."""
    if np.abs(psi).max() > np.pi:
        return Shape.ROLLED_UP
    if clearance(psi, z, float(r[0])) < 0.0:
        return Shape.BEHIND_END_PLANE
    if np.abs(psi).max() <= np.pi / 2:
        return Shape.ORDINARY
    return Shape.SELF_CONTACT if _crosses(r, z) else Shape.OVERHANG


BLOCK = 16
"""Segments of a polyline that share one bounding box in the search for crossings."""


def _crosses(r: np.ndarray, z: np.ndarray) -> bool:
    """Whether the polyline (r, z) crosses itself: exact on the segments of blocks whose boxes overlap."""
    points = np.stack([r, z], 1)
    a, b = points[:-1], points[1:]
    first = np.arange(0, len(a), BLOCK)
    low = np.minimum.reduceat(np.minimum(a, b), first)
    high = np.maximum.reduceat(np.maximum(a, b), first)
    overlap = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    blocks = np.argwhere(np.triu(overlap))
    within = np.arange(BLOCK)
    i, j = np.broadcast_arrays(
        BLOCK * blocks[:, :1, None] + within[:, None], BLOCK * blocks[:, 1:, None] + within[None, :]
    )
    apart = (j > i + 1) & (j < len(a))
    i, j = i[apart], j[apart]

    def side(p: np.ndarray, q: np.ndarray, x: np.ndarray) -> np.ndarray:
        d, e = q - p, x - p
        return np.asarray(d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0])

    A, B, C, D = a[i], b[i], a[j], b[j]
    return bool(((side(A, B, C) * side(A, B, D) < 0) & (side(C, D, A) * side(C, D, B) < 0)).any())


REASONS = {
    Shape.BEHIND_END_PLANE: "the tube bulges back behind its fitting, which the model does not stop",
    Shape.SELF_CONTACT: "the wall touches itself, which the model does not stop",
    Shape.ROLLED_UP: "the wall rolls up on itself",
}


def judge(modes: Modes, shape: Shape, length_held: bool) -> Judgement:
    """Verdict on a converged state under its own control."""
    if shape not in ADMISSIBLE:
        return Judgement(Verdict.INADMISSIBLE, REASONS[shape], shape)
    control = "length" if length_held else "force"
    count = modes.length_control if length_held else modes.force_control
    if count:
        return Judgement(Verdict.UNSTABLE, f"the shape gives way under {control} control ({_modes(count)})", shape)
    if modes.antisymmetric:
        tips = f"one end bulges as the other shrinks ({_modes(modes.antisymmetric)}, antisymmetric)"
        return Judgement(Verdict.UNSTABLE, f"the shape gives way to one side: {tips}", shape)
    note = "; it overhangs its fitting" if shape == Shape.OVERHANG else ""
    return Judgement(Verdict.STABLE, f"stable under {control} control{note}", shape)


def _modes(count: int) -> str:
    return "1 unstable mode" if count == 1 else f"{count} unstable modes"
