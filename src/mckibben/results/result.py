"""`Result` and `State`: immutable values around an xarray Dataset. Nothing here computes.

The variables of the Dataset are declared in `results/variables.py`.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.results.rows import COLUMNS, headed, rows
from mckibben.results.told import summary
from mckibben.results.variables import COORDINATES, OPTIONAL, STEP, VARIABLES, about_variable, dimensions, has
from mckibben.results.verdict import Modes, Verdict
from mckibben.shown import Shown
from mckibben.spec import Muscle, Test
from mckibben.spec.text import to_toml

if TYPE_CHECKING:
    import xarray as xr


@attrs.frozen(eq=False)
class Table:
    """The content of a Dataset as plain arrays, so that xarray is imported (half a second) only where it is needed."""

    steps: dict[str, np.ndarray]  #: per state (n)
    fields: dict[str, np.ndarray]  #: per state and point (n, q)
    v: np.ndarray  #: axial material coordinate (q) [m]
    attrs: dict[str, Any]  #: but what follows from the muscle and the test

    def __getitem__(self, name: str) -> np.ndarray:
        return self.v if name == "v" else np.asarray((self.steps if name in STEP else self.fields)[name])

    def dataset(self, about: dict[str, Any]) -> xr.Dataset:
        """The Dataset with all its attributes; its arrays are read-only."""
        return dataset(self.steps, self.fields, self.v, about)


def dataset(steps: dict[str, Any], fields: dict[str, np.ndarray], v: np.ndarray, about: dict[str, Any]) -> xr.Dataset:
    """The Dataset of a result; every declared variable must be given, but those that only some muscles have."""
    import xarray as xr  # here, because it takes half a second to import

    values = steps | fields | {"step": np.arange(len(steps["length"])), "v": v}
    variables: dict[str, Any] = {}
    for name in VARIABLES | COORDINATES:
        if name in OPTIONAL and name not in values:
            continue
        array = np.asarray(values[name])
        array.flags.writeable = False
        variables[name] = (dimensions(name), array, about_variable(name))
    return xr.Dataset(variables, attrs=about).set_coords(list(COORDINATES))


@attrs.frozen(eq=False)
class Result(Shown):
    """The states of one test: what was tested, and a Dataset of what was found.

    It is what `run` and `load` give, and never changes. Two results are equal if muscle, test and every number are.

    Args:
        muscle: the muscle that was tested.
        test: the test that was run.
        data: xarray Dataset over `step` (one entry per state) and `v` (points along the muscle, a coordinate [m] of the
            braid as made), in SI units; each variable has its `units` and `long_name`.

    `force` [N], `length` [m], `contraction`, `pressure` [Pa] and `volume` [m^3] are arrays of shape (states,), NaN for
    a state that was not reached; `verdict` has a word per state. Force is positive in tension, contraction 1 - h/H0
    where the muscle is shorter than made, pressure is gauge.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> curve.status, curve.verdict
    ('complete', ('stable', 'stable', 'stable'))
    >>> round(float(curve.data["fibre_tension"].isel(step=-1).max()), 2)  # N
    5.0
    """

    muscle: Muscle
    test: Test
    _given: Table | xr.Dataset = attrs.field(alias="data")

    @cached_property
    def data(self) -> xr.Dataset:
        """Dataset of everything known of the states."""
        return self._given.dataset(self.attributes) if isinstance(self._given, Table) else self._given

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the Dataset: title, muscle and test as TOML, versions, date, warnings and so on."""
        if isinstance(self._given, Table):  # written only where it is asked for
            return tested(self.muscle, self.test) | self._given.attrs
        return self._given.attrs

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result):
            return NotImplemented
        return self.muscle == other.muscle and self.test == other.test and self.data.identical(other.data)

    def __hash__(self) -> int:
        return hash((self.muscle, self.test))

    def __len__(self) -> int:
        return len(self.column("length"))

    def column(self, name: str) -> np.ndarray:
        """A variable as a plain read-only array: (states), (states, points along the muscle), or (points) for `v`."""
        values = np.asarray(self._given[name])
        values.flags.writeable = False
        return values

    @property
    def force(self) -> np.ndarray:
        """Axial force [N] per state, positive in tension; NaN where there is none."""
        return self.column("force")

    @property
    def length(self) -> np.ndarray:
        """Distance between the fittings [m] per state."""
        return self.column("length")

    @property
    def contraction(self) -> np.ndarray:
        """Contraction 1 - h/H0 per state."""
        return self.column("contraction")

    @property
    def pressure(self) -> np.ndarray:
        """Gauge pressure [Pa] per state."""
        return self.column("pressure")

    @property
    def volume(self) -> np.ndarray:
        """Volume inside the braid [m^3] per state."""
        return self.column("volume")

    @property
    def verdict(self) -> tuple[str, ...]:
        """Verdict per state."""
        return tuple(str(word) for word in self.column("verdict"))

    @property
    def cautions(self) -> tuple[str, ...]:
        """What a real muscle may do that the model does not know; each names the state from which it may."""
        return tuple(filter(None, self._given.attrs["warnings"].split("\n")))

    @property
    def reached(self) -> int:
        """Number of states with an equilibrium."""
        return int(self.column("converged").sum())

    @property
    def status(self) -> str:
        """complete, incomplete (some states have no admissible equilibrium or were not reached) or interrupted."""
        return str(self._given.attrs["status"])

    def to_pandas(self) -> Any:
        """DataFrame in SI units with a row per state; each head is a variable of `data` and its unit: "force [N]".

        >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
        >>> [round(force, 1) for force in curve.to_pandas()["force [N]"]]
        [11.5, 58.2, 101.2]
        """
        import pandas as pd

        frame = pd.DataFrame.from_records(list(rows(self)), index=pd.RangeIndex(len(self), name="state"))
        shown = [name for name in COLUMNS if has(self.muscle, name)]
        for name in shown:
            frame[name] = pd.to_numeric(frame[name]) if COLUMNS[name][0] else frame[name]  # None is NaN
        return frame[shown].rename(columns={name: headed(name, COLUMNS[name][0]) for name in shown})

    def __repr__(self) -> str:
        words = sorted(set(self.verdict))
        return f"<Result: {self.test.kind}, {len(self)} states, {self.reached} reached, {', '.join(words)}>"


@attrs.frozen(eq=False)
class State(Shown):
    """One state, sought directly: its numbers, verdict and, where it is no good, what there is instead.

    It is what `solve` gives, and never changes. `force` [N, positive in tension], `length` [m], `contraction`,
    `pressure` [Pa, gauge], `volume` [m^3] and `error_estimate` (relative) are numbers, NaN where there is no admissible
    state; `data` is the xarray Dataset of everything, along the points `v` of the muscle.

    Args:
        result: the `Result` that holds the one state.
        verdict: "stable", "unstable", "inadmissible", "no equilibrium" or "not converged".
        reason: why, in a sentence.
        modes: numbers of negative (unstable) modes under length control, under force control, and antisymmetric ones.
        last_good: the last stable state on the way, where none was found at the target; a State, or None.
        asymmetric: the stable state that an antisymmetrically unstable one goes to; a State, or None.
        force_interval: with friction, the forces [N] as the muscle shortens and as it lengthens; the state itself is
            that without friction, because what there is with it depends on the path. None without friction.

    >>> state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> round(state.force, 2), state.verdict == "stable", state.modes.length_control
    (101.22, True, 0)
    """

    result: Result
    verdict: Verdict  #: compares equal to its word
    reason: str  #: why, in a sentence
    modes: Modes | None  #: counts of negative modes
    last_good: State | None = None  #: the last stable state on the way, where none was found at the target
    asymmetric: State | None = None  #: the stable state to which an antisymmetrically unstable one goes
    force_interval: tuple[float, float] | None = None  #: with friction: shortening and lengthening [N]

    @property
    def muscle(self) -> Muscle:
        """The specification."""
        return self.result.muscle

    @property
    def data(self) -> xr.Dataset:
        """Dataset of everything known of the state, without the step dimension."""
        return self.result.data.isel(step=0)

    def _number(self, name: str) -> float:
        return float(self.result.column(name)[0])

    @property
    def force(self) -> float:
        """Axial force [N], positive in tension; NaN without an admissible state."""
        return self._number("force")

    @property
    def length(self) -> float:
        """Distance between the fittings [m]."""
        return self._number("length")

    @property
    def contraction(self) -> float:
        """Contraction 1 - h/H0."""
        return self._number("contraction")

    @property
    def pressure(self) -> float:
        """Gauge pressure [Pa]."""
        return self._number("pressure")

    @property
    def volume(self) -> float:
        """Volume inside the braid [m^3]."""
        return self._number("volume")

    @property
    def cautions(self) -> tuple[str, ...]:
        """What a real muscle may do there that the model does not know."""
        return self.result.cautions

    @property
    def error_estimate(self) -> float:
        """Estimated relative error of force and length."""
        return self._number("error_estimate")

    def summary(self) -> str:
        """The state in a few lines: its verdict, and each number with its meaning, in mm, N and bar.

        >>> state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
        >>> print(state.summary().splitlines()[3])
        axial force, positive in tension             101.22 N
        """
        (row,) = rows(self.result)
        return summary(row, self.muscle)

    def __repr__(self) -> str:
        if self.length != self.length:  # nothing was found: say what was asked for, and why
            asked = (
                (name, getattr(self.result.test, name, None)) for name in ("length", "force", "pressure", "volume")
            )
            given = " and ".join(f"{name} {path}" for name, path in asked if path is not None)
            return f"<State: {self.verdict}, asked for {given}: {self.reason.removeprefix(f'{self.verdict}: ')}>"
        numbers = (
            f"force {self.force:.6g} N, length {1e3 * self.length:.6g} mm, pressure {1e-5 * self.pressure:.6g} bar"
        )
        return f"<State: {self.verdict}, {numbers}>"


def tested(muscle: Muscle, test: Test) -> dict[str, Any]:
    """Attributes that a Dataset carries: what was tested."""
    return {
        "title": f"McKibben muscle, {test.kind} test",
        "muscle": to_toml(muscle, allow_custom=True),
        "test": to_toml(test, allow_custom=True),
        "assumed": ", ".join(muscle.assumed),
    }


def about(versions: dict[str, str], date: str, warnings: list[str], status: str) -> dict[str, Any]:
    """Attributes that a Dataset carries: by what it was made, when, and what became of it."""
    return {
        "mckibben_version": versions["mckibben"],
        "versions": ", ".join(f"{name} {version}" for name, version in versions.items()),
        "date": date,
        "status": status,
        "warnings": "\n".join(warnings),
        "source": "Quaglierini, Arroyo, DeSimone, RoboSoft 2023",
    }
