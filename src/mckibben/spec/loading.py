"""What a lab holds and varies in a test.

A `Step` controls two quantities, each along a `Path`; a test is one step or several.
Signs: force > 0 pulls the fittings together; pressure is gauge.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any, ClassVar

import attrs
import numpy as np

from mckibben.spec.constants import ATMOSPHERE
from mckibben.spec.contraction import lengths, takes_contraction
from mckibben.spec.declared import Declared, Reads, declare, evolved
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import check_size, choice, count, spec
from mckibben.spec.muscle import Muscle
from mckibben.spec.path import Path, PathMode
from mckibben.spec.plausible import CONTROLLED, reading
from mckibben.units import DISPLAY, UnitError, is_traced

__all__ = [
    "TESTS",
    "BlockedForce",
    "FreeContraction",
    "Isobaric",
    "Isometric",
    "Isotonic",
    "Protocol",
    "Step",
    "Test",
]

HIGHEST = 1e9
"""Highest gauge pressure taken [Pa]: 10,000 bar, ten times what any vessel of a workshop holds."""


def _read_path(value: Any, field: str, declared: Declared) -> Path:
    try:
        as_contraction = isinstance(value, Path) and value.unit == "1" and declared.unit == "m"
        path = value if as_contraction else Path.parse(value, declared.unit)
    except UnitError as error:
        raise SpecError(field, value, str(error), error.advice) from error
    given = () if isinstance(value, Path) else value if isinstance(value, (list, tuple, np.ndarray)) else (value,)
    meant = reading(list(given), declared.unit, declared.doubt)
    for waypoint in path.waypoints:
        if not is_traced(waypoint) and not as_contraction and not declared.contains(waypoint):
            raise SpecError(field, value, f"must be {declared.allowed}", meant or declared.advice)
        if not as_contraction and not meant:
            check_size(waypoint, value, field, declared)
    if meant:
        raise SpecError(field, value, "a number without a unit is in SI", meant)
    if declared.kind == "held" and path.mode != PathMode.CONSTANT:
        raise SpecError(field, value, "must be one value", f"this test holds its {field.rpartition('.')[2]}")
    return path


_QUANTITIES: dict[str, dict[str, Any]] = {
    "length": {
        "unit": "m", "meaning": "distance between the fittings", "low": 0.0, "low_open": True, "size": (1e-6, 1e3),
    },
    "force": {
        "unit": "N", "meaning": "axial force, > 0 where the muscle pulls its fittings together", "size": (0.0, 1e9),
    },
    "pressure": {
        "unit": "Pa", "meaning": "gauge pressure", "low": -ATMOSPHERE, "high": HIGHEST, "advice": "pressure is gauge",
    },
    "volume": {
        "unit": "m^3", "meaning": "volume inside the braid", "low": 0.0, "low_open": True, "size": (1e-18, 1e6),
    },
}  # fmt: skip


def controlled(name: str, *, held: bool = False, default: Any = attrs.NOTHING) -> Any:
    """A field for one of the controlled quantities; with `held` only one value is allowed."""
    display = DISPLAY.get(_QUANTITIES[name]["unit"], "")
    kind, doubt = "held" if held else "path", CONTROLLED.get(_QUANTITIES[name]["unit"])
    return declare(
        Declared(kind=kind, read=_read_path, default=default, display=display, doubt=doubt, **_QUANTITIES[name])
    )


DEFAULT_POINTS = 21
"""Number of states on a ramp: steps of 5 % of it."""


def points_field() -> Any:
    return count(
        meaning=f"number of states; by default {DEFAULT_POINTS} on a ramp, the length of a list, 1 if nothing varies",
        low=1, high=100_000, default=None, static=True,
    )  # fmt: skip


def _settle_points(test: Any) -> None:
    """Fill in the default number of points and check a given one against the paths."""
    names = [name for name in _QUANTITIES if getattr(test, name, None) is not None]
    paths = {name: getattr(test, name) for name in names}
    lists = {name: len(path.waypoints) for name, path in paths.items() if path.mode == PathMode.LIST}
    field = f"{test.__spec_path__}.points"
    if len(set(lists.values())) > 1:
        said = " and ".join(f"{name} lists {number} values" for name, number in lists.items())
        raise SpecError(test.__spec_path__, allowed=said, advice="give as many of each")
    fewest = max((path.fewest_points for path in paths.values()), default=1)
    points = test.points
    if points is None:
        varies = any(path.varies for path in paths.values())
        points = next(iter(lists.values()), max(DEFAULT_POINTS, fewest) if varies else 1)
    for name, number in lists.items():
        if points != number:
            raise SpecError(field, points, f"must be {number}, as many as {name} lists", "or leave points out")
    if points < fewest:
        raise SpecError(field, points, f"must be at least {fewest}, to visit every value named")
    object.__setattr__(test, "points", points)


class Gas(StrEnum):
    """A fixed amount of gas, sealed in as the step begins: slow (isothermal) or fast (adiabatic, n = 1.4)."""

    ISOTHERMAL = "isothermal"
    ADIABATIC = "adiabatic"


class Along(StrEnum):
    """How a step goes on: value by value, or along the branch of states, past limit points where the value turns."""

    VALUES = "values"
    BRANCH = "branch"


@takes_contraction
@spec("step")
class Step:
    """Part of a test with any two of length, force, pressure and volume controlled, or length or force and the gas.

    A step is a test by itself, or part of a `Protocol`. What is controlled goes along a path: one value ("1 bar", or a
    number in SI units), a ramp ("0 to 1 bar", "0 to 1 to 0 bar"), a list of values, and in a protocol from the present
    value ("to 20 N") or at it ("hold").

    Args:
        length: distance between the fittings [m], above 0; or contraction="10 %" in its place, 1 - h/H0.
        force: axial force [N], positive where the muscle pulls its fittings together.
        pressure: gauge pressure [Pa], not below minus one atmosphere (-101325 Pa) nor above 10,000 bar.
        volume: volume inside the braid [m^3], above 0.
        gas: "isothermal" or "adiabatic": the gas inside as the step begins is sealed in, and pressure and volume follow
            its law, with the volume of the air: that without rubber which lies inside. In place of one of the two
            quantities; the other is length or force.
        along: "values" (default): state by state at the values given. "branch": along the curve of states, also past
            limit points, where the value that is varied turns back.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 if nothing varies.

    Raises:
        SpecError: for a value out of range or without its unit, more or fewer than two controls, or points that do not
            visit every value named.

    >>> step = mk.Step(volume="27.5 mL", pressure="0 to 1 bar", points=3)
    >>> step.controls
    ('pressure', 'volume')
    """

    kind: ClassVar[str] = "step"
    length: Reads[Path | None] = controlled("length", default=None)
    force: Reads[Path | None] = controlled("force", default=None)
    pressure: Reads[Path | None] = controlled("pressure", default=None)
    volume: Reads[Path | None] = controlled("volume", default=None)
    gas: Reads[Gas | None] = choice(Gas, meaning="gas sealed in, in place of a pressure or volume", default=None)
    along: Reads[Along] = choice(
        Along, meaning="go value by value, or along the branch past limit points", default=Along.VALUES
    )
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        given = (*self.controls, *(("gas",) if self.gas is not None else ()))
        if len(given) != 2 or (self.gas is not None and given[0] not in ("length", "force")):
            said = f"{' and '.join(given) or 'nothing'} given"
            options = f"control exactly two of {', '.join(_QUANTITIES)}, or length or force and gas"
            raise SpecError("step", allowed=said, advice=options)
        varied = [name for name in self.controls if getattr(self, name).varies]
        if self.along == Along.BRANCH and (self.gas is not None or len(varied) != 1):
            raise SpecError("step.along", str(self.along), "needs one of two controlled quantities to vary")
        _settle_points(self)

    @property
    def controls(self) -> tuple[str, ...]:
        """The names of the controlled quantities: two, or one beside the gas."""
        return tuple(name for name in _QUANTITIES if getattr(self, name) is not None)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return (_in_lengths(self, muscle),)


def _in_lengths(step: Step, muscle: Muscle) -> Step:
    """A step with lengths in place of contractions, as they are for a muscle."""
    if step.length is None or step.length.unit == "m":
        return step
    return evolved(step, length=lengths(step.length, muscle.rest_length))


@takes_contraction
@spec("isometric")
class Isometric:
    """Length held, pressure varied.

    The paper's tests a and b (section III). It gives the force; pressures are visited in the order given.

    Args:
        length: distance between the fittings [m], one value; or contraction="10 %" in its place, 1 - h/H0.
        pressure: gauge pressure [Pa]: a ramp such as "0 to 1 bar", a list, or one value.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 for one value.

    Raises:
        SpecError: for a value out of range or without its unit, or a length that varies.

    >>> test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    >>> mk.run(mk.presets.paper(), test).force.round(2)  # N
    array([  3.29,  52.36, 101.22])
    """

    kind: ClassVar[str] = "isometric"
    length: Reads[Path] = controlled("length", held=True)
    pressure: Reads[Path] = controlled("pressure")
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        _settle_points(self)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return (_in_lengths(Step(length=self.length, pressure=self.pressure, points=self.points), muscle),)


@takes_contraction
@spec("isobaric")
class Isobaric:
    """Pressure held, length varied.

    It gives the force over the length, which is how a muscle's strength falls as it contracts.

    Args:
        pressure: gauge pressure [Pa], one value.
        length: distance between the fittings [m]: a ramp such as "115 mm to 60 mm", a list, or one value; or in its
            place contraction="0 to 25 %", 1 - h/H0.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 for one value.

    Raises:
        SpecError: for a value out of range or without its unit, or a pressure that varies.

    >>> test = mk.Isobaric(pressure="1 bar", length="115 mm to 105 mm", points=3)
    >>> mk.run(mk.presets.paper(), test).force.round(2)  # N
    array([101.22,  79.87,  61.77])
    """

    kind: ClassVar[str] = "isobaric"
    pressure: Reads[Path] = controlled("pressure", held=True)
    length: Reads[Path] = controlled("length")
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        _settle_points(self)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return (_in_lengths(Step(length=self.length, pressure=self.pressure, points=self.points), muscle),)


@spec("isotonic")
class Isotonic:
    """Force held (a hanging weight), pressure varied.

    It gives the length, and the contraction 1 - h/H0, over the pressure.

    Args:
        force: axial force [N], one value, positive for a weight that stretches the muscle.
        pressure: gauge pressure [Pa]: a ramp such as "0.2 to 1 bar", a list, or one value.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 for one value.

    Raises:
        SpecError: for a value out of range or without its unit, or a force that varies.

    >>> test = mk.Isotonic(force="20 N", pressure="0.2 to 1 bar", points=3)
    >>> (1e3 * mk.run(mk.presets.paper(), test).length).round(2)  # mm
    array([112.37,  95.5 ,  90.6 ])
    """

    kind: ClassVar[str] = "isotonic"
    force: Reads[Path] = controlled("force", held=True)
    pressure: Reads[Path] = controlled("pressure")
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        _settle_points(self)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return (Step(force=self.force, pressure=self.pressure, points=self.points),)


@takes_contraction
@spec("blocked-force")
class BlockedForce:
    """Length held at the braid's own (or another), pressure varied: the most the muscle can pull.

    Args:
        pressure: gauge pressure [Pa]: a ramp such as "0 to 1 bar", a list, or one value.
        length: distance between the fittings [m], one value; by default that of the muscle as made. Or
            contraction="10 %" in its place, 1 - h/H0.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 for one value.

    Raises:
        SpecError: for a value out of range or without its unit, or a length that varies.

    >>> test = mk.BlockedForce(pressure=["0.5 bar", "0.75 bar", "1 bar"])
    >>> mk.run(mk.presets.paper(), test).force.round(2)  # N
    array([3.33, 5.  , 6.66])
    """

    kind: ClassVar[str] = "blocked-force"
    pressure: Reads[Path] = controlled("pressure")
    length: Reads[Path | None] = controlled("length", held=True, default=None)
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        _settle_points(self)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        length = Path((muscle.rest_length,), unit="m") if self.length is None else self.length
        return (_in_lengths(Step(length=length, pressure=self.pressure, points=self.points), muscle),)


@spec("free-contraction")
class FreeContraction:
    """No force, pressure varied: how far the muscle shortens by itself.

    Args:
        pressure: gauge pressure [Pa]: a ramp such as "0 to 1 bar", a list, or one value.
        points: number of states; by default 21 on a ramp, as many as a list has, 1 for one value.

    Raises:
        SpecError: for a value out of range or without its unit.

    >>> test = mk.FreeContraction(pressure="0.2 to 1 bar", points=3)
    >>> mk.run(mk.presets.paper(), test).contraction.round(4)  # 1 - h/H0, positive where shorter
    array([0.0317, 0.0348, 0.0356])
    """

    kind: ClassVar[str] = "free-contraction"
    pressure: Reads[Path] = controlled("pressure")
    points: Reads[int] = points_field()

    def __attrs_post_init__(self) -> None:
        _settle_points(self)

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return (Step(force=0.0, pressure=self.pressure, points=self.points),)


def _read_steps(value: Any, field: str, declared: Declared) -> tuple[Step, ...]:
    if not isinstance(value, (list, tuple)) or not value:
        raise SpecError(field, value, "must be a list of one or more Step")
    for index, item in enumerate(value):
        if not isinstance(item, Step):
            raise SpecError(f"{field}[{index}]", item, "must be a Step")
    return tuple(value)


@spec("protocol")
class Protocol:
    """Several steps one after another, each starting where the last one ended.

    Args:
        steps: a list of one or more `Step`. Their paths may use the present value: "hold", or "to 20 N". After a step
            that cannot be finished no other is tried.

    Raises:
        SpecError: for an empty list, or anything in it that is not a Step.

    >>> inflate = mk.Step(length="115 mm", pressure="0 to 1 bar", points=3)
    >>> release = mk.Step(pressure="hold", length="to 105 mm", points=3)
    >>> mk.run(mk.presets.paper(), mk.Protocol([inflate, release])).force.round(2)  # N
    array([  3.29,  52.36, 101.22, 101.22,  79.87,  61.77])
    """

    kind: ClassVar[str] = "protocol"
    steps: Reads[tuple[Step, ...]] = declare(
        Declared(kind="steps", read=_read_steps, meaning="the steps, in order", parts=(Step,))
    )

    def as_steps(self, muscle: Muscle) -> tuple[Step, ...]:
        return tuple(_in_lengths(step, muscle) for step in self.steps)


Test = Isometric | Isobaric | Isotonic | BlockedForce | FreeContraction | Protocol | Step
TESTS: dict[str, type] = {
    test.kind: test for test in (Isometric, Isobaric, Isotonic, BlockedForce, FreeContraction, Protocol, Step)
}
"""The tests by their kind in files."""
