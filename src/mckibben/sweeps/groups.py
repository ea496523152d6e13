"""From the designs of a chunk to groups that a batch can take: their numbers as arrays, without an object for each.

Designs that differ in numbers alone make a group. Its choices go through the specification once, by the first of them;
the numbers of all are then put into its leaves at once. What involves several fields is checked for all at once, too: a
design that is not certainly valid is left to the specification, which says what is wrong with it.
"""

from __future__ import annotations

from typing import Any

import attrs
import jax
import numpy as np

from mckibben.discretise.spectral import Line
from mckibben.model.parameters import Parameters, numbers
from mckibben.model.profile import extremes
from mckibben.solver.bench import jumps
from mckibben.spec import (
    Along,
    Bellows,
    BlockedForce,
    Braid,
    CustomLaw,
    Ends,
    Muscle,
    Path,
    Protocol,
    SpecError,
    Step,
    Test,
)
from mckibben.spec import numbers as leaves_of
from mckibben.spec.angle import from_parallels
from mckibben.spec.angle_profile import certainly_rises
from mckibben.spec.end_radii import certainly_held
from mckibben.spec.limits import FLATTEST, certainly_fits
from mckibben.spec.vary import changed
from mckibben.sweeps.plan import Piece

__all__ = ["Group", "group_of", "grouped", "groups", "surely_reached", "with_arrays"]

NEAR_EXTENSION = 0.98
"""Share of a length surely below full extension from which on a design is solved singly."""
FITS = 1.0 - 1e-9
"""Share of the room at which fibres certainly fit side by side."""
_MAKE_THE_LENGTH = {"braid.length", "fittings.dead_length"}
"""What the length between the fittings as made consists of."""


@attrs.frozen
class Group:
    """Designs that a batch can take together: they differ in numbers alone."""

    index: np.ndarray  #: (designs) which designs of the chunk they are
    p: Parameters  #: each number an array (designs)
    line: Line  #: of one unknown, with what the fibres may do
    held: tuple[str, str]
    wanted: np.ndarray  #: (designs, n, 2) in SI units
    corners: np.ndarray  #: (designs, c, 3) length, force, pressure, for the placement of points

    def __len__(self) -> int:
        return len(self.index)

    def take(self, some: np.ndarray) -> Group:
        """Some of the designs."""
        p = jax.tree.map(lambda values: values[some], self.p)
        return attrs.evolve(self, index=self.index[some], p=p, wanted=self.wanted[some], corners=self.corners[some])


def groups(piece: Piece) -> list[Group]:
    """The designs of a chunk that batches can take; what is in none of them is for the single solver."""
    split = [tuple(_parts(value) for value in row) for row in piece.rows]
    kinds: dict[Any, list[int]] = {}
    for k, row in enumerate(split):
        kinds.setdefault(tuple(kind for kind, _ in row), []).append(k)
    found = []
    for members in kinds.values():
        try:
            base = changed(piece.muscle, piece.test, dict(zip(piece.fields, piece.rows[members[0]], strict=True)))
            values = {
                name: np.array([split[k][column][1] for k in members], float)
                for column, name in enumerate(piece.fields)
                if split[members[0]][column][1]
            }
            made = grouped(*base, values, np.array(members))
        except (SpecError, ValueError, ArithmeticError):  # the first may be wrong where others are not
            continue
        if made is not None:
            found.append(made)
    return found


def group_of(muscle: Muscle, test: Test) -> Group | None:
    """One design alone; None where only the single solver will do."""
    try:
        return grouped(muscle, test, {}, np.zeros(1, int))
    except (SpecError, ValueError, ArithmeticError):
        return None


def _parts(value: Any) -> tuple[Any, tuple[float, ...]]:
    """What a value is beside its numbers, and its numbers."""
    if isinstance(value, Path):
        return (Path, value.mode, value.unit, len(value.waypoints)), tuple(value.waypoints)
    if type(value) in (int, float):
        return float, (value,)
    if isinstance(value, Braid):  # equal braids may mean another angle by the same number
        return (value, value.measured_from), ()
    try:
        hash(value)
    except TypeError:
        return id(value), ()
    return value, ()


def grouped(muscle: Muscle, test: Test, values: dict[str, np.ndarray], index: np.ndarray) -> Group | None:
    """Designs like one, with some numbers (designs, how many) anew; those that are not certainly valid are left out."""
    resized = not _MAKE_THE_LENGTH.isdisjoint(values)
    if isinstance(test, BlockedForce) and test.length is None and resized:
        return None  # the length held is the muscle's own
    relative = any(
        step.length is not None and step.length.unit != "m"
        for step in getattr(test, "steps", (test,))
        if hasattr(step, "length")
    )
    if any(name.endswith(".contraction") for name in values) or (relative and resized):
        return None  # so it is here
    if muscle.friction is not None:
        return None  # each state depends on the one before, point by point
    steps = test.as_steps(muscle)
    if muscle.end_radii is not None and any(getattr(steps[0], name).needs_present for name in steps[0].controls):
        return None  # where it begins has to be found first
    held = tuple(str(name) for name in steps[0].controls)
    if held[1:] != ("pressure",) or any(not _followed(step, held) for step in steps):
        return None
    if muscle.ends == Ends.FREE and held[0] == "force":  # nearly singular: Newton without a search does not settle
        return None
    several = with_arrays(muscle, values)
    if several is None:
        return None
    count = len(index)
    valid = np.broadcast_to(_valid(several), (count,))
    p: Parameters = jax.tree.map(lambda x: np.array(np.broadcast_to(np.asarray(x, float), (count,))), numbers(several))
    valid = valid & ~jumps(p)
    if p.profile is not None:
        low, high = extremes(p)
        room = 2.0 * np.pi * p.R0 * np.sin(low)
        diameter = several.braid.fibre.diameter
        valid = valid & (np.minimum(np.sin(low), np.cos(high)) > FLATTEST) & (low > 0.0) & (high < 0.5 * np.pi)
        valid = valid & (diameter is None or 0.5 * p.N * diameter <= FITS * room)
    present = {"length": p.rest, "force": np.zeros(count), "pressure": np.zeros(count)}
    rows, corners = [], []
    for k, step in enumerate(steps):
        place = f"test.steps.{k}" if isinstance(test, Protocol) else "test"
        knots = {name: _knots(getattr(step, name), values.get(f"{place}.{name}"), present[name]) for name in held}
        rows.append(np.stack([getattr(step, name).weights(step.points) @ knots[name] for name in held], axis=-1))
        corners.append(_corners(step, held, knots, p, count))
        present |= {name: knots[name][-1] for name in held}
    wanted = np.moveaxis(np.concatenate(rows), 1, 0)
    if held[0] == "length":
        valid = valid & (wanted[:, :, 0].max(axis=1) <= NEAR_EXTENSION * surely_reached(p, str(muscle.ends)))
    made = Group(index, p, Line.of(muscle, 1), (held[0], held[1]), wanted, np.concatenate(corners, axis=1))
    return made.take(np.flatnonzero(valid)) if valid.any() else None


def _followed(step: Step, held: tuple[str, ...]) -> bool:
    """Whether a batch can follow a step: its values in turn, with the same held as in the steps before."""
    return step.gas is None and step.along == Along.VALUES and tuple(str(name) for name in step.controls) == held


def with_arrays(muscle: Muscle, values: dict[str, np.ndarray]) -> Muscle | None:
    """The muscle with arrays for some of its numbers; None for a field that is no single number of it."""
    names = [name for name, _, _ in leaves_of(muscle)]
    leaves, tree = jax.tree.flatten(muscle)
    for name, numbers_of in values.items():
        if name.startswith("test."):
            continue
        if name not in names:
            return None
        given = numbers_of[:, 0]
        if name == "braid.angle":  # the leaf is from the parallels, what is given from what the muscle's own was
            given = from_parallels(given, muscle.braid.measured_from)
        leaves[names.index(name)] = given
    made: Muscle = jax.tree.unflatten(tree, leaves)
    return made


def _valid(muscle: Muscle) -> Any:
    """Whether what involves several numbers certainly goes together, as the specification would find."""
    braid, diameter = muscle.braid, muscle.braid.fibre.diameter
    good: Any = np.asarray(braid.fibres) % 2 == 0
    if diameter is not None:
        room = 2.0 * np.pi * braid.radius * np.sin(braid.angle)
        good = good & (0.5 * np.asarray(braid.fibres) * diameter <= FITS * room)
    if braid.angle_profile is not None:
        good = good & certainly_rises(braid.angle_profile)
    if muscle.end_radii is not None:
        good = good & certainly_held(braid, muscle.end_radii)
    if muscle.chamber is not None:
        good = good & certainly_fits(braid, muscle.chamber)
    if muscle.chamber is not None and not isinstance(muscle.chamber.law, (CustomLaw, Bellows)):
        good = good & (np.asarray(muscle.chamber.law.shear_modulus) > 0.0)
    return good


def _knots(path: Path, varied: np.ndarray | None, present: np.ndarray) -> np.ndarray:
    """Numbers (k, designs) between which a controlled quantity goes, from the present one on where it is needed."""
    count = len(present)
    given = np.tile(np.array(path.waypoints, float), (count, 1)).T if varied is None else varied.T
    return np.concatenate([present[None], given]) if path.needs_present else given


def _corners(step: Step, held: tuple[str, ...], knots: dict[str, np.ndarray], p: Parameters, count: int) -> np.ndarray:
    """(length, force, pressure) at the ends of what is held, as for a single run; NaN for what is not."""
    known = {name: knots[name][int(getattr(step, name).needs_present) :] for name in held}
    none = np.full((1, count), np.nan)
    lengths, forces, pressures = (known.get(name, none) for name in ("length", "force", "pressure"))
    lengths = lengths if len(lengths) else none
    forces = forces if len(forces) else none
    pressures = pressures if len(pressures) else np.zeros((1, count))
    if np.isnan(lengths).all() and np.isnan(forces).all():
        lengths = p.rest[None]
    return np.array([[h, F, P] for h in lengths for F in forces for P in pressures]).transpose(2, 0, 1)


def surely_reached(p: Parameters, ends: str) -> np.ndarray:
    """A length [m] below full extension (theory page): that of a long muscle less what its two ends take."""
    fibre = p.H0 / np.sin(p.theta0)
    if p.endless:
        return np.full_like(fibre, np.inf)
    if ends == Ends.FREE:
        return np.asarray(fibre + (p.rest - p.H0))
    if p.end_radii is not None:
        widest = p.R0 / np.cos(p.theta0)
        takes = sum(widest - np.sqrt(widest**2 - radius**2) for radius in (p.end_radii[0], p.end_radii[-1]))
        return np.asarray(fibre - takes + (p.rest - p.H0))
    held = np.maximum(fibre - 2.0 * p.R0 / np.cos(p.theta0) * (1.0 - np.sin(p.theta0)), p.H0)
    return held + (p.rest - p.H0)
