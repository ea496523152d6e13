"""What a datasheet says of a muscle, computed: what it can do, what that takes, and what is not known."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator

import attrs
import numpy as np

from mckibben.experiments.limits import Limits, limits
from mckibben.measure.mass import mass_of, over_fibres
from mckibben.results.result import Result
from mckibben.sheet.levels import Fact, Level, curve, ends, known, stable
from mckibben.spec import Muscle
from mckibben.spec.constants import ATMOSPHERE

__all__ = ["Facts", "cautions_once", "facts"]


@attrs.frozen(eq=False)
class Facts:
    """What is known of a muscle up to a pressure; SI units."""

    muscle: Muscle
    levels: tuple[Level, ...]  #: the last at the largest pressure
    free: tuple[Result, int]  #: the free muscle at the largest pressure: a state, by its number
    range: Limits | None  #: at the largest pressure
    no_range: str  #: why there is none
    tension: Fact  #: largest of a fibre on any curve [N]
    where: str  #: where that is
    safety: Fact  #: breaking force over it
    diameter: Fact  #: largest outside diameter on any curve [m]
    bore: float  #: volume of air in the muscle as made, without pressure [m^3]
    volume: Fact  #: likewise free at the largest pressure
    air: Fact  #: of one stroke, at atmospheric pressure [m^3]
    work: Fact  #: of one slow stroke at the largest pressure [J]
    mass: Fact  #: without fittings [kg]
    cautions: tuple[str, ...]

    @property
    def pressure(self) -> float:
        """The largest pressure."""
        return self.levels[-1].pressure


def facts(
    muscle: Muscle,
    pressures: tuple[float, ...],
    densities: tuple[float | None, float | None] = (None, None),
    watch: Callable[[int, int], None] = lambda done, total: None,
) -> Facts:
    """Compute what a datasheet says at some rising gauge pressures [Pa]; densities [kg/m^3] of fibres and chamber."""
    total = len(pressures) + 3
    watch(0, total)
    both = ends(muscle, pressures, lambda done: watch(done, total))
    levels = []
    for k, pressure in enumerate(pressures):
        levels.append(both.level(k, curve(muscle, pressure, both.first, both.end(k))))
        watch(3 + k, total)
    reach, why = _range(muscle, pressures[-1])
    watch(total, total)
    results = [both.blocked, *(result for result, _ in both.free), *(level.curve for level in levels)]
    tension, where = _tension(results)
    strength = muscle.braid.fibre.breaking_force
    safety = Fact(math.nan, "not known: the breaking force of a fibre")
    if strength is not None:
        safety = Fact(strength / tension.value) if tension.value > 0.0 else Fact(math.nan, "no fibre is pulled")
    made, volume = _bore(muscle), known(*both.free[-1], "air_volume")
    filled = (pressures[-1] + ATMOSPHERE) / ATMOSPHERE * volume.value - made
    return Facts(
        muscle, tuple(levels), both.free[-1], reach, why, tension, where, safety, _diameter(levels, muscle), made,
        volume, Fact(filled, volume.reason), _work(levels[-1]), _mass(muscle, *densities),
        tuple(cautions_once(one.cautions for one in results)),
    )  # fmt: skip


def _range(muscle: Muscle, pressure: float) -> tuple[Limits | None, str]:
    if muscle.friction is not None:
        return None, "with friction the force at a length depends on the path to it"
    found = limits(muscle, pressure=pressure)
    return (found, "") if found.shortest == found.shortest else (None, found.shortest_cause or "no stable state")


def _tension(results: list[Result]) -> tuple[Fact, str]:
    """The largest fibre tension of any stable state, and where."""
    best, where = -math.inf, ""
    for result in results:
        peaks = np.where(stable(result), result.column("fibre_tension").max(axis=1), -math.inf)
        k = int(np.argmax(peaks))
        if peaks[k] > best:
            best = float(peaks[k])
            where = f"at {1e3 * result.length[k]:.4g} mm and {1e-5 * result.pressure[k]:.3g} bar"
    return (Fact(best), where) if best > -math.inf else (Fact(math.nan, "no state is stable"), "")


def _diameter(levels: list[Level], muscle: Muscle) -> Fact:
    radii = [float(level.curve.column("r")[stable(level.curve)].max()) for level in levels if stable(level.curve).any()]
    return Fact(float(over_fibres(max(radii), muscle))) if radii else Fact(math.nan, "no state is stable")


def _bore(muscle: Muscle) -> float:
    """Room for air in the muscle as made: that of the chamber, or of the braid where it lies outside or is none."""
    braid, chamber = muscle.braid, muscle.chamber
    radius = float(braid.radius)
    if chamber is not None and chamber.inside and chamber.wall_thickness is not None:
        radius = float(chamber.riding_radius(radius) - chamber.wall_thickness)
    return math.pi * radius**2 * float(braid.length)


def _work(level: Level) -> Fact:
    """What a slow stroke at this pressure gives, from where the curve begins to where the muscle is free."""
    good = stable(level.curve)
    if level.contraction.reason:
        return Fact(math.nan, level.contraction.reason)
    if not good.all():
        return Fact(math.nan, "the curve at this pressure has states that are not stable")
    return Fact(float(-np.trapezoid(level.curve.force, level.curve.length)))


def _mass(muscle: Muscle, fibre: float | None, rubber: float | None) -> Fact:
    """Fibres and chamber, without fittings."""
    braid, chamber = muscle.braid, muscle.chamber
    missing = [] if fibre is not None else ["the density of the fibres"]
    missing += ["the diameter of the fibres"] if braid.fibre.diameter is None else []
    missing += ["the density of the chamber"] if chamber is not None and rubber is None else []
    missing += ["the wall of the bellows"] if chamber is not None and chamber.wall_thickness is None else []
    if missing:
        return Fact(math.nan, f"not known: {', '.join(missing)}")
    return Fact(float(mass_of(muscle, fibre, rubber)))


_WHERE = re.compile(r"(?:from )?state \d+ \((?P<place>[^)]*)\)(?: and \d+ more)?(?: on)?: (?P<said>.*)", re.DOTALL)


def cautions_once(told_by: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """Each kind of caution of some results once, from where it first shows."""
    told = set()
    for cautions in told_by:
        for line in cautions:
            found = _WHERE.fullmatch(line)
            said = found["said"] if found else line
            kind = re.sub(r"[^a-z]+", "", said)[:40]
            if kind not in told:
                told.add(kind)
                said = re.sub(r"; in the shape of state \d+ it", "; there it", said)
                yield f"from {found['place']} on: {said}" if found else said
