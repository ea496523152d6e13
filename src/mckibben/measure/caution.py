"""`cautions()`: what a real muscle may do that is not in the model, told before solving or with the result."""

from functools import partial
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.measure.signs import after, strong
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.gap import contact_of, inflated
from mckibben.model.kinematics import height_rate, radius, volume_rate
from mckibben.model.parameters import Number, Parameters, parameters
from mckibben.model.point import Point
from mckibben.model.profile import evened
from mckibben.model.wall import chamber_pull, chamber_stretches, contact_pressure
from mckibben.model.wrinkling import wrinkling
from mckibben.spec import Muscle, SpecError, Step
from mckibben.spec.winding import fibre_length
from mckibben.units import show


class MuscleWarning(UserWarning):
    """The result stands, but a real muscle may not follow the model there.

    A UserWarning that `run` gives for each caution: a thick wall, fibres that touch, a slender muscle in compression, a
    fibre that breaks. The result carries them as `cautions`; `solve` does not warn, its state carries them too.

    >>> import warnings
    >>> warnings.simplefilter("ignore", mk.MuscleWarning)
    >>> thick = mk.presets.paper().replace("chamber.thickness", "4 mm")
    >>> mk.run(thick, mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)).cautions
    ('chamber.thickness is 0.32 of the radius: the model takes the wall as thin (below 0.2)',)
    """


THICK_WALL = 0.2
"""Wall over radius above which a thin wall is a coarse assumption: stretches vary by about this much across it."""


def cautions(muscle: Muscle, *, length: Any, pressure: Any) -> tuple[str, ...]:
    """Cautions about a target before anything is solved, by the uniform cylinder of that length that does not stretch.

    Of a programmed braid it is the cylinder of one angle whose fibres are as long.

    Thick wall, wrinkling, jammed fibres, a column that bows, fibre tension above the breaking force if one is given, a
    pressure above 100 bar, and of a chamber inside the braid a pressure too low for it to touch the braid, or so high
    that it bulges through between the fibres. A result carries the cautions of its own states.

    Args:
        muscle: the specification.
        length: distance between the fittings [m], a number or text with a unit.
        pressure: gauge pressure [Pa], likewise.

    Returns:
        A tuple of sentences; empty if there is nothing to say.

    Raises:
        SpecError: for a length or pressure that is not one value in range.

    >>> thick = mk.presets.paper().replace("chamber.thickness", "4 mm")
    >>> mk.cautions(thick, length="115 mm", pressure="1 bar")
    ('chamber.thickness is 0.32 of the radius: the model takes the wall as thin (below 0.2)',)
    """
    step = Step(length=length, pressure=pressure)
    if step.points != 1 or any(getattr(step, name).needs_present for name in step.controls):
        raise SpecError("cautions", allowed="length and pressure must be one value each")
    h, P = (float(getattr(step, name).waypoints[0]) for name in ("length", "pressure"))
    p = evened(parameters(muscle))
    longest = fibre_length(muscle.braid)
    if p.endless and float(p.active(h)) >= longest:  # no such cylinder: a result tells more
        return (*thick_wall(muscle), *strong({"length": np.array([h]), "pressure": np.array([P])}))
    cylinder = predicted(p, np.asarray(h), np.asarray(P))
    force = float(cylinder.force)
    steps = {name: np.array([float(value)]) for name, value in (("length", h), ("pressure", P), ("force", force))}
    of = {
        "theta": cylinder.theta,
        "r": cylinder.r,
        "fibre_tension": cylinder.pull,
        "contact_pressure": cylinder.contact,
        "stretch_thickness": cylinder.thickness,
    }
    fields = {name: np.array([[float(value)]]) for name, value in of.items()}
    return (*before(muscle, h, P), *after(muscle, steps, fields))


class Predicted(NamedTuple):
    """What the uniform cylinder of the target length says."""

    index: Number  #: of wrinkling
    wave: Number  #: its length [m]
    theta: Number  #: braid angle [rad]
    r: Number  #: radius [m]
    force: Number  #: [N]
    pull: Number  #: tension of a fibre [N]
    contact: Number  #: pressure of the chamber on the mesh [Pa]
    thickness: Number  #: stretch of the wall's thickness


@partial(kernel, static_argnums=())
def predicted(p: Parameters, length: Array, pressure: Array) -> Predicted:
    """The cylinder of a given length [m] at a gauge pressure [Pa]."""
    theta = cylinder_angle(length, p)
    at, force = inflated(Point.cylinder(theta), pressure, p), cylinder_force(theta, pressure, p)
    r = radius(at, p)
    area = jnp.pi * r**2 if at.blown is None else volume_rate(at, p) / height_rate(at, p)
    pull = (force + area * pressure - chamber_pull(at, p)) / (p.N * jnp.sin(theta))
    contact = contact_pressure(at, pressure, p) if at.blown is None else contact_of(at, pressure, p)[2]
    thickness = chamber_stretches(at, p)[2]
    return Predicted(*wrinkling(length, pressure, p), theta, r, force, pull, contact, thickness)


def before(muscle: Muscle, length: float | None, pressure: float) -> list[str]:
    """Cautions that a result cannot tell: wall thickness, and wrinkling of the cylinder of the target length [m]."""
    notes = thick_wall(muscle)
    if length is not None:
        found = predicted(evened(parameters(muscle)), np.asarray(length), np.asarray(pressure))
        index, wave = float(found.index), float(found.wave)
        if index < -1.0:
            at = f"{show(length, 'm', 4)} and {show(pressure, 'Pa', 4)}"
            notes.append(
                f"a tube of this kind is expected to wrinkle at {at} (index {index:.2f}, below -1), in waves of about "
                f"{show(wave, 'm', 2)}: more pressure or stiffer fibres prevent it"
            )
    return notes


def thick_wall(muscle: Muscle) -> list[str]:
    """The chamber's wall against the thin-wall assumption, where it is made."""
    chamber = muscle.chamber
    if chamber is None or chamber.thick or chamber.wall_thickness is None:
        return []
    ratio = chamber.wall_thickness / chamber.riding_radius(muscle.braid.radius)
    if ratio <= THICK_WALL:
        return []
    if chamber.thickness is None:
        return [
            f"the wall of the tube is {ratio:.2f} of its outer radius: it is taken as thin (below {THICK_WALL:g}) "
            'without wall = "thick"'
        ]
    return [f"chamber.thickness is {ratio:.2f} of the radius: the model takes the wall as thin (below {THICK_WALL:g})"]
