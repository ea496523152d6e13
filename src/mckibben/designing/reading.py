"""Where each measure looks at a muscle, and its value from what is seen there."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import jax
import numpy as np

from mckibben.designing.places import By, Place
from mckibben.designing.states import AtPlaces
from mckibben.measure.bow import left_to_bow
from mckibben.measure.mass import mass_of, over_fibres
from mckibben.measure.meridian import LINE, radii_at
from mckibben.model.jamming import across
from mckibben.model.parameters import numbers
from mckibben.spec import Muscle, SpecError
from mckibben.spec.measures import AirVolume, ForceAt, Mass, PressureFor, Stroke
from mckibben.spec.ranged import (
    Diameter,
    FibreSafety,
    FibreTension,
    ForceVariation,
    JammingMargin,
    StabilityMargin,
    Work,
)  # fmt: skip
from mckibben.spec.targets import CurveMiss, ProfileMiss
from mckibben.spec.wishes import Measure

__all__ = ["check_measure", "lined_of", "places_of", "value_of"]

EXTREMES = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)
"""Where in a range the largest radius, tension or room is looked for: they change smoothly, and mostly one way."""
GAUSS = 8
"""Points of the integral of force over length."""
EVEN = 9
"""Points at which the variation of a force is looked at."""


def _one(measure: Any, default: Place) -> Place:
    if measure.length is not None:
        return Place(measure.pressure, By.LENGTH, measure.length)
    return default if measure.contraction is None else Place(measure.pressure, By.CONTRACTION, measure.contraction)


def _within(measure: Any, shares: Any) -> list[Place]:
    """Places in the range of a measure."""
    if measure.between is None:
        return [Place(measure.pressure, By.SHARE, float(share)) for share in shares]
    low, high = measure.between
    return [Place(measure.pressure, By.CONTRACTION, float(low + share * (high - low))) for share in shares]


def _gauss() -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def _pulling(measure: PressureFor) -> Place:
    if measure.length is not None:
        return Place(measure.up_to, By.LENGTH, measure.length, measure.force)
    return Place(measure.up_to, By.CONTRACTION, measure.contraction or 0.0, measure.force)


def places_of(measure: Measure) -> list[Place]:
    """The states that a measure needs, in the order in which `value_of` takes them."""
    if isinstance(measure, ForceAt):
        return [_one(measure, Place(measure.pressure, By.CONTRACTION, 0.0))]
    if isinstance(measure, AirVolume):
        return [_one(measure, Place(measure.pressure, By.SHARE, 1.0))]
    if isinstance(measure, Stroke):
        return [Place(measure.pressure, By.FORCE, measure.force)]
    if isinstance(measure, PressureFor):
        return [_pulling(measure)]
    if isinstance(measure, Work):
        return [*_within(measure, (0.0, 1.0)), *_within(measure, _gauss()[0])]
    if isinstance(measure, ForceVariation):
        return _within(measure, np.linspace(0.0, 1.0, EVEN))
    if isinstance(measure, CurveMiss):
        return [Place(measure.pressure, By.CONTRACTION, at) for at in measure.contractions]
    if isinstance(measure, ProfileMiss):
        return [_one(measure, Place(measure.pressure, By.FORCE, measure.force or 0.0))]
    return [] if isinstance(measure, Mass) else _within(measure, EXTREMES)


def lined_of(measures: Iterable[Measure]) -> set[Place]:
    """The states of which measures need the meridian."""
    return {place for measure in measures if isinstance(measure, ProfileMiss) for place in places_of(measure)}


def value_of(measure: Measure, seen: AtPlaces) -> np.ndarray:
    """The measure of every design; NaN where one of its states is not there."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return _VALUES[type(measure)](measure, seen, places_of(measure))


def _force(measure: ForceAt, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return seen.at(places[0])


def _stroke(measure: Stroke, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return seen.at(places[0], "contraction")


def _pressure_for(measure: PressureFor, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return seen.at(places[0], "pressure")


def _work(measure: Work, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    ends, inner = seen.over(places[:2], "length"), seen.over(places[2:])
    work = (ends[:, 0] - ends[:, 1]) * (inner @ _gauss()[1])
    braid = seen.muscle.braid
    if measure.per == "volume":
        return work / seen.all(np.pi * np.asarray(braid.radius) ** 2 * np.asarray(braid.length))
    if measure.per == "mass":
        return work / seen.all(mass_of(seen.muscle, measure.fibre_density, measure.chamber_density))
    return work


def _variation(measure: ForceVariation, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    forces = seen.over(places)
    mean = forces.mean(axis=1)
    return np.where(mean > 0.0, (forces.max(axis=1) - forces.min(axis=1)) / mean, np.nan)


def _miss(measure: CurveMiss, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    off = seen.over(places) - np.array(measure.forces)
    return np.asarray(np.sqrt(np.mean(off**2, axis=1)))


def _off_profile(measure: ProfileMiss, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    lines, at = zip(*(seen.at(places[0], name) for name in LINE), strict=True), np.array(measure.places)
    radii = [radii_at(psi, r, z, at if measure.at is None else at * z[-1]) for psi, r, z in lines]
    return np.asarray(np.sqrt(np.mean((np.array(radii) - np.array(measure.r)) ** 2, axis=1)))


def _diameter(measure: Diameter, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return np.asarray(over_fibres(seen.over(places, "largest_radius").max(axis=1), seen.muscle))


def _tension(measure: Any, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return seen.over(places, "peak_fibre_tension").max(axis=1)


def _safety(measure: FibreSafety, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    strength, tension = seen.all(seen.muscle.braid.fibre.breaking_force), _tension(measure, seen, places)
    return np.where(tension > 0.0, strength / tension, np.where(tension <= 0.0, np.inf, np.nan))


def _room(measure: JammingMargin, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    """Of inextensible fibres r/R0 = cos(theta)/cos(theta0), wherever along the muscle."""
    braid = seen.muscle.braid
    R0, theta0 = seen.all(braid.radius), seen.all(braid.angle)
    r = seen.over(places, "largest_radius").max(axis=1)
    cosine = r * np.cos(theta0) / R0
    theta = np.arccos(np.clip(cosine, -1.0, 1.0))
    fibres, diameter = seen.all(braid.fibres), seen.all(braid.fibre.diameter)
    room = np.where(cosine < 1.0, across(r, theta, fibres) / diameter - 1.0, -1.0)
    made = across(R0, theta0, fibres) / diameter - 1.0
    return np.asarray(np.where(np.isfinite(r), np.minimum(room, made), np.nan))


def _left(measure: StabilityMargin, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    p = jax.tree.map(seen.all, numbers(seen.muscle))
    found = [left_to_bow(p, seen.at(one, "length"), seen.at(one), measure.pressure) for one in places]
    return np.asarray(np.min(found, axis=0))


def _air(measure: AirVolume, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    tube = numbers(seen.muscle).tube
    return seen.at(places[0], "volume") - seen.all(0.0 if tube is None else tube.rubber)


def _mass(measure: Mass, seen: AtPlaces, places: list[Place]) -> np.ndarray:
    return seen.all(mass_of(seen.muscle, measure.fibre_density, measure.chamber_density))


_VALUES: dict[type, Callable[[Any, AtPlaces, list[Place]], np.ndarray]] = {
    ForceAt: _force, Stroke: _stroke, PressureFor: _pressure_for, Work: _work, ForceVariation: _variation,
    CurveMiss: _miss, ProfileMiss: _off_profile, Diameter: _diameter, FibreTension: _tension, FibreSafety: _safety,
    JammingMargin: _room, StabilityMargin: _left, AirVolume: _air, Mass: _mass,
}  # fmt: skip


def check_measure(measure: Measure, muscle: Muscle) -> None:
    """SpecError where a muscle lacks what a measure needs: the strength or the diameter of its fibres, a density."""
    fibre = muscle.braid.fibre
    if isinstance(measure, FibreSafety) and fibre.breaking_force is None:
        raise SpecError("braid.fibre.breaking_force", allowed="is missing, and a safety factor needs it",
                        advice='give it: mk.Fibre(..., breaking_force="30 N")')  # fmt: skip
    if isinstance(measure, JammingMargin) and muscle.braid.angle_profile is not None:
        said = f"does not go with the measure {measure.kind}, which knows one braid angle"
        advice = "look at the cautions of a result, which tell where fibres touch"
        raise SpecError("braid.angle_profile", allowed=said, advice=advice)
    weighs = isinstance(measure, Mass) or (isinstance(measure, Work) and measure.per == "mass")
    if (weighs or isinstance(measure, JammingMargin)) and fibre.diameter is None:
        raise SpecError("braid.fibre.diameter", allowed=f"is missing, and the measure {measure.kind} needs it")
    if weighs and muscle.chamber is not None and getattr(measure, "chamber_density", None) is None:
        raise SpecError(f"{measure.kind}.chamber_density", allowed="is missing", advice='such as "1100 kg/m^3"')
