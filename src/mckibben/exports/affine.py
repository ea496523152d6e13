"""The force of a map, straight in the length and in the pressure: what MuJoCo's own actuators know."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.potential.chart import Chart
from mckibben.spec.errors import SpecError

__all__ = ["Affine", "affine"]

POINTS, CHECKS = 41, 161
"""Lengths, and pressures, at which the law is made, and at which its error is sought."""


@attrs.frozen
class Affine:
    """F = bias + slope h + P (gain + gain_slope h), not below zero and not above the largest force; SI."""

    bias: float
    slope: float
    gain: float
    gain_slope: float
    largest: float  #: force at which it is cut off [N]
    error: float  #: largest error against the map, both not below zero [N]

    def force(self, length: float, pressure: float) -> float:
        """Force [N] at a length [m] and a gauge pressure [Pa]."""
        said = self.bias + self.slope * length + pressure * (self.gain + self.gain_slope * length)
        return min(max(said, 0.0), self.largest)

    def stiffness(self, pressure: float) -> float:
        """Slope of the force by the length [N/m]."""
        return self.slope + pressure * self.gain_slope

    def length(self, force: float, pressure: float) -> float:
        """The length [m] at which it pulls a force [N]."""
        return (force - self.bias - pressure * self.gain) / self.stiffness(pressure)


def affine(chart: Chart) -> Affine:
    """The one with the least largest error where the map pulls; nowhere falling with the length."""
    from scipy.optimize import linprog

    h, P, F = _seen(chart, POINTS)
    pulls = F >= 0.0
    if pulls.sum() < 4:
        raise SpecError(
            "export", allowed="the muscle pulls nowhere in the map's range", advice="ask for longer lengths"
        )
    a, b = float(np.mean(h[pulls])), 0.5 * float(np.ptp(h))
    x, y, scale = (h - a) / b, P / P.max(), float(F.max())
    rows = np.stack([np.ones_like(x), x, y, x * y], axis=-1)
    some = rows[pulls]
    one = np.ones((len(some), 1))
    least = [[0.0, -1.0, 0.0, -y, 0.0] for y in (float(y.min()), 1.0)]
    found = linprog(
        [0.0] * 4 + [1.0],
        np.concatenate([np.hstack([some, -one]), np.hstack([-some, -one]), least]),
        np.concatenate([F[pulls] / scale, -F[pulls] / scale, [0.0, 0.0]]), bounds=[(None, None)] * 4 + [(0.0, None)],
    )  # fmt: skip
    if found.x is None:
        raise SpecError("export", allowed=f"no straight law was found: {found.message}", advice="take .h or .fmu")
    c = scale * np.asarray(found.x[:4])
    flat = float(P.max())
    law = Affine(
        bias=float(c[0] - c[1] * a / b) + 0.0, slope=float(c[1] / b) + 0.0,
        gain=float((c[2] - c[3] * a / b) / flat) + 0.0, gain_slope=float(c[3] / b / flat) + 0.0,
        largest=scale, error=0.0,
    )  # fmt: skip
    h, P, F = _seen(chart, CHECKS)
    said = law.bias + law.slope * h + P * (law.gain + law.gain_slope * h)
    off = np.clip(said, 0.0, scale) - np.maximum(F, 0.0)
    return attrs.evolve(law, error=float(np.abs(off).max()))


def _seen(chart: Chart, points: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lengths, pressures and forces on a grid over the range."""
    P = np.linspace(*chart.pressures, points)
    low, high = chart.lengths(P)
    h = low + np.linspace(0.0, 1.0, points)[:, None] * (high - low)
    P = np.broadcast_to(P, h.shape)
    return h, P, chart.force(h, P)
