"""`fit()`: the muscle behind measured forces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mckibben.data.values import Data
from mckibben.fitting.answer import Fit, answer
from mckibben.fitting.free import Free, free_numbers, is_turned, offsets_of
from mckibben.fitting.misfit import Points
from mckibben.fitting.notes import notes_on
from mckibben.fitting.search import Least, candidates, check_options, cost_of, least
from mckibben.fitting.together import AnyMisfit, misfit_of, told_apart
from mckibben.fitting.uncertain import intervals_of, spread_of
from mckibben.spec import Muscle, SpecError
from mckibben.spec.errors import nearest
from mckibben.units import UnitError, show, to_si

__all__ = ["fit"]

PASSES = 4
"""How often at most the size of an error is taken anew from the residuals, where something else depends on it."""
SIZES = (24, 48, 96)
"""Unknowns, tried in turn until the error of the best muscle's forces is below the tolerance."""
SETTLED = 0.01
"""Relative change of that size at which it is left alone."""


def fit(
    muscle: Muscle | Sequence[Muscle],
    data: Data | Sequence[Data],
    free: Mapping[str, Any],
    *,
    priors: Mapping[str, Any] | None = None,
    offsets: Mapping[str, Any] | None = None,
    weights: Mapping[str, float] | None = None,
    loss: str = "linear",
    force_error: Any = None,
    starts: int = 8,
    level: float = 0.95,
    profiles: bool = False,
    tolerance: float = 1e-4,
    watch: Callable[[int], None] | None = None,
) -> Fit:
    """Find numbers of a muscle so that its forces differ least from measured ones.

    The sum of squares of the differences, over the size of an error, is made least within the bounds by SciPy's
    `least_squares`, with exact derivatives. What the data cannot tell is said instead of a number.

    With `Friction` every test is walked along, in the order of its points, from the muscle as made: loading and
    unloading then tell its constants beside the others. Derivatives are central differences of such paths, to some
    1e-5; points that come in no order are refused.

    Args:
        muscle: what is known; the numbers that are free start from its own where these are inside the bounds. Several,
            one for each of the data, share what is free: one make in several lengths, say.
        data: what `read_data` gave, one or several. Forces are compared at the measured lengths and pressures.
        free: names of numbers of the muscle and their ranges, {"chamber.law.c1": "1 kPa to 1 MPa"}.
        priors: what is known of a free number beforehand, mean and standard deviation: {"braid.angle": "37 deg +- 1
            deg"}.
        offsets: instruments that may be off, with the standard deviation expected of each: {"force": "2 N",
            "pressure": "0.05 bar", "length": "1 mm"}. One value of each for all tests.
        weights: of tests by name, 1 by default; 0 leaves a test out.
        loss: "linear" (least squares), or one for which points far off count less: "soft_l1", "huber", "cauchy".
        force_error: standard deviation of a measured force [N]; by default it is taken from the residuals.
        starts: how many points of the range are looked at to begin from; the best one is.
        level: of the intervals.
        profiles: intervals by the profile likelihood, which follows a curved valley, in place of the standard errors.
        tolerance: relative error of the computed forces.
        watch: called with the number of muscles tried.

    Returns:
        A `Fit`: `muscle` (of several, `muscles`), `table`, `intervals`, `correlation`, `notes`, `predict(test)`.

    Raises:
        SpecError: for names, ranges or data that cannot be, and where no muscle within the bounds reaches every point;
            with friction, where a test's points come in no order.

    >>> muscle = mk.presets.paper()
    >>> curve = mk.run(muscle, mk.Isobaric(length="85 mm to 110 mm", pressure="1 bar", points=6))
    >>> data = mk.read_data({"length [m]": curve.length, "pressure [Pa]": curve.pressure, "force [N]": curve.force})
    >>> found = mk.fit(muscle.replace("braid.angle", "36 deg"), data, {"braid.angle": "35 deg to 39 deg"}, starts=1)
    >>> print(found.table.loc["braid.angle", "value"])
    37 deg
    """
    several = _several(data)
    muscles = _muscles(muscle, several)
    known = _known(force_error)
    check_options(loss, level)
    numbers = (*_shared(muscles, free, priors or {}), *offsets_of(offsets or {}))
    _check_contractions(several, numbers)
    misfit = misfit_of(muscles, numbers, _points(muscles, several, weights or {}), SIZES[0])
    count = len(misfit.measured.force)
    if count + sum(one.prior is not None for one in numbers) <= len(numbers):
        said = f"has {count} points for {len(numbers)} free numbers"
        raise SpecError("data", allowed=said, advice="free fewer numbers, or measure more")
    best, sigma = _best(misfit, known, loss, starts, tolerance, watch or (lambda count: None))
    spread = spread_of(best, known is not None)
    low, high = intervals_of(misfit, best, spread, sigma, loss, level, profiles)
    notes, error = notes_on(misfit, best, spread), misfit.error(best.x)
    if error > tolerance:
        notes.append(f"the forces of the model are computed to {error:.1g} only, not to {tolerance:g}")
    about = {
        "level": level, "intervals": "profile likelihood" if profiles else "standard errors", "loss": loss,
        "force_error": float(sigma * np.sqrt(spread.scale)), "error_known": int(known is not None),
        "message": best.message,
        "converged": int(best.converged), "evaluations": best.evaluations, "unknowns": misfit.size,
        "source": ", ".join(dict.fromkeys(one.source for one in several)), "error_estimate": error,
        "notes": "\n".join(dict.fromkeys([*notes, *(line for one in several for line in one.assumptions)])),
    }  # fmt: skip
    return answer(misfit, best, spread, (low, high), about)


def _several(data: Data | Sequence[Data]) -> tuple[Data, ...]:
    several = (data,) if isinstance(data, Data) else tuple(data)
    if not several or not all(isinstance(one, Data) for one in several):
        raise SpecError("data", data, "must be what read_data gave", 'such as mk.read_data("bench.csv")')
    if sum(len(one) for one in several) == 0:
        raise SpecError("data", allowed="holds no points")
    return several


def _muscles(muscle: Muscle | Sequence[Muscle], several: tuple[Data, ...]) -> tuple[Muscle, ...]:
    """One for all data, or one for each of them."""
    muscles = (muscle,) if isinstance(muscle, Muscle) else tuple(muscle)
    if not muscles or not all(isinstance(one, Muscle) for one in muscles):
        raise SpecError("muscle", muscle, "must be a muscle, or one for each of the data")
    if not isinstance(muscle, Muscle) and len(muscles) != len(several):
        said = f"are {len(muscles)} for {len(several)} sets of data"
        raise SpecError("muscle", allowed=said, advice="give one muscle for each of the data, in the same order")
    return muscles


def _shared(muscles: tuple[Muscle, ...], free: Mapping[str, Any], priors: Mapping[str, Any]) -> tuple[Free, ...]:
    """What is free, which every muscle must have; it starts where the first one is."""
    found = [free_numbers(muscle, free, priors) for muscle in muscles]
    if any(is_turned(muscle, "braid.angle") != is_turned(muscles[0], "braid.angle") for muscle in muscles):
        raise SpecError("muscle", allowed="measure the angle from different lines", advice="give all angles from one")
    return found[0]


def _check_contractions(several: tuple[Data, ...], numbers: tuple[Free, ...]) -> None:
    """SpecError where contractions refer to a rest length that is itself free: they are no lengths then."""
    resized = [one.name for one in numbers if one.name in ("braid.length", "fittings.dead_length")]
    if resized and any(one.measured == "contraction" and one.rest_length is None for one in several):
        said = "cannot be free where contractions were measured, which refer to the rest length"
        raise SpecError(f"free.{resized[0]}", allowed=said, advice='say held={"rest_length": "300 mm"} when reading')


def _known(force_error: Any) -> float | None:
    if force_error is None:
        return None
    try:
        size = float(to_si(force_error, "N"))
    except UnitError as error:
        raise SpecError("force_error", force_error, str(error), error.advice) from error
    if size <= 0.0:
        raise SpecError("force_error", force_error, "must be above 0 N")
    return size


def _points(
    muscles: tuple[Muscle, ...], several: tuple[Data, ...], weights: Mapping[str, float]
) -> list[Points]:  # fmt: skip
    """The points with their weights, for each muscle."""
    groups = [several] if len(muscles) == 1 else [(data,) for data in told_apart(muscles, several)]
    tests = dict.fromkeys(name for group in groups for data in group for name in data.tests)
    for name, weight in weights.items():
        if name not in tests:
            raise SpecError(f"weights.{name}", allowed="is no test of these data", advice=nearest(str(name), tests))
        if not 0.0 <= float(weight) < 1e12:
            raise SpecError(f"weights.{name}", weight, "must be at least 0")
    return [Points.of(muscle, group, weights) for muscle, group in zip(muscles, groups, strict=True)]


def _best(
    misfit: AnyMisfit, known: float | None, loss: str, starts: int, tolerance: float, watch: Callable[[int], None]
) -> tuple[Least, float]:
    """The end of the search, and the size of an error that it was done with [N]."""
    count = 0

    def tell(_: int) -> None:
        nonlocal count
        count += 1
        watch(count)

    x = _start(misfit, known or 1.0, starts, tell)
    needs_size = known is None and (loss != "linear" or any(one.prior is not None for one in misfit.free))
    sigma = known or (_size(misfit, x) if needs_size else 1.0)
    for finer in (*SIZES[1:], None):
        for _ in range(PASSES):
            found = least(misfit, x, sigma, loss, watch=tell)
            x, size = found.x, _size(misfit, found.x)
            if not needs_size or abs(size / sigma - 1.0) < SETTLED:
                break
            sigma = size
        if finer is None or misfit.error(x) <= tolerance:
            break
        coarser = misfit.size
        misfit.place_anew(x, finer)
        if not misfit.reached:  # lost on more unknowns: what was found stands, with the error that it has
            misfit.place_anew(x, coarser)
            break
    return found, sigma


def _start(misfit: AnyMisfit, sigma: float, count: int, watch: Callable[[int], None]) -> np.ndarray:
    """The best of several points of the range. SpecError where none has a state at every measured point."""
    ranked: list[tuple[int, float, int, np.ndarray]] = []
    for x in candidates(misfit, count):
        missing, cost = cost_of(misfit, x, sigma)
        watch(0)
        ranked.append((missing, cost, len(ranked), x))
    missing, _, _, x = min(ranked)
    misfit.place_anew(x)
    if not misfit.reached:
        lost = np.flatnonzero(~misfit(x).found)
        lengths, pressures = misfit.measured.points[lost].T
        said = (
            f"{len(lost)} of {len(misfit.measured.force)} points are beyond reach of all {len(ranked)} muscles tried, "
            f"such as {show(float(lengths[0]), 'mm')} at {show(float(pressures[0]), 'bar')}"
        )
        raise SpecError("data", allowed=said, advice="widen the ranges, or leave these points out with data.where()")
    return x


def _size(misfit: AnyMisfit, x: np.ndarray) -> float:
    """Size of the residuals [N], little moved by a few that are far off."""
    measured = misfit.measured
    residuals = np.sqrt(measured.weights) * (misfit(x).force - measured.force)
    n, k = len(residuals), len(misfit.free)
    size = 1.4826 * float(np.median(np.abs(residuals))) * np.sqrt(n / max(n - k, 1))
    return float(max(size, 1e-9 * np.abs(measured.force).max(), 1e-12))
