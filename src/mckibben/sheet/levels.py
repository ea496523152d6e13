"""The muscle at some pressures: what it pulls at its length as made, how far it contracts, the curve between."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from mckibben.experiments.run import run
from mckibben.measure.caution import MuscleWarning
from mckibben.results.result import Result
from mckibben.results.told import verdict
from mckibben.results.verdict import Verdict
from mckibben.spec import BlockedForce, FreeContraction, Isobaric, Muscle, Protocol, Step, Test
from mckibben.spec.catalogue import CATALOGUE
from mckibben.spec.change import CHANGED
from mckibben.spec.plausible import trusted
from mckibben.spec.winding import fibre_length

__all__ = ["Ends", "Fact", "Level", "curve", "ends", "known", "rated", "stable"]

POINTS = 16
"""States of each curve."""
STROKE = 0.08
"""Free contraction below which a curve begins at a stretched length: such muscles pull where they are stretched."""
SHORTEST = 1e-3
"""Contraction over which a curve goes at least."""
STRETCHED = 0.6
"""Where such a curve begins: share of the way from the length as made to full extension."""
USUAL = 0.25
"""Contraction at which curves end where no free contraction is known."""
_RATED = {"paper": "1 bar", "reference": "1 bar"} | {name: entry.rated for name, entry in CATALOGUE.items()}
"""Pressures that presets are meant for."""


@attrs.frozen
class Fact:
    """A number [SI], NaN with the reason where there is none."""

    value: float
    reason: str = ""


@attrs.frozen(eq=False)
class Level:
    """The muscle at one gauge pressure [Pa]."""

    pressure: float
    blocked: Fact  #: force at the length as made [N]
    contraction: Fact  #: free contraction
    length: Fact  #: free length [m]
    curve: Result


@attrs.frozen(eq=False)
class Ends:
    """The muscle at some rising gauge pressures [Pa], held at its length as made and free: between which curves go."""

    pressures: tuple[float, ...]
    blocked: Result
    free: tuple[tuple[Result, int], ...]  #: the free muscle at each pressure: a state of a result, by its number
    contraction: tuple[Fact, ...]  #: of these
    first: float  #: contraction at which all curves begin
    last: float  #: and end where no free one is known

    def end(self, k: int) -> float:
        """Contraction at which the curve at a pressure ends: there the muscle is free, if that is known."""
        own = self.contraction[k]
        end = self.last if own.reason else own.value
        return end if abs(end - self.first) > SHORTEST else self.first + SHORTEST

    def level(self, k: int, curve: Result) -> Level:
        """What is known at a pressure, with the curve there."""
        blocked, length = known(self.blocked, k, "force"), known(*self.free[k], "length")
        return Level(self.pressures[k], blocked, self.contraction[k], length, curve)


def ends(muscle: Muscle, pressures: tuple[float, ...], tell: Callable[[int], None] = lambda done: None) -> Ends:
    """Both ends of the curves at some rising gauge pressures [Pa].

    Curves end where the muscle is free. They begin at the length as made; of a muscle that hardly contracts by itself,
    which pulls where it is stretched, on the way to full extension. `tell` is called with the parts done, of two.
    """
    blocked = _run(muscle, BlockedForce(pressure=list(pressures)))
    tell(1)
    free = _freed(muscle, pressures)
    tell(2)
    contractions = [known(*at, "contraction") for at in free]
    return Ends(pressures, blocked, tuple(free), tuple(contractions), *_span(muscle, contractions))


def curve(muscle: Muscle, pressure: float, first: float, end: float) -> Result:
    """Force from a contraction to another, at a gauge pressure [Pa]."""
    with trusted():  # SI numbers
        way: Any = {"contraction": np.linspace(first, end, POINTS).tolist()}
        return _run(muscle, Isobaric(pressure=pressure, **way))


def _run(muscle: Muscle, test: Test) -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MuscleWarning)  # the sheet has them
        return run(muscle, test, tolerance=1e-4)


def _freed(muscle: Muscle, pressures: tuple[float, ...]) -> list[tuple[Result, int]]:
    """The free muscle at each pressure; with friction one that is filled at its length as made, and then let go."""
    if muscle.friction is None:
        free = _run(muscle, FreeContraction(pressure=list(pressures)))
        return [(free, k) for k in range(len(pressures))]
    with trusted():  # SI numbers
        ways = [
            Protocol(steps=[Step(length=muscle.rest_length, pressure=pressure, points=1),
                            Step(force="to 0 N", pressure="hold", points=2)])
            for pressure in pressures
        ]  # fmt: skip
    return [(_run(muscle, way), -1) for way in ways]


def known(result: Result, k: int, name: str) -> Fact:
    """A number of a state that is stable; else why there is none."""
    if result.verdict[k] == Verdict.STABLE:
        return Fact(float(result.column(name)[k]))
    if k < 0:  # the reason is that of the step before, which was not finished
        k = int(np.argmin(stable(result)))
    return Fact(math.nan, verdict(result.verdict[k], str(result.column("reason")[k])))


def stable(result: Result) -> np.ndarray:
    """Which states are stable."""
    return np.array([word == Verdict.STABLE for word in result.verdict])


def _span(muscle: Muscle, contractions: list[Fact]) -> tuple[float, float]:
    """Contractions between which the curves go; each ends where the muscle is free, if that is known."""
    known = [one.value for one in contractions if one.value == one.value]
    far = max(known, key=abs) if known else USUAL
    if far >= STROKE or far < -0.02:
        return 0.0, far
    braid, rest = muscle.braid, float(muscle.rest_length)
    return -STRETCHED * (fibre_length(braid) - braid.length) / rest, far


def rated(muscle: Muscle) -> str | None:
    """The gauge pressure that a preset is meant for, changed or not; None of any other muscle."""
    return _RATED.get((muscle.name or "").removesuffix(CHANGED))
