"""What the states of a result show that a real muscle would do otherwise: sentences, each from where it begins."""

from functools import partial
from typing import Any, NamedTuple

import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.model.column import bending_stiffness, column_load
from mckibben.model.jamming import across, jamming_lengths
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.profile import at_share
from mckibben.model.span import bulging_pressure
from mckibben.spec import Muscle
from mckibben.units import show

__all__ = ["STRONG", "Columns", "after", "bearable", "stiffness", "strong"]

STRONG = 1e7
"""Pressure [Pa] above what built muscles hold; hydraulic ones work up to some 50 bar."""
TOUCHING = 1.0
"""Pull between chamber and mesh [Pa] below which it is a rounding error."""
SLENDER = 5.0
"""Length over diameter from which a muscle is a column; a shorter one is none, and the estimate means nothing."""
NEAR = 0.5
"""Share of the column load from which a bow is told: the load is that of a straight column, pushed along its axis."""

Columns = dict[str, np.ndarray]


def after(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """Cautions that a result gives rise to: jamming, bow, broken fibres, pressure, dead zone, wall between fibres."""
    found = [*jamming(muscle, steps, fields), *column(muscle, steps, fields), *breaking(muscle, steps, fields)]
    return [*found, *strong(steps), *apart(muscle, steps, fields), *bulging(muscle, steps, fields)]


def jamming(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """Neighbouring fibres of one hand come to touch, flat around the muscle or steep along it."""
    braid, diameter = muscle.braid, muscle.braid.fibre.diameter
    if diameter is None:
        return []
    apart = across(fields["r"], fields["theta"], braid.fibres)
    hit = (apart < diameter).any(axis=1)
    if not hit.any():
        return []
    k = int(np.flatnonzero(hit)[0])
    short = fields["theta"][k, int(np.nanargmin(apart[k]))] < 0.25 * np.pi
    where = "flat around it" if short else "steep along it"
    if braid.angle_profile is None:
        length = jamming_lengths(muscle)[0 if short else 1]
        where += f", as {'below' if short else 'beyond'} {show(length, 'm', 4)} anywhere"
    said = f"neighbouring fibres touch, {where}: the braid jams, which the model"
    return _first(hit, steps, f"{said} ignores; fewer or thinner fibres leave more room")


@partial(kernel, static_argnums=())
def _stiffness(p: Parameters, theta: Array, force: Array, pressure: Array) -> Array:
    """Bending stiffness [N m^2] of one state by its middle."""
    return bending_stiffness(theta, force, pressure, p)


def column(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """A slender muscle that pushes may bow sideways, which an axisymmetric model cannot."""
    middle = fields["r"].shape[1] // 2
    r, theta = fields["r"][:, middle], fields["theta"][:, middle]
    length = steps["length"] - float(muscle.rest_length - muscle.braid.length)
    load, middle_of = np.full(len(length), np.inf), at_share(0.5, parameters(muscle))
    for i in np.flatnonzero((steps["force"] < 0.0) & (length > SLENDER * 2.0 * r)):
        held = (np.asarray(values[i]) for values in (theta, steps["force"], steps["pressure"]))
        load[i] = column_load(length[i], float(_stiffness(middle_of, *held)))
    hit = -steps["force"] > NEAR * load
    if not hit.any():
        return []
    k = int(np.flatnonzero(hit)[0])
    push, bears = show(-float(steps["force"][k]), "N", 3), show(max(float(load[k]), 0.0), "N", 3)
    said = f"it pushes with {push}, and bows like a column from about {bears} (a quarter where the fittings can swivel)"
    return _first(hit, steps, f"{said}, which the model ignores: guide it, or push less")


def breaking(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """Fibre tension above the breaking force that was given."""
    strength = muscle.braid.fibre.breaking_force
    if strength is None:
        return []
    hit = (fields["fibre_tension"] > strength).any(axis=1)
    if not hit.any():
        return []
    peak = float(np.nanmax(fields["fibre_tension"][int(np.flatnonzero(hit)[0])]))
    factor = f"{show(peak, 'N', 3)}, a safety factor of {strength / peak:.2g}"
    return _first(hit, steps, f"the fibre tension exceeds the breaking force of {show(strength, 'N', 4)}: {factor}")


def apart(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """A chamber inside the braid that would not touch it; the paper's is part of the mesh and has no such states."""
    if muscle.chamber is None or not muscle.chamber.inside or muscle.chamber.gap:
        return []
    least = fields["contact_pressure"].min(axis=1)
    states = np.flatnonzero(least < -TOUCHING)
    if not len(states):
        return []
    k = int(states[0])
    more = f" and {len(states) - 1} more" if len(states) > 1 else ""
    touches = show(float(steps["pressure"][k] - least[k]), "Pa", 3)
    return [
        f"state {k} ({_place(steps, k)}){more}: the chamber would not touch the braid everywhere (dead zone), and the "
        f"model holds the two together; in the shape of state {k} it touches from about {touches}"
    ]


class Spanned(NamedTuple):
    """A wall over the openings between fibres (states, places)."""

    width: np.ndarray  #: of the openings [m]
    wall: np.ndarray  #: its thickness [m]
    bears: np.ndarray  #: pressure at which it bulges by half a circle [Pa], infinite where it does not touch the mesh


def stiffness(muscle: Muscle) -> float | None:
    """Shear modulus [Pa] of a wall that fibres of known diameter carry; None where there is none such."""
    chamber = muscle.chamber
    if chamber is None or not chamber.inside or muscle.braid.fibre.diameter is None:
        return None
    modulus: float | None = getattr(chamber.law, "shear_modulus", None)
    return modulus


def bearable(muscle: Muscle, fields: Columns) -> Spanned | None:
    """Of a wall inside the braid, which fibres carry; None where it is another or its stiffness is not known."""
    chamber, braid, diameter, modulus = muscle.chamber, muscle.braid, muscle.braid.fibre.diameter, stiffness(muscle)
    if chamber is None or diameter is None or modulus is None:
        return None
    width = np.maximum(across(fields["r"], fields["theta"], braid.fibres) - diameter, 1e-9 * braid.radius)
    wall = chamber.wall_thickness * fields["stretch_thickness"]
    bears = bulging_pressure(width, wall, modulus)
    if chamber.gap:
        bears = np.where(fields["contact_pressure"] > 0.0, bears, np.inf)
    return Spanned(width, wall, bears)


def bulging(muscle: Muscle, steps: Columns, fields: Columns) -> list[str]:
    """A wall inside the braid that bulges through the openings between fibres by more than half a circle."""
    found = bearable(muscle, fields)
    if found is None:
        return []
    width, wall, bears = found
    hit = steps["pressure"] > bears.min(axis=1)
    if not hit.any():
        return []
    k = int(np.flatnonzero(hit)[0])
    j = int(np.nanargmin(bears[k]))
    numbers = ((wall[k, j], "m"), (width[k, j], "m"), (bears[k, j], "Pa"))
    there, through, least = (show(float(number), unit, 2) for number, unit in numbers)
    said = (
        f"the wall, {there} there, bulges by half a circle and more through the openings of {through} between fibres, "
        f"from about {least} on: it may burst; a thicker or stiffer wall, or a denser braid, prevents it"
    )
    return _first(hit, steps, said)


def strong(steps: Columns) -> list[str]:
    """A pressure that no muscle was built for, so that most likely the unit is wrong."""
    said = f"the pressure is above {show(STRONG, 'Pa')}, more than built muscles hold; the model knows no bursting"
    return _first(steps["pressure"] > STRONG, steps, said)


def _first(hit: Any, steps: Columns, said: str) -> list[str]:
    states = np.flatnonzero(hit)
    if not len(states):
        return []
    k = int(states[0])
    return [f"from state {k} ({_place(steps, k)}) on: {said}"]


def _place(steps: Columns, k: int) -> str:
    return f"{show(float(steps['length'][k]), 'm', 4)}, {show(float(steps['pressure'][k]), 'Pa', 4)}"
