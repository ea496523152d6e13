"""`compare_models()`: the same data under several muscles, judged by points that the fit did not see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import attrs
import numpy as np

from mckibben.data.values import Data
from mckibben.fitting.answer import Fit
from mckibben.fitting.fit import fit
from mckibben.fitting.misfit import Points
from mckibben.fitting.together import misfit_of
from mckibben.spec import Muscle, SpecError

__all__ = ["Choice", "compare_models"]

FOLDS = 5
"""Parts that are left out in turn where the data are of fewer than three tests."""


@attrs.frozen(eq=False, repr=False)
class Choice:
    """How well several models do on the same data, best first.

    Args:
        fits: the fit of each model to all data, by name.
        left_out: for each model the differences [N] at points that its fit had not seen, NaN where it reached none.
        force: measured forces [N] in the same order.
    """

    fits: dict[str, Fit]
    left_out: dict[str, np.ndarray]
    force: np.ndarray

    @property
    def errors(self) -> dict[str, float]:
        """Cross-validated rms [N] by model, the best first; infinite where a point could not be predicted."""
        found = {name: float(np.sqrt(np.mean(misses**2))) for name, misses in self.left_out.items()}
        known = {name: error if np.isfinite(error) else float("inf") for name, error in found.items()}
        return dict(sorted(known.items(), key=lambda item: item[1]))

    @property
    def best(self) -> str:
        """Name of the model with the least cross-validated error."""
        return next(iter(self.errors))

    @property
    def table(self) -> Any:
        """DataFrame, best first: free numbers, rms of the fit, cross-validated rms, that over the largest force."""
        import pandas as pd

        largest = float(np.abs(self.force).max())
        rows = {
            name: {
                "free numbers": len(self.fits[name].numbers), "rms [N]": self.fits[name].rms,
                "cross-validated rms [N]": error, "of largest force [%]": 100.0 * error / largest,
                "not determined": ", ".join(self.fits[name].undetermined),
            }
            for name, error in self.errors.items()
        }  # fmt: skip
        return pd.DataFrame.from_dict(rows, orient="index")

    def __repr__(self) -> str:
        told = ", ".join(f"{name} {error:.3g} N" for name, error in self.errors.items())
        return f"<Choice: cross-validated rms {told}>"


def compare_models(
    models: Mapping[str, tuple[Muscle | Sequence[Muscle], Mapping[str, Any]]],
    data: Data | Sequence[Data],
    **options: Any,
) -> Choice:
    """Fit several muscles to the same data, and judge each by points that its fit did not see.

    Each test is left out in turn (of fewer than three tests, every fifth point), the others are fitted, and the forces
    of the one left out are predicted. A model with more numbers always fits better; it predicts better only where its
    effects are in the data. Where a model has friction, the points at which a test turns are never left out: they
    belong to the path of the others.

    Args:
        models: by a name of your own, the muscle (or one for each of the data) and what is free, as for `fit`.
        data: as for `fit`.
        options: further arguments of `fit` for all of them.

    Returns:
        A `Choice`: `table`, `best`, `errors`, and the `fits` to all data.

    Raises:
        SpecError: as `fit` does, and for fewer than two models.

    >>> muscle = mk.presets.paper()
    >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=10))
    >>> data = mk.read_data({"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force})
    >>> wrong = muscle.replace("braid.radius", "13.5 mm")
    >>> angle = {"braid.angle": "35 deg to 39 deg"}
    >>> found = mk.compare_models({"as made": (muscle, angle), "too wide": (wrong, angle)}, data, starts=1)
    >>> found.best
    'as made'
    """
    if not isinstance(models, Mapping) or len(models) < 2:
        raise SpecError("models", models, "must name at least two models", 'such as {"basic": (muscle, free), ...}')
    several = (data,) if isinstance(data, Data) else tuple(data)
    fits = {name: fit(muscle, several, free, **options) for name, (muscle, free) in models.items()}
    tests = list(dict.fromkeys(name for one in several for name in one.tests))
    rub = any(one.friction is not None for muscle, _ in models.values() for one in _each(muscle))
    folds = _folds(several, tests, [_turning(one) if rub else np.zeros(len(one), bool) for one in several])
    left_out: dict[str, np.ndarray] = {}
    for name, (muscle, free) in models.items():
        misses, forces = [], []
        for parts, rest in folds:
            left = {name for one in rest.values() for name in one.tests}
            weights = {name: weight for name, weight in (options.get("weights") or {}).items() if name in left}
            known = muscle if isinstance(muscle, Muscle) else [muscle[k] for k in rest]
            found = fit(known, list(rest.values()), free, **options | {"weights": weights})
            for k, out in parts.items():
                force = _forces(found, muscle if isinstance(muscle, Muscle) else muscle[k], several[k], out)
                misses.append(force - several[k].force[out])
                forces.append(several[k].force[out])
        left_out[name] = np.concatenate(misses)
    return Choice(fits, left_out, np.concatenate(forces))


def _forces(found: Fit, muscle: Muscle, data: Data, chosen: np.ndarray) -> np.ndarray:
    """Forces [N] at some points of a muscle with the fitted numbers, which need not be one that was fitted."""
    if muscle.friction is None:
        data, chosen = data.where(chosen), np.ones(int(chosen.sum()), bool)
    points = Points.of(muscle, (data,), {})
    points = attrs.evolve(points, weights=np.where(chosen, points.weights, 0.0))
    misfit = misfit_of((muscle,), found.free, (points,), int(found.data.attrs["unknowns"]))
    return misfit(misfit.start).force


def _each(muscle: Muscle | Sequence[Muscle]) -> tuple[Muscle, ...]:
    return (muscle,) if isinstance(muscle, Muscle) else tuple(muscle)


def _turning(data: Data) -> np.ndarray:
    """The last points of the branches of each test."""
    next_one = np.arange(1, len(data))
    turns = (data.which[next_one] == data.which[:-1]) & (data.branches[next_one] != data.branches[:-1])
    return np.append(turns, False)


def _folds(
    several: tuple[Data, ...], tests: list[str], kept: list[np.ndarray]
) -> list[tuple[dict[int, np.ndarray], dict[int, Data]]]:
    """(which points are left out, what is fitted) of every fold, each by its place among the data."""
    folds = []
    for k in range(len(tests) if len(tests) >= 3 else FOLDS):
        out: dict[int, np.ndarray] = {}
        rest: dict[int, Data] = {}
        for place, one in enumerate(several):
            if len(tests) >= 3:
                chosen = np.array([one.tests[which] == tests[k] for which in one.which])
            else:
                chosen = (np.arange(len(one)) % FOLDS == k) & ~kept[place]
            if chosen.any():
                out[place] = chosen
            if not chosen.all():
                rest[place] = one.where(~chosen)
        folds.append((out, rest))
    return folds
