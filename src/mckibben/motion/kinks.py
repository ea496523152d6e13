"""Where rates have a kink: continuous, but with other slopes before and after, so that derivatives step over none."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from mckibben.motion.flow import LAMINAR
from mckibben.motion.regime import FIRST, PER, Regime

__all__ = ["divided", "flows_of", "marks_of"]


def marks_of(regime: Regime, t: float, y: Sequence[float]) -> list[float]:
    """Numbers that change their signs where the rates have a kink: of valves, maps and friction."""
    plant, found = regime.plant, [y[1]] if regime.plant.friction else []
    for k, command in enumerate(regime.commands):
        p, own = y[FIRST + PER * k], y[FIRST + PER * k + 2]
        b = plant.valves[k][2]
        found.append(command(t))
        for other in (plant.supplied, plant.atmosphere):
            ratio = p / other if p < other else other / p
            found += [p - other, ratio - b, ratio - LAMINAR]
        first, last = plant.charts[k].pressures
        P = p - plant.atmosphere
        low, high = plant.charts[k].lengths(min(max(P, first), last))
        found += [P - first, P - last, own - float(low), float(high) - own]
    return found


def flows_of(regime: Regime, t: float, y: Sequence[float]) -> tuple[int, ...]:
    """How the air of each muscle flows: 0 choked, 1 subsonic, 2 laminar; 3 more out of it, 6 more on venting."""
    plant, found = regime.plant, list[int]()
    for k, command in enumerate(regime.commands):
        vents, p, b = command(t) < 0.0, y[FIRST + PER * k], plant.valves[k][2]
        other = plant.atmosphere if vents else plant.supplied
        ratio = p / other if p < other else other / p
        found.append((0 if ratio <= b else 1 if ratio < LAMINAR else 2) + 3 * (p > other) + 6 * vents)
    return tuple(found)


def divided(
    regime: Regime, smooth: Callable[[float], np.ndarray], last: float, reached: float, before: list[float],
    after: list[float],
) -> list[tuple[float, tuple[int, ...]]]:  # fmt: skip
    """The parts of a step between kinks: when each ends, and how air flows in it.

    The kinks are told by what `marks_of` says before and after the step.
    """
    from scipy.optimize import brentq

    found = []
    for j, (a, b) in enumerate(zip(before, after, strict=True)):
        if a * b < 0.0:
            found.append(
                float(brentq(lambda t, j=j: marks_of(regime, t, smooth(t).tolist())[j], last, reached, xtol=1e-13))
            )
    ends = [t for t in sorted(found) if last < t < reached] + [reached]
    middles = [0.5 * (a + b) for a, b in zip([last, *ends], ends, strict=False)]
    return [(end, flows_of(regime, t, smooth(t).tolist())) for end, t in zip(ends, middles, strict=True)]
