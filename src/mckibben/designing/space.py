"""What is free in a design: numbers with ranges, whole numbers, and choices from lists."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from operator import attrgetter
from typing import Any

import attrs
import numpy as np

from mckibben.fitting.free import Free, free_numbers, put_in
from mckibben.spec import FreeContraction, Muscle, SpecError
from mckibben.spec.change import changed_muscle
from mckibben.spec.plausible import trusted
from mckibben.spec.vary import declared_at, full_name
from mckibben.sweeps.varied import from_lists
from mckibben.units import show

__all__ = ["Axis", "Space", "space_of"]

_ANY = FreeContraction(pressure=0.0)
"""Fields of a muscle are looked up beside a test; any will do."""
MOST = 10_000
"""Most options of one field."""


@attrs.frozen(eq=False)
class Axis:
    """One field that is free: a number in a range, or one of some options."""

    name: str
    number: Free | None
    options: tuple[Any, ...] = ()  #: where it is no number in a range: whole numbers, SI floats, words or parts
    unit: str = ""
    display: str = ""
    meaning: str = ""

    @property
    def smooth(self) -> bool:
        """Whether a little more of it can be had."""
        return self.number is not None

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the search goes: from 0 to 1, or over the places of the options."""
        return (0.0, 1.0) if self.smooth else (0.0, float(len(self.options) - 1))

    @property
    def numeric(self) -> bool:
        """Whether designs that differ in it go through one batch."""
        return self.smooth or all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in self.options)

    def value(self, x: float) -> Any:
        """What the field is at a place of the search."""
        if self.number is not None:
            return self.number.value(float(np.clip(x, 0.0, 1.0)))
        return self.options[int(np.clip(round(x), 0, len(self.options) - 1))]

    def text(self, value: Any) -> str:
        """A value of it as people read it."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return "none" if value is None else str(value)
        return str(value) if isinstance(value, int) else show(value, self.display or self.unit or "1", 5)

    @property
    def searched(self) -> str:
        """Where it was looked for, in words."""
        if self.number is not None:
            return f"{self.number.text(self.number.low)} to {self.number.text(self.number.high)}"
        if len(self.options) > 3 and all(type(one) is int for one in self.options):
            return f"{self.options[0]} to {self.options[-1]}, {len(self.options)} of them"
        return ", ".join(self.text(one) for one in self.options[:8]) + (", ..." if len(self.options) > 8 else "")


Members = tuple[Muscle, dict[str, np.ndarray], np.ndarray]


@attrs.frozen(eq=False)
class Space:
    """All designs that may be: the muscle that is given, and what is free in it."""

    muscle: Muscle
    axes: tuple[Axis, ...]

    @property
    def smooth(self) -> np.ndarray:
        """Which axes are numbers in ranges."""
        return np.array([axis.smooth for axis in self.axes])

    @property
    def bounds(self) -> np.ndarray:
        """Lower and upper ends (axes, 2) of the search."""
        return np.array([axis.bounds for axis in self.axes])

    def settled(self, x: np.ndarray) -> np.ndarray:
        """Places (designs, axes) inside the bounds, and whole where only options are."""
        low, high = self.bounds.T
        inside = np.clip(x, low, high)
        return np.where(self.smooth, inside, np.round(inside))

    def values(self, x: np.ndarray) -> tuple[Any, ...]:
        """What is free at one place (axes)."""
        return tuple(axis.value(float(at)) for axis, at in zip(self.axes, x, strict=True))

    def muscle_at(self, x: np.ndarray) -> Muscle:
        """The design at one place. SpecError where its values do not go together."""
        return self._changed(self.values(x))

    def _changed(self, values: tuple[Any, ...]) -> Muscle:
        listed = {axis.name: value for axis, value in zip(self.axes, values, strict=True) if not axis.smooth}
        smooth = tuple(axis.number for axis in self.axes if axis.number is not None)
        of_smooth = np.array([value for axis, value in zip(self.axes, values, strict=True) if axis.smooth])
        with trusted():
            given: dict[str, Any] = listed
            if not smooth:
                made: Muscle = changed_muscle(self.muscle, given)
                return made
            plain = {one.name: value for one, value in zip(smooth, of_smooth.tolist(), strict=True)
                     if not one.name.endswith("]") and ".constants." not in one.name}  # fmt: skip
            made = changed_muscle(self.muscle, given | plain)  # together: more fibres may fit only if they are thinner
            rest = [k for k, one in enumerate(smooth) if one.name not in plain]
            return put_in(made, tuple(smooth[k] for k in rest), of_smooth[rest]) if rest else made

    def kinds(self, x: np.ndarray) -> Iterator[Members]:
        """Designs that differ in numbers alone: a muscle, the numbers (designs, 1) by field, and which designs."""
        chosen = [k for k, axis in enumerate(self.axes) if not axis.numeric]
        rows: dict[tuple[int, ...], list[int]] = {}
        for d, row in enumerate(np.round(x[:, chosen]).astype(int).tolist()):
            rows.setdefault(tuple(row), []).append(d)
        for members in rows.values():
            base = self._first(x[members])
            if base is None:
                continue
            index = np.array(members)
            values = {
                axis.name: np.array([[float(axis.value(float(at)))] for at in x[index, k]])
                for k, axis in enumerate(self.axes)
                if axis.numeric
            }
            yield base, values, index

    def _first(self, x: np.ndarray) -> Muscle | None:
        """The first of some designs whose values go together."""
        for row in x:
            try:
                return self.muscle_at(row)
            except SpecError:
                continue
        return None


def space_of(muscle: Muscle, free: Mapping[str, Any]) -> Space:
    """What is free, from names and ranges or lists. SpecError for a name, range or list that cannot be."""
    if not isinstance(free, Mapping) or not free:
        advice = 'such as free={"braid.angle": "55 deg to 70 deg"}'
        raise SpecError("free", free, "must name at least one field and its range or list", advice)
    every = [one for name, given in free.items() for one in _each(muscle, full_name(str(name)), given)]
    axes = tuple(_axis(muscle, name, given) for name, given in every)
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise SpecError(f"free.{name}", allowed="is given twice")
        for other in names:
            if name.startswith(f"{other}."):
                raise SpecError(f"free.{name}", allowed=f"lies within {other}, which is chosen from a list",
                                advice="free one of them")  # fmt: skip
    return Space(muscle, axes)


def _each(muscle: Muscle, name: str, given: Any) -> list[tuple[str, Any]]:
    """A name with its range or list; that of a list of numbers with a range stands for each of its numbers."""
    if isinstance(given, (list, Mapping)) or "[" in name or name.startswith("test.") or ".constants." in name:
        return [(name, given)]
    count = len(attrgetter(name)(muscle) or ()) if _declared(muscle, name).kind == "quantities" else 0
    return [(f"{name}[{k}]", given) for k in range(count)] or [(name, given)]


def _axis(muscle: Muscle, name: str, given: Any) -> Axis:
    if name.startswith("test."):
        raise SpecError(f"free.{name}", allowed="is no field of a muscle", advice="measures have the pressures")
    if isinstance(given, list) or (isinstance(given, Mapping) and "points" in given):
        return _listed(muscle, name, given)
    if "[" not in name and ".constants." not in name:
        declared = _declared(muscle, name)
        if declared.kind == "count":
            return _listed(muscle, name, _whole(name, given))
        if declared.kind != "quantity":
            raise SpecError(f"free.{name}", given, "is no number: it needs a list to choose from")
    (number,) = free_numbers(muscle, {name: given}, {})
    return Axis(name, number, (), number.unit, number.display, number.meaning)


def _declared(muscle: Muscle, name: str) -> Any:
    try:
        return declared_at(muscle, _ANY, name)
    except SpecError as error:
        raise error.renamed(f"free.{name}") from error


def _listed(muscle: Muscle, name: str, given: Any) -> Axis:
    if not len(given):
        raise SpecError(f"free.{name}", given, "must hold at least one option")
    try:
        (varied,) = from_lists(muscle, _ANY, {name: given})
    except SpecError as error:
        raise error.renamed(f"free.{error.field.removeprefix('over.')}") from error
    if len(varied.values) > MOST:
        raise SpecError(f"free.{name}", allowed=f"has {len(varied.values):,} options: at most {MOST:,} are taken")
    declared = _declared(muscle, name)
    return Axis(name, None, varied.values, declared.unit, declared.display, declared.meaning)


def _whole(name: str, given: Any) -> list[int]:
    """The whole numbers of a range; fibres are even."""
    ends = given.split(" to ") if isinstance(given, str) else given
    advice = 'such as "24 to 96", or a list of them'
    try:
        low, high = (int(str(end)) for end in ends)
    except (TypeError, ValueError):
        raise SpecError(f"free.{name}", given, "must be a range of whole numbers", advice) from None
    if not low < high:
        raise SpecError(f"free.{name}", given, "must go from the smaller number to the larger one")
    if high - low > 2 * MOST:
        raise SpecError(f"free.{name}", given, f"has too many numbers: at most {MOST:,} are taken")
    step = 2 if name == "braid.fibres" else 1
    return list(range(low + (low % 2 if step == 2 else 0), high + 1, step))
