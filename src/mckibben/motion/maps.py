"""The map of each muscle of a rig: as given, or made over the range that the rig may need, and kept."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

from mckibben.motion.mapped import Mapped
from mckibben.spec.errors import SpecError
from mckibben.spec.muscle import Muscle
from mckibben.spec.rig import Rig
from mckibben.spec.winding import fibre_length
from mckibben.units import show

__all__ = ["maps_of"]

SHORT, LONG = 0.6, 0.97
"""Shortest length of a map that is made here, over the length as made; and the longest, over full extension."""
ROUND = 1e5
"""The pressures of such a map end at a multiple of this [Pa], so that rigs with supplies nearly alike share one."""


def maps_of(rig: Rig, chart: Any = None) -> tuple[Any, ...]:
    """A map for each muscle. SpecError for what is no map, or that of another muscle."""
    muscles = rig.muscles
    if chart is None:
        top = _top(rig)
        return tuple(_made(muscle, top) for muscle in muscles)
    charts = tuple(chart) if isinstance(chart, (tuple, list)) else (chart,) * len(muscles)
    if len(charts) != len(muscles):
        raise SpecError("simulate.chart", allowed=f"must be {len(muscles)}, one for each muscle, not {len(charts)}")
    for one, muscle in zip(charts, muscles, strict=True):
        if not isinstance(one, Mapped):
            advice = 'such as mk.chart(muscle, length="60 mm to 115 mm", pressure="0 to 3 bar")'
            raise SpecError("simulate.chart", one, "must be a map", advice)
        own = getattr(one, "muscle", None)
        if own is not None and own != muscle:
            raise SpecError(
                "simulate.chart",
                allowed="is that of another muscle",
                advice="make one of the rig's own, or leave it out",
            )
    return charts


def _top(rig: Rig) -> float:
    """The highest gauge pressure that the map needs [Pa]."""
    gauge = rig.supplied - rig.atmosphere
    return max(1.0, -(-gauge // ROUND)) * ROUND if gauge > 0.2 * ROUND else gauge


@lru_cache(maxsize=16)
def _made(muscle: Muscle, top: float) -> Any:
    from mckibben.charts.chart import chart as make  # here, because a map that is given needs no JAX
    from mckibben.model.extension import longest

    low, high = SHORT * float(muscle.rest_length), LONG * _most(float(longest(muscle)), muscle)
    try:
        return make(muscle, length=(low, high), pressure=(0.0, top))
    except SpecError as error:
        between = f"{show(low, 'm', 4)} to {show(high, 'm', 4)} and 0 to {show(top, 'Pa', 4)}"
        said = f"is left out, and none can be made over {between} ({error})"
        advice = "make one over what the rig needs: chart=mk.chart(muscle, length=..., pressure=...)"
        raise SpecError("simulate.chart", allowed=said, advice=advice) from error


def _most(longest: float, muscle: Muscle) -> float:
    """Full extension [m]; of fibres that stretch, which have none, the length at which they would be straight."""
    return longest if math.isfinite(longest) else fibre_length(muscle.braid)
