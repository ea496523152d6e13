"""`size_valve()`: how large a valve must be for a muscle to be filled, or vented, in time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mckibben.motion.commands import Commands
from mckibben.motion.drive import drive
from mckibben.motion.maps import maps_of
from mckibben.motion.plant import Plant
from mckibben.motion.regime import FIRST, Regime
from mckibben.motion.simulate import read_time
from mckibben.motion.start import at_rest
from mckibben.results.answers import Sized
from mckibben.spec.declared import evolved
from mckibben.spec.errors import SpecError
from mckibben.spec.rig import Rig
from mckibben.spec.signal import Constant
from mckibben.units import UnitError, show, to_si

__all__ = ["size_valve"]

CLOSE = 1e-4
"""Relative error of the conductance."""
WIDEST = 1e-5
"""Largest conductance that is tried [m^3/s/Pa], 1000 L/s/bar."""
TOLERANCE = 1e-6


def size_valve(rig: Rig, within: Any, *, pressure: Any, vent: bool = False, chart: Any = None) -> Sized:
    """The smallest valve with which the muscle reaches a pressure in time, the load moving with it.

    The command of the rig is not used: the valve is open all the time. Its dead time counts.

    Args:
        rig: the rig; the critical ratio and the dead time of its valve stay.
        within: the time [s].
        pressure: gauge pressure to be reached [Pa]; with `vent` that to which it must fall.
        vent: size the way out in place of the way in, from `rig.pressure`.
        chart: the map of the muscle, as for `simulate`.

    Returns:
        A `Sized`: the valve, the time it takes, and its nominal flow as catalogues print it.

    Raises:
        SpecError: for a pressure that the supply does not reach, or a time in which no valve does it.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), supply=mk.Supply(gauge="2 bar"),
    ...     valve=mk.Valve(C="1 L/s/bar", b=0.3), tube="5 mL",
    ... )
    >>> found = mk.size_valve(rig, within="0.2 s", pressure="1.5 bar")
    >>> round(1e8 * found.valve.C, 4)  # L/s/bar
    0.1233
    """
    if not isinstance(rig, Rig):
        raise SpecError("size_valve.rig", rig, "must be a Rig")
    limit = read_time(within, "size_valve.within")
    goal = _goal(rig, pressure, vent)
    assert rig.valve is not None
    room = limit - rig.valve.delay
    if room <= 0.0:
        said = f"must be more than the dead time of the valve, {show(rig.valve.delay, 's')}"
        raise SpecError("size_valve.within", within, said)
    base = evolved(rig, valve=evolved(rig.valve, delay=0.0), command=Constant(-1.0 if vent else 1.0))
    charts = maps_of(rig, chart)

    def excess(log: float) -> float:
        """Pressure at the end of the time, over the goal; above 0 where it is reached."""
        C = math.exp(log)
        made = evolved(base, valve=evolved(base.valve, C=C, vent=None))
        reached = _pressure_at(made, charts, room)
        return (goal - reached if vent else reached - goal) / 1e5

    from scipy.optimize import brentq

    guess = _guess(rig, charts, goal, room, vent)
    low, high = guess / 2.0, guess * 2.0
    while excess(math.log(high)) < 0.0:
        low, high = high, high * 4.0
        if high > WIDEST:
            said = "is reached by no valve: what it moves, or the dead time, takes longer"
            raise SpecError("size_valve.within", within, said, "give it more time")
    while excess(math.log(low)) > 0.0:
        low, high = low / 4.0, low
    C = math.exp(float(brentq(excess, math.log(low), math.log(high), xtol=CLOSE)))
    other = {"vent": C} if vent else {"C": C, "vent": rig.valve.vent}
    valve = evolved(rig.valve, **other)
    return Sized(valve=valve, time=limit, nominal=C * 7e5 * valve.share(6.0 / 7.0))


def _goal(rig: Rig, pressure: Any, vent: bool) -> float:
    try:
        goal = float(to_si(pressure, "Pa"))
    except UnitError as error:
        raise SpecError("size_valve.pressure", pressure, str(error), error.advice) from error
    top = rig.supplied - rig.atmosphere
    if vent and not 0.0 < goal < rig.pressure:
        said = f"must be between 0 bar and that of the start, {show(rig.pressure, 'Pa')}"
        raise SpecError("size_valve.pressure", pressure, said, "give the rig a pressure at the start")
    if not vent and not rig.pressure < goal < top:
        ends = f"{show(rig.pressure, 'Pa')} and {show(top, 'Pa', 5)} gauge"
        raise SpecError("size_valve.pressure", pressure, f"must be between those of the start and the supply, {ends}")
    return goal


def _pressure_at(rig: Rig, charts: tuple[Any, ...], end: float) -> float:
    begun = at_rest(Plant.of(rig, charts))
    done = drive(begun, Commands(rig, end), np.array([0.0, end]), "LSODA", TOLERANCE, lambda done, total: None)
    if done.reason:
        raise SpecError("size_valve.rig", allowed=f"cannot be simulated: {done.reason}")
    return done.states[-1][FIRST] - rig.atmosphere


def _guess(rig: Rig, charts: tuple[Any, ...], goal: float, room: float, vent: bool) -> float:
    """The conductance of choked flow into the volume of the start."""
    begun = at_rest(Plant.of(rig, charts))
    seen = Regime.closed(begun.plant, begun.mode).rates(0.0, begun.state).muscles[0]
    before = (rig.pressure if vent else rig.supplied) + (rig.atmosphere if vent else 0.0)
    return abs(goal - rig.pressure) * seen.volume / (before * 1e5 * room)
