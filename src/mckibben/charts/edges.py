"""The range of a map: between which lengths a muscle is stable and admissible, over the pressures."""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.charts.sample import Samples
from mckibben.charts.series import Edges
from mckibben.experiments.limits import shorten
from mckibben.solver.bench import Bench
from mckibben.solver.threads import one_thread
from mckibben.spec import Muscle, SpecError
from mckibben.units import show

__all__ = ["NEAR", "admissible", "lengths_in", "narrowed", "pressures_in"]

NEAR = 0.98
"""Share of full extension up to which a map goes: beyond, the force has no bound."""
KNOTS = 5
"""Pressures at which the shortest length is sought."""
ROOM = 2e-3
"""Distance from the shortest admissible length, over the lengths asked for."""
LEAST = 0.1
"""Part of the lengths asked for that must be left."""


def pressures_in(edges: Edges, y: np.ndarray) -> np.ndarray:
    """Pressures [Pa] at places from -1 to 1 on the axis of q."""
    middle, half = edges.q
    return np.asarray(np.clip((middle + half * y) ** 2 - edges.soft + edges.first, edges.first, edges.last))


def lengths_in(edges: Edges, y: np.ndarray) -> np.ndarray:
    """Shortest and longest length [m] at such places (..., 2)."""
    return np.stack([_between(knots, y) for knots in (edges.low, edges.high)], axis=-1)


def _between(knots: np.ndarray, y: np.ndarray) -> np.ndarray:
    if len(knots) == 1:
        return np.full(np.shape(y), knots[0])
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(np.linspace(-1.0, 1.0, len(knots)), knots)(y))


@one_thread()
def admissible(muscle: Muscle, edges: Edges) -> Edges:
    """The range without the lengths that are too short at some pressures. SpecError where nothing is left."""
    bench, (low, high) = Bench.of(muscle), (float(edges.low[0]), float(edges.high[0]))
    found = []
    for P in pressures_in(edges, np.linspace(-1.0, 1.0, KNOTS)).tolist():
        end = shorten(bench, P, shapes=True)
        if end.last is None:
            said = f"the muscle has no stable state at {show(P, 'Pa')} as long as it was made: {end.cause.reason}"
            raise SpecError("chart.pressure", allowed=said, advice="begin at a higher pressure, see mk.least_pressure")
        found.append(max(low, end.held.get("length") + ROOM * (high - low)))
    if max(found) > high - LEAST * (high - low):
        k = int(np.argmax(found))
        P = float(pressures_in(edges, np.linspace(-1.0, 1.0, KNOTS))[k])
        said = f"no muscle is so short: the shortest admissible length at {show(P, 'Pa')} is {show(found[k], 'm')}"
        given = f"{show(low, 'm')} to {show(high, 'm')}"
        raise SpecError("chart.length", given, said, "ask for longer ones, see mk.limits")
    return attrs.evolve(edges, low=np.array(found), high=np.full(KNOTS, high)) if max(found) > low else edges


def narrowed(edges: Edges, seen: Samples) -> Edges:
    """The range without the points at which no state was found; SpecError where they are not at its edges."""
    low, high = np.moveaxis(lengths_in(edges, edges.across(seen.pressure)), -1, 0)
    full = float((edges.high - edges.low).max())
    bad = ~seen.good & (seen.length >= low) & (seen.length <= high)
    share = (seen.length - low) / np.maximum(high - low, 1e-12)
    up, down = (
        float(np.where(bad & which, off + ROOM * full, 0.0).max(initial=0.0))
        for which, off in ((share <= 0.5, seen.length - low), (share > 0.5, high - seen.length))
    )
    if up + down > (1.0 - LEAST) * float((edges.high - edges.low).min()):
        k = int(np.argmax(bad & (np.abs(share - 0.5) == np.abs(share - 0.5)[bad].min())))
        at = f"{show(float(seen.length.ravel()[k]), 'm')} and {show(float(seen.pressure.ravel()[k]), 'Pa')}"
        said = f"no stable state was found in the middle of the range, at {at}"
        raise SpecError("chart", allowed=said, advice="ask for a smaller range, see mk.working_range")
    return attrs.evolve(edges, low=edges.low + up, high=edges.high - down)
