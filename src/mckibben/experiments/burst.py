"""`burst_pressures()`: from which pressure on a fibre would break, or the wall bulge out between fibres."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from mckibben.experiments.foresee import refuse_friction
from mckibben.experiments.solve import solve
from mckibben.measure.caution import MuscleWarning
from mckibben.measure.signs import STRONG, bearable, stiffness
from mckibben.results.result import State
from mckibben.results.verdict import Verdict
from mckibben.spec import Muscle, SpecError, Step
from mckibben.units import show

__all__ = ["Burst", "burst_pressures"]

FIRST = 0.1e5
"""First pressure [Pa] that is tried; it is doubled up to `STRONG`."""
CLOSE = 1e-6
"""Relative error of a pressure that is sought."""

FIBRE = "braid.fibre.breaking_force is not given"
WALL = (
    "asks for a chamber inside the braid, a law of known stiffness and the diameter of the fibres: only such a wall is "
    "carried by fibres"
)
ASSUMED = (
    "a fibre breaks where its tension is its breaking force: new, straight and single, not worn, not notched where it "
    "crosses others or is clamped",
    "the wall bulges as a neo-Hookean membrane of the stiffness that its law begins with, through an opening that does "
    "not widen; from half a circle on it may burst, which is no strength of the rubber",
    "pressure that rises slowly on one muscle; no fatigue, no ageing, no heat, no leak at the fittings",
)


@attrs.frozen
class Burst:
    """Gauge pressures [Pa] from which a muscle would burst, at one length or under one force; NaN where none is told.

    It is what `burst_pressures` gives. They are estimates, and no pressures to work at.

    Args:
        held: what is held, in words.
        fibre: pressure from which the tension of a fibre exceeds its breaking force.
        fibre_reason: why there is none, or empty.
        wall: pressure from which the chamber's wall bulges through the openings between fibres by half a circle.
        wall_reason: likewise.
        assumed: what is taken for granted, in sentences.

    >>> paper = mk.presets.paper()
    >>> mk.burst_pressures(paper).fibre_reason
    'braid.fibre.breaking_force is not given'
    """

    held: str
    fibre: float
    fibre_reason: str
    wall: float
    wall_reason: str
    assumed: tuple[str, ...] = ASSUMED


def burst_pressures(muscle: Muscle, *, length: Any = None, contraction: Any = None, force: Any = None) -> Burst:
    """Pressures from which a fibre would break or the chamber bulge out between fibres, at a length or under a force.

    The state is solved at rising pressures, from none up to 100 bar, and each pressure is sought where the largest
    tension is `Fibre.breaking_force`, or the wall somewhere bulges by half a circle (theory page: the wall between
    fibres). Both are estimates: `assumed` says on what they rest.

    Args:
        muscle: the specification.
        length: distance between the fittings [m], a number or text with a unit; that at rest if nothing is given.
        contraction: in place of the length: 1 - h/H0, such as "10 %" or 0.1.
        force: in place of either: what the muscle lifts [N].

    Returns:
        A `Burst`, with a reason for each pressure that is NaN.

    Raises:
        SpecError: for a muscle with friction, or what is held that is not one value.

    >>> strong = mk.presets.paper().replace("braid.fibre.breaking_force", "5 N")
    >>> round(mk.burst_pressures(strong, length="115 mm").fibre / 1e5, 1)  # bar
    1.0
    """
    refuse_friction(muscle, "burst_pressures")
    if length is None and contraction is None and force is None:
        length = float(muscle.rest_length)
    given = Step(length=length, contraction=contraction, force=force, pressure=0.0)  # type: ignore[call-arg]
    (step,) = given.as_steps(muscle)
    axial = "force" if step.force is not None else "length"
    path = getattr(step, axial)
    if path.needs_present or path.varies:
        raise SpecError(f"burst_pressures.{axial}", str(path), "must be one value")
    value = float(path.sample(1)[0])
    seen = _Seen(muscle, {axial: value}, {})
    fibre = (np.nan, FIBRE) if muscle.braid.fibre.breaking_force is None else seen.least(_tension)
    wall = (np.nan, WALL) if stiffness(muscle) is None else seen.least(_bulge)
    return Burst(show(value, "m" if axial == "length" else "N"), *fibre, *wall)


@attrs.frozen
class _Seen:
    """States of a muscle by their pressure, each sought once."""

    muscle: Muscle
    held: dict[str, float]
    states: dict[float, State]

    def at(self, pressure: float) -> State:
        if pressure not in self.states:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", MuscleWarning)
                self.states[pressure] = solve(self.muscle, **self.held, pressure=pressure)
        return self.states[pressure]

    def least(self, share: Callable[[State], float]) -> tuple[float, str]:
        """The least pressure at which a share of what is borne is 1, or NaN and why.

        A state that needs a pressure is sought from the first one at which it is stable.
        """
        from scipy.optimize import brentq  # here, because few calls need it

        def over(pressure: float) -> float:
            state = self.at(pressure)
            return share(state) - 1.0 if state.verdict == Verdict.STABLE else np.nan

        low = np.nan
        for high in (0.0, *(FIRST * 2.0**k for k in range(11) if FIRST * 2.0**k < STRONG), STRONG):
            value = over(high)
            if value >= 0.0:
                if low != low:  # from the first on
                    return high, ""
                try:
                    return float(brentq(over, low, high, rtol=CLOSE)), ""
                except (ValueError, RuntimeError):  # a state between was not found
                    return (
                        np.nan,
                        f"between {show(low, 'Pa')} and {show(high, 'Pa')}: no stable state somewhere between",
                    )
            if value == value:
                low = high
            elif low == low:
                return np.nan, f"not below {show(low, 'Pa')}; at {show(high, 'Pa')}: {self.at(high).reason}"
        if low != low:
            return np.nan, f"no stable state up to {show(STRONG, 'Pa')}: {self.at(STRONG).reason}"
        return np.nan, f"not up to {show(STRONG, 'Pa')}"


def _tension(state: State) -> float:
    """Largest fibre tension over what a fibre bears."""
    strength = state.result.muscle.braid.fibre.breaking_force
    assert strength is not None
    return float(state.data["fibre_tension"].max()) / float(strength)


def _bulge(state: State) -> float:
    """Pressure over that at which the wall bulges by half a circle, at the worst place."""
    result = state.result
    names = ("r", "theta", "stretch_thickness", "contact_pressure")
    found = bearable(result.muscle, {name: result.column(name) for name in names if name in result.data})
    assert found is not None
    return state.pressure / float(found.bears.min())
