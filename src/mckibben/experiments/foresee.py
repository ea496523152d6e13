"""What can be told of a muscle and a test without solving anything."""

from __future__ import annotations

import math
from collections.abc import Iterator

from mckibben.model.extension import longest
from mckibben.model.jamming import across, jamming_lengths
from mckibben.spec import Muscle, SpecError, Test
from mckibben.spec.angle import MAGIC, between, both_ways, tendency
from mckibben.spec.winding import extremes, fibre_length
from mckibben.units import show

__all__ = ["BY_DIFFERENCES", "beyond", "derived", "refuse_friction", "turns"]


def derived(muscle: Muscle) -> Iterator[tuple[str, str, str]]:
    """(quantity, value, meaning) of what follows from the fields without solving anything."""
    braid, fibre = muscle.braid, muscle.braid.fibre
    made = tendency(braid.angle) if braid.angle_profile is None else between(*extremes(braid))
    yield "braid", made, f"long muscles turn at {show(MAGIC, 'rad', 4)} from the parallels (Eq. 31)"
    if longest(muscle) < math.inf:
        meaning = "longest possible length: the fibres are straight, the force has no bound"
        yield "full extension", show(longest(muscle), "m"), meaning
    yield "fibre length", show(fibre_length(braid), "m"), "from fitting to fitting, along one fibre"
    for name, value in zip(("B1", "B2", "B3"), fibre.stiffnesses, strict=True):
        way = {"B1": "bending in the tangent plane", "B2": "bending normal to the tube", "B3": "torsion"}[name]
        yield f"fibre stiffness {name}", show(value, "N m^2"), way
    if fibre.EA is not None:
        yield "fibre stiffness EA", show(fibre.EA, "N"), "tension over strain of one fibre"
    if muscle.chamber is not None and hasattr(muscle.chamber.law, "shear_modulus"):
        yield "shear modulus", show(muscle.chamber.law.shear_modulus, "kPa"), "of the chamber, at small strain"
    yield from _fittings(muscle)
    yield from _chamber(muscle)
    if fibre.diameter is not None:
        room = across(braid.radius, extremes(braid)[0], braid.fibres)
        said = f"between neighbouring fibres as made: {room / fibre.diameter:.3g} diameters; the braid jams at 1"
        yield "jamming room", show(room, "m"), said
        if braid.angle_profile is None:
            ends = [show(length, "m", 4) for length in jamming_lengths(muscle)]
            said = "length of the cylinder whose neighbouring fibres touch"
            yield "jammed", f"below {ends[0]}, beyond {ends[1]}", said


def _fittings(muscle: Muscle) -> Iterator[tuple[str, str, str]]:
    """What follows from fittings of another radius than the braid's."""
    braid = muscle.braid
    for radius, where in zip(muscle.end_radii or (), ("first", "last"), strict=False):
        angle = math.acos(radius * math.cos(braid.angle) / braid.radius)
        name = "both fittings" if len(muscle.end_radii or ()) == 1 else f"{where} fitting"
        meaning = f"braid angle from the parallels that its radius holds, {show(radius, 'm')}"
        yield f"angle at the {name}", show(angle, "rad", 4), meaning


def _chamber(muscle: Muscle) -> Iterator[tuple[str, str, str]]:
    """What follows from a chamber that is not the paper's."""
    if muscle.chamber is None or not muscle.chamber.own:
        return
    from mckibben.model.parameters import parameters  # here, because others need no JAX
    from mckibben.model.wall import touching_pressure

    p = parameters(muscle)
    assert p.tube is not None
    hoop, axial = (float(x) for x in p.tube[:2])
    face = "outer" if muscle.chamber.inside else "inner"
    yield "chamber as mounted", f"{hoop:.4g} x {axial:.4g}", f"hoop and axial stretch of its {face} face"
    if muscle.chamber.inside:
        yield "rubber inside", show(float(p.tube.rubber), "m^3"), "volume inside the braid that is not air"
        touching = max(0.0, float(touching_pressure(p)))
        yield "dead zone", show(touching, "Pa", 4), "pressure that blows the tube alone up to the braid as made"


def turns(muscle: Muscle) -> str:
    """What the braid angle makes of the muscle, in a line."""
    angle = muscle.braid.angle
    if muscle.braid.angle_profile is not None:
        return f"braid of {between(*extremes(muscle.braid))}"
    return f"braid of {both_ways(angle)}: {tendency(angle)}"


def beyond(muscle: Muscle, test: Test | None) -> Iterator[str]:
    """What of a test cannot be reached, as far as that can be told without solving."""
    most = longest(muscle)
    for step in test.as_steps(muscle) if test is not None else ():
        length = max((float(value) for value in step.length.waypoints), default=0.0) if step.length is not None else 0.0
        if length >= most:
            yield f"note: the test asks for a length of {show(length, 'm')}; full extension is {show(most, 'm')}"


BY_DIFFERENCES = "differences of run() between muscles that are near, as fit() does"
"""In place of exact derivatives, which would have to carry those of all that a path leaves behind."""


def refuse_friction(muscle: Muscle, call: str, instead: str = "run()") -> None:
    """SpecError for a call that asks for states without a path, of a muscle whose states depend on it."""
    if muscle.friction is not None:
        said = f"does not go with {call}(): a state then depends on the path to it"
        advice = f'use {instead}, or leave it out: muscle.replace("friction", None)'
        raise SpecError("friction", allowed=said, advice=advice)
