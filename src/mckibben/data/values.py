"""`Data`: what a bench measured, immutable, in SI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from mckibben.data import thin
from mckibben.data.branches import LOADING, UNKNOWN, UNLOADING
from mckibben.shown import Shown
from mckibben.spec import Muscle
from mckibben.spec.errors import SpecError, nearest
from mckibben.units import UnitError, from_si, to_si

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Data"]


def _frozen(values: Any) -> np.ndarray:
    array = np.array(values)
    array.flags.writeable = False
    return array


def _optional(values: Any) -> np.ndarray | None:
    return None if values is None else _frozen(values)


@attrs.frozen(eq=False, repr=False)
class Data(Shown):
    """Measured points of one or several tests, in SI: what `read_data` gives. It never changes.

    All arrays have one entry per point and are read-only.

    Args:
        source: the file or files, for people.
        tests: names of the tests.
        which: for each point, the place of its test in `tests`.
        branches: for each point "loading" (what drives the test rises: the length, or the pressure where that varies),
            "unloading", or "unknown" where the points come in no order.
        rows: for each point the line in its file, the first being 1.
        pressure: gauge pressure [Pa].
        force: force [N], positive where the muscle pulls its fittings together.
        measured: what was measured of the shape: "length" [m], "contraction" [1] or "extension" [m], from the length
            without force at the pressure.
        shape: the values of that.
        rest_length: the length as made [m] that contractions refer to, or None if nobody said.
        free_length: the length without force at the pressure [m] that extensions refer to, or None.
        assumptions: what was taken for granted in reading, a sentence each.

    >>> data = mk.read_data({"pressure [bar]": [1, 1, 1], "length [mm]": [80, 90, 100], "force [N]": [0, 12, 31]})
    >>> data
    <Data: 3 points of 1 test (1 bar), length measured, force 0 to 31 N>
    >>> data.length  # m
    array([0.08, 0.09, 0.1 ])
    >>> data["1 bar"].branch("loading").force
    array([ 0., 12., 31.])
    """

    source: str
    tests: tuple[str, ...]
    which: np.ndarray = attrs.field(converter=_frozen)
    branches: np.ndarray = attrs.field(converter=_frozen)
    rows: np.ndarray = attrs.field(converter=_frozen)
    pressure: np.ndarray = attrs.field(converter=_frozen)
    force: np.ndarray = attrs.field(converter=_frozen)
    measured: str
    shape: np.ndarray = attrs.field(converter=_frozen)
    rest_length: np.ndarray | None = attrs.field(converter=_optional, default=None)
    free_length: np.ndarray | None = attrs.field(converter=_optional, default=None)
    assumptions: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.force)

    def __repr__(self) -> str:
        names = ", ".join(self.tests[:6]) + (", ..." if len(self.tests) > 6 else "")
        count = f"{len(self.tests)} test{'s' if len(self.tests) != 1 else ''}"
        forces = f"{self.force.min():.4g} to {self.force.max():.4g} N" if len(self) else "none"
        points = f"{len(self)} point{'s' if len(self) != 1 else ''}"
        return f"<Data: {points} of {count} ({names}), {self.measured} measured, force {forces}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Data):
            return NotImplemented
        return all(np.array_equal(_plain(a), _plain(b)) for a, b in zip(_fields(self), _fields(other), strict=True))

    def __hash__(self) -> int:
        return hash((self.source, self.tests, self.measured, len(self)))

    @property
    def length(self) -> np.ndarray:
        """Length between the fittings [m]; SpecError where the data alone do not tell it."""
        return self._lengths(None, None)

    @property
    def contraction(self) -> np.ndarray:
        """Contraction 1 - h/H0, of the rest length that was told; SpecError where the data alone do not tell it."""
        if self.measured == "contraction":
            return self.shape
        if self.rest_length is None:
            advice = 'say held={"rest_length": "300 mm"} when reading'
            raise SpecError("data.contraction", allowed="takes the length as made, which nobody told", advice=advice)
        return _frozen(1.0 - self.length / self.rest_length)

    @property
    def extension(self) -> np.ndarray:
        """Extension from the free length at the pressure [m]; SpecError where the data alone do not tell it."""
        if self.measured == "extension":
            return self.shape
        if self.free_length is None:
            advice = 'say held={"free_length": "240 mm"} when reading'
            raise SpecError("data.extension", allowed="takes the length without force", advice=advice)
        return _frozen(self.length - self.free_length)

    @property
    def longer(self) -> np.ndarray:
        """What grows with the length of the muscle: what was measured, or minus a contraction."""
        return -self.shape if self.measured == "contraction" else self.shape

    def lengths(self, muscle: Muscle, free_length: Any = None) -> np.ndarray:
        """Lengths between the fittings of a muscle, in m.

        Args:
            muscle: its `rest_length` is that of contractions, unless the data have one of their own.
            free_length: where extensions were measured and the data do not tell their free length: one, or one per
                point [m or text], such as a model's length without force at `data.pressure`.

        Returns:
            An array of shape (points,).

        Raises:
            SpecError: where extensions were measured and no free length is known.
        """
        return self._lengths(float(muscle.rest_length), free_length)

    def _lengths(self, made: float | None, free: Any) -> np.ndarray:
        if self.measured == "length":
            return self.shape
        if self.measured == "contraction":
            rest = self.rest_length if self.rest_length is not None else made
            if rest is None:
                advice = 'ask data.lengths(muscle), or say held={"rest_length": "300 mm"} when reading'
                raise SpecError("data.length", allowed="contractions have no length without a muscle", advice=advice)
            return _frozen((1.0 - self.shape) * rest)
        known = self.free_length
        if free is not None:
            try:
                known = np.broadcast_to(np.asarray(free if np.ndim(free) else to_si(free, "m"), float), (len(self),))
            except (UnitError, ValueError) as error:
                raise SpecError("free_length", allowed=f"must be one length, or {len(self)}: {error}") from error
        if known is None:
            said = "extensions were measured, from a length without force that nobody told"
            advice = 'say held={"free_length": "240 mm"} when reading, or {"free_length": {"3 bar": "240 mm", ...}}'
            raise SpecError("data.length", allowed=said, advice=advice)
        return _frozen(known + self.shape)

    def __getitem__(self, name: str) -> Data:
        return self.test(name)

    def test(self, name: str) -> Data:
        """The points of one test, by its name; SpecError for a name that is none of `tests`."""
        if name not in self.tests:
            raise SpecError("data.test", name, "is no test of these data", nearest(str(name), self.tests))
        return self.where(self.which == self.tests.index(name))

    def branch(self, name: str) -> Data:
        """The points of one branch, "loading", "unloading" or "unknown"; there may be none."""
        words = (LOADING, UNLOADING, UNKNOWN)
        if name not in words:
            raise SpecError("data.branch", name, "must be one of " + ", ".join(words), nearest(str(name), words))
        return self.where(self.branches == name)

    def where(self, chosen: np.ndarray) -> Data:
        """The points that an array of truth values (points,), or of places, chooses; tests without points go."""
        which = self.which[chosen]
        left = [k for k in range(len(self.tests)) if (which == k).any()]
        place = np.zeros(len(self.tests), int)
        place[left] = np.arange(len(left))
        arrays = {name: getattr(self, name) for name in thin.ARRAYS}
        picked: dict[str, Any] = {name: None if values is None else values[chosen] for name, values in arrays.items()}
        return attrs.evolve(self, tests=tuple(self.tests[k] for k in left), **picked | {"which": place[which]})

    def decimated(self, points: int) -> Data:
        """Fewer points on the same curves: local means, for data that are many and noisy.

        The way of each branch of each test is cut into equal parts of what drives it, and the points of a part become
        their mean; the first and the last point stay as they are, so that the range is kept. A branch that has no more
        than `points` stays as it is. Beside what a mean takes from a bend within one part, shape is kept; noise is not.

        Args:
            points: at most so many for each branch of each test, at least 3.

        Returns:
            A `Data`; `rows` are those of the points in the middle.

        Raises:
            SpecError: for fewer than 3 points.
        """
        if isinstance(points, bool) or not isinstance(points, int) or points < 3:
            raise SpecError("data.decimated", points, "must be a whole number, at least 3")
        arrays: dict[str, Any] = thin.thinned({name: getattr(self, name) for name in thin.ARRAYS}, self.longer, points)
        note = f"local means: at most {points} points a branch, of {len(self)} in all"
        return attrs.evolve(self, **arrays, assumptions=(*self.assumptions, note))

    def to_pandas(self) -> pd.DataFrame:
        """The points as a DataFrame, in SI, with units in the heads; `read_data` reads it back."""
        import pandas as pd

        unit = {"contraction": "1"}.get(self.measured, "m")
        columns: dict[str, Any] = {"test": [self.tests[k] for k in self.which], "branch": self.branches}
        columns |= {"row": self.rows, "pressure [Pa]": self.pressure, f"{self.measured} [{unit}]": self.shape}
        for name in ("rest_length", "free_length"):
            if getattr(self, name) is not None:
                columns[f"{name} [m]"] = getattr(self, name)
        return pd.DataFrame(columns | {"force [N]": self.force})

    def described(self, name: str) -> str:
        """The range of an array in the unit that people see: described("pressure") is "1 to 3 bar"."""
        values = self.shape if name == self.measured else getattr(self, name)
        shown = {"pressure": "bar", "force": "N", "contraction": "%"}.get(name, "mm")
        values = 100.0 * values if shown == "%" else from_si(values, shown)
        low, high = (f"{value + 0.0:.5g}" for value in (values.min(), values.max()))
        return f"{low} {shown}" if low == high else f"{low} to {high} {shown}"


def _fields(data: Data) -> list[Any]:
    return [getattr(data, field.name) for field in attrs.fields(Data) if field.name not in ("source", "assumptions")]


def _plain(value: Any) -> np.ndarray:
    return np.asarray("" if value is None else value)
