"""Several muscles that share what is free, such as one make in several lengths: a misfit made of theirs."""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from mckibben.data.values import Data
from mckibben.fitting.free import Free
from mckibben.fitting.misfit import Misfit, Points, Seen
from mckibben.fitting.paths import PathMisfit
from mckibben.spec import Muscle

__all__ = ["AnyMisfit", "Together", "misfit_of", "told_apart"]


@attrs.frozen(eq=False)
class Together:
    """One misfit after another, for a search that sees all their points."""

    parts: tuple[Misfit | PathMisfit, ...]

    @property
    def free(self) -> tuple[Free, ...]:
        """What all of them share."""
        return self.parts[0].free

    @property
    def muscles(self) -> tuple[Muscle, ...]:
        """As given, in the order of their data."""
        return tuple(part.muscle for part in self.parts)

    @property
    def measured(self) -> Points:
        """All points, those of the first muscle first."""
        return Points.joined([part.measured for part in self.parts])

    @property
    def of(self) -> np.ndarray:
        """Which muscle each point is of."""
        return np.repeat(np.arange(len(self.parts)), [len(part.measured.force) for part in self.parts])

    @property
    def size(self) -> int:
        """Unknowns of each."""
        return self.parts[0].size

    @property
    def start(self) -> np.ndarray:
        """x of the first muscle as given."""
        return self.parts[0].start

    @property
    def reached(self) -> bool:
        """Whether every point of every muscle has a state."""
        return all(part.reached for part in self.parts)

    def values(self, x: np.ndarray) -> np.ndarray:
        """The numbers at x, SI."""
        return self.parts[0].values(x)

    def place_anew(self, x: np.ndarray, size: int | None = None) -> None:
        """Place and seek each of them."""
        for part in self.parts:
            part.place_anew(x, size)

    def error(self, x: np.ndarray) -> float:
        """The largest of theirs."""
        return max(part.error(x) for part in self.parts)

    def __call__(self, x: np.ndarray) -> Seen:
        """Forces and derivatives at x."""
        seen = [part(x) for part in self.parts]
        force = np.concatenate([one.force for one in seen])
        return Seen(force, lambda: np.concatenate([one.slopes for one in seen]))


AnyMisfit = Misfit | PathMisfit | Together


def misfit_of(muscles: Sequence[Muscle], free: tuple[Free, ...], points: Sequence[Points], size: int) -> AnyMisfit:
    """Of one muscle, or of several with the points of each; points of no weight are not compared."""
    parts = tuple(_of_one(muscle, free, some, size) for muscle, some in zip(muscles, points, strict=True))
    return parts[0] if len(parts) == 1 else Together(parts)


def _of_one(muscle: Muscle, free: tuple[Free, ...], points: Points, size: int) -> Misfit | PathMisfit:
    if muscle.friction is not None:
        return PathMisfit(muscle, free, points, size)
    return Misfit(muscle, free, points.some(points.weights > 0.0), size)


def told_apart(muscles: Sequence[Muscle], several: Sequence[Data]) -> list[Data]:
    """The data, with the muscle before the name of a test that others have too."""
    found, seen = [], [name for data in several for name in data.tests]
    for k, (muscle, data) in enumerate(zip(muscles, several, strict=True)):
        alone = muscle.name and [one.name for one in muscles].count(muscle.name) == 1
        whose = muscle.name if alone else f"muscle {k + 1}"
        tests = tuple(f"{whose}: {name}" if seen.count(name) > 1 else name for name in data.tests)
        found.append(attrs.evolve(data, tests=tests))
    return found
