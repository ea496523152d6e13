"""What a muscle's forces differ from the measured ones by, and how that changes with the free numbers.

The search asks for it at points x between 0 and 1 for each number. States are followed from those of the last muscle;
where that fails they are sought anew, and a muscle that has none at some point gives NaN there, from which a search
takes a smaller step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

import attrs
import numpy as np

from mckibben.data.values import Data
from mckibben.fitting.forces import in_blocks
from mckibben.fitting.free import Free, OfFree, is_turned, put_in
from mckibben.fitting.states import fitting_problem, ordered, seek
from mckibben.measure.survey import errors
from mckibben.model.extension import longest_of
from mckibben.model.parameters import parameters
from mckibben.solver.problem import Problem
from mckibben.solver.system import Unknowns
from mckibben.spec import Muscle, SpecError
from mckibben.spec.declared import evolved, numbers

__all__ = ["Compared", "Misfit", "OfOneMuscle", "Points", "Seen"]


@attrs.frozen(eq=False)
class Points:
    """What is fitted: n points."""

    points: np.ndarray  #: length [m] and pressure [Pa] (n, 2)
    force: np.ndarray  #: (n) N
    tests: np.ndarray  #: (n) names of their tests
    branches: np.ndarray  #: (n) "loading", "unloading" or "unknown"
    weights: np.ndarray  #: (n)
    paths: np.ndarray  #: (n) which path each is on: one for every test of every set of data

    @classmethod
    def of(cls, muscle: Muscle, several: tuple[Data, ...], weights: Mapping[str, float]) -> Points:
        """Points of several sets of data, with weights by the names of tests, 1 where none is given."""
        parts = [
            (
                np.stack([data.lengths(muscle), data.pressure], axis=1),
                data.force,
                np.array([data.tests[k] for k in data.which]),
                data.branches.astype(str),
                data.which + sum(len(before.tests) for before in several[:k]),
            )
            for k, data in enumerate(several)
        ]
        points, force, tests, branches, paths = (np.concatenate(column) for column in zip(*parts, strict=True))
        by_test = np.array([float(weights.get(name, 1.0)) for name in tests.tolist()])
        return cls(points, force, tests, branches, by_test, paths)

    @classmethod
    def joined(cls, parts: Sequence[Points]) -> Points:
        """One after another."""
        return cls(*(np.concatenate([getattr(one, field.name) for one in parts]) for field in attrs.fields(cls)))

    def some(self, chosen: np.ndarray) -> Points:
        """Some of the points."""
        return Points(*(getattr(self, field.name)[chosen] for field in attrs.fields(Points)))


@attrs.frozen(eq=False)
class Seen:
    """At one x: forces of the model at the measured points, as an instrument shows them, and derivatives by x."""

    force: np.ndarray  #: (n)
    by: np.ndarray | Callable[[], np.ndarray]  #: (n, k), or what computes them where that takes long

    @cached_property
    def slopes(self) -> np.ndarray:
        """Derivatives (n, k)."""
        return self.by() if callable(self.by) else self.by

    @property
    def found(self) -> np.ndarray:
        """Which points have a state."""
        return np.isfinite(self.force)


@runtime_checkable
class Compared(Protocol):
    """What a search needs of a misfit."""

    @property
    def free(self) -> tuple[Free, ...]: ...

    @property
    def measured(self) -> Any:
        """With `force` (n), what is compared, and `weights` (n)."""

    @property
    def start(self) -> np.ndarray: ...

    def values(self, x: np.ndarray) -> np.ndarray: ...

    def __call__(self, x: np.ndarray) -> Seen: ...


class OfOneMuscle(OfFree):
    """What every misfit of one muscle has."""

    muscle: Muscle
    measured: Points

    @property
    def muscles(self) -> tuple[Muscle, ...]:
        """As given."""
        return (self.muscle,)

    @property
    def of(self) -> np.ndarray:
        """Which muscle each point is of."""
        return np.zeros(len(self.measured.force), int)

    def offset(self, values: np.ndarray, name: str) -> float:
        """What an instrument is off by."""
        return next((float(v) for one, v in zip(self.free, values, strict=True) if one.name == f"offset.{name}"), 0.0)

    def shift(self, values: np.ndarray) -> np.ndarray:
        """What is added to measured lengths [m] and pressures [Pa]."""
        return np.array([self.offset(values, "length"), self.offset(values, "pressure")])


@attrs.define(eq=False)
class Misfit(OfOneMuscle):
    """The model at measured points, for a search; it remembers the last states, and nothing that changes an answer."""

    muscle: Muscle
    free: tuple[Free, ...]
    measured: Points
    size: int
    orders: tuple[np.ndarray, ...] = attrs.field(init=False)
    places: tuple[int, ...] = attrs.field(init=False)
    problem: Problem | None = attrs.field(init=False, default=None)
    near: Unknowns | None = attrs.field(init=False, default=None)
    last: tuple[bytes, Seen] | None = attrs.field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        self.orders = ordered(self.measured.points, self.measured.tests, self.muscle.rest_length)
        leaves = [name for name, _, _ in numbers(self.muscle)]
        self.places = tuple(leaves.index(one.name) for one in self.free if one.name in leaves)

    @property
    def turned(self) -> np.ndarray:
        """Which numbers are the complement of what the muscle keeps (k)."""
        return np.array([is_turned(self.muscle, one.name) for one in self.free])

    def place_anew(self, x: np.ndarray, size: int | None = None) -> Problem:
        """Place the points for the muscle at x, on more unknowns if a size is given, and seek its states thoroughly."""
        self.size = size or self.size
        muscle, points = self._at(x)
        self.problem, longest = fitting_problem(muscle, points, self.size)
        states = seek(self.problem, longest, points, self.orders, thorough=True)
        self.near = states if np.isfinite(states.loads).all() else None
        self.last = None
        return self.problem

    def problem_at(self, x: np.ndarray) -> Problem:
        """The muscle at x on the present unknowns."""
        placed = self.problem or self.place_anew(x)
        return Problem.of(placed.basis, parameters(self._at(x)[0]), placed.b)

    @property
    def reached(self) -> bool:
        """Whether every point has a state on the present unknowns, as they were last placed."""
        return self.near is not None

    def error(self, x: np.ndarray) -> float:
        """Estimated relative error of the forces at x."""
        self(x)
        problem, near = self.problem_at(x), self.near
        return 0.0 if near is None else float(errors(problem, near.u, near.loads, ("length", "pressure")).max())

    def __call__(self, x: np.ndarray) -> Seen:
        """Forces and derivatives at x."""
        key = np.asarray(x, float).tobytes()
        if self.last is not None and self.last[0] == key:
            return self.last[1]
        try:
            seen = self._seen(np.asarray(x, float))
        except SpecError:  # numbers that do not go together, such as fibres that do not fit
            seen = self._nothing()
        self.last = (key, seen)
        return seen

    def _nothing(self) -> Seen:
        n, k = len(self.measured.force), len(self.free)
        return Seen(np.full(n, np.nan), np.full((n, k), np.nan))

    def _at(self, x: np.ndarray) -> tuple[Muscle, np.ndarray]:
        values = self.values(x)
        return put_in(self.muscle, self.free, values), self.measured.points + self.shift(values)

    def _seen(self, x: np.ndarray) -> Seen:
        muscle, points = self._at(x)
        if self.problem is None:
            self.problem = fitting_problem(muscle, points, self.size)[0]
        p, problem = parameters(muscle), self.problem
        longest = longest_of(p, problem.basis.ends)
        inside = points[:, 0] < longest
        if self.near is not None and inside.all():
            force, slopes, states, good = self._forces(x, self.near)
            if good.all():
                self.near = states
                return Seen(force, slopes)
        states = seek(self.problem_at(x), longest, points, self.orders)
        found = np.isfinite(states.loads).all(axis=1)
        if not found.any():
            return self._nothing()
        filler = int(np.flatnonzero(found)[0])
        rows = np.where(found, np.arange(len(found)), filler)
        force, slopes, states, good = self._forces(x, Unknowns(states.u[rows], states.loads[rows]), rows)
        missing = ~(found & good)
        if not missing.any():
            self.near = states
        force[missing], slopes[missing] = np.nan, np.nan
        return Seen(force, slopes)

    def _forces(self, x: np.ndarray, near: Unknowns, rows: Any = slice(None)) -> tuple[Any, ...]:
        values, points = self.values(x), self.measured.points[rows]
        n, problem = len(points), self.problem
        assert problem is not None
        own, turned = values[: len(self.places)], self.turned[: len(self.places)]
        leaves = np.where(turned, np.pi / 2.0 - own, own)
        plain = evolved(self.muscle, name=None, assumed=())
        free = np.concatenate([leaves, self.shift(values)])
        found = in_blocks(problem.basis, self.places, problem.b, plain, free, points, near)
        force, by = found.force + self.offset(values, "force"), found.slopes
        signed = by[:, : len(own)] * np.where(turned, -1.0, 1.0)
        columns = dict(zip((one.name for one in self.free[: len(own)]), signed.T, strict=True))
        columns |= {"offset.length": by[:, -2], "offset.pressure": by[:, -1], "offset.force": np.ones(n)}
        scaled = [columns[one.name] * one.slope(float(at)) for one, at in zip(self.free, x, strict=True)]
        return force, np.stack(scaled, axis=1), Unknowns(found.states.u, found.states.loads), found.good
