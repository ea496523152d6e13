"""`fit_motion()`: the rig behind a measured motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mckibben.data.recording import OVER_TIME, Recording
from mckibben.fitting.answer import of_numbers
from mckibben.fitting.free import Free, free_number
from mckibben.fitting.notes import notes_of
from mckibben.fitting.search import Least, candidates, check_options, cost_of, least
from mckibben.fitting.uncertain import Spread, intervals_of, spread_of
from mckibben.measure.report import versions
from mckibben.motion.maps import maps_of
from mckibben.motionfits.misfit import MotionMisfit
from mckibben.results.motionfit import MOMENTS, MotionFit
from mckibben.spec.declared import numbers
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.rig import Rig
from mckibben.spec.rigtext import rig_to_toml
from mckibben.units import UnitError, to_si

__all__ = ["fit_motion"]

ROUGH = 0.01
"""Size of an error over the range of a quantity, to begin with."""
PASSES = 6
"""How often at most the sizes of errors are taken anew from the residuals."""
SETTLED = 0.01
"""Relative change of the sizes at which they are left alone."""
TOLERANCE = 1e-8
"""Relative error of a step of the integration: differences of motions must be smooth."""


def fit_motion(
    rig: Rig,
    recording: Recording,
    free: Mapping[str, Any],
    *,
    priors: Mapping[str, Any] | None = None,
    errors: Mapping[str, Any] | None = None,
    loss: str = "linear",
    chart: Any = None,
    starts: int = 4,
    level: float = 0.95,
    profiles: bool = False,
) -> MotionFit:
    """Find numbers of a rig so that its motion differs least from a measured one: a valve's conductance, a viscosity.

    The rig moves as `simulate` has it, from rest at the first time of the recording, with its own command. The sum of
    squares of what length, pressure, force and angle differ by, each over the size of its error, is made least within
    the bounds by SciPy's `least_squares`; derivatives are differences of motions. Of a rig with two muscles the first
    one is compared.

    Args:
        rig: what is known; the numbers that are free start from its own where these are inside the bounds.
        recording: what `read_recording` gave.
        free: names of numbers of the rig and their ranges, {"valve.C": "0.05 L/s/bar to 1 L/s/bar"}. Numbers of the
            muscle are not free: its map would be another (`fit` finds them).
        priors: what is known of a free number beforehand, mean and standard deviation: {"valve.b": "0.3 +- 0.05"}.
        errors: standard deviations of measured values, {"pressure": "0.01 bar"}; of a quantity that is left out it is
            taken from the residuals.
        loss: "linear" (least squares), or one for which points far off count less: "soft_l1", "huber", "cauchy".
        chart: the map of the muscle, as for `simulate`.
        starts: how many points of the range are looked at to begin from; the best one is.
        level: of the intervals.
        profiles: intervals by the profile likelihood in place of the standard errors.

    Returns:
        A `MotionFit`: `rig`, `table`, `intervals`, `correlation`, `notes`, `residuals(quantity)`. Errors hold for
        noise that is independent from time to time; a model that is wrong somewhere leaves residuals that are not, and
        errors that are too small.

    Raises:
        SpecError: for names, ranges or quantities that cannot be, and where no rig within the bounds moves to the end.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> seen = mk.simulate(rig, until="0.4 s", points=21)
    >>> recording = mk.read_recording({"time [s]": seen.time, "force [N]": seen.force})
    >>> found = mk.fit_motion(rig, recording, {"valve.C": "0.05 L/s/bar to 0.3 L/s/bar"}, starts=1)
    >>> found.numbers, found.converged
    (('valve.C',), True)
    """
    if not isinstance(rig, Rig):
        raise SpecError("rig", rig, "must be a Rig", "such as mk.Rig(muscle=..., load=..., supply=..., valve=...)")
    if not isinstance(recording, Recording):
        raise SpecError("recording", allowed="must be what read_recording gave", advice='mk.read_recording("run.csv")')
    check_options(loss, level)
    if "angle" in recording.values and not rig.turns:
        raise SpecError("recording", allowed="has an angle, and this rig has no pulley")
    known = _sizes(errors or {}, recording)
    begin = {name: known.get(name) or ROUGH * max(float(np.ptp(values)), 1e-12 + 1e-3 * float(np.abs(values).max()))
             for name, values in recording.values.items()}  # fmt: skip
    numbers_free = free_of_rig(rig, free, priors or {})
    misfit = MotionMisfit(rig, numbers_free, recording, maps_of(rig, chart), TOLERANCE, begin)
    if len(misfit.measured.force) <= len(numbers_free):
        raise SpecError("recording", allowed=f"has too few values for {len(numbers_free)} free numbers")
    best = _best(misfit, known, loss, starts)
    spread = spread_of(best, known_size=True)
    ends = intervals_of(misfit, best, spread, 1.0, loss, level, profiles)
    return _answer(misfit, best, spread, ends, {"level": level, "loss": loss, "source": recording.source,
                   "intervals": "profile likelihood" if profiles else "standard errors"})  # fmt: skip


def free_of_rig(rig: Rig, free: Mapping[str, Any], priors: Mapping[str, Any]) -> tuple[Free, ...]:
    """What is free, from a mapping of names to ranges. SpecError for a name or range that cannot be."""
    if not isinstance(free, Mapping) or not free:
        advice = 'such as free={"valve.C": "0.05 L/s/bar to 1 L/s/bar"}'
        raise SpecError("free", free, "must name at least one number and its range", advice)
    for name in priors:
        if name not in free:
            raise SpecError(f"priors.{name}", allowed="is not free", advice="name it in free too")
    known = {name: (declared, float(number)) for name, declared, number in numbers(rig) if declared.kind == "quantity"}
    found = []
    for name, given in free.items():
        if str(name).startswith(("muscle.", "antagonist.")):
            said = "is a number of the muscle, whose map would be another"
            raise SpecError(f"free.{name}", allowed=said, advice="find it from forces at rest by mk.fit")
        if name not in known:
            options = [one for one in known if not one.startswith(("muscle.", "antagonist."))]
            raise SpecError(f"free.{name}", allowed="is no number of this rig", advice=nearest(str(name), options))
        found.append(free_number(name, given, *known[name], priors))
    return tuple(found)


def _sizes(errors: Mapping[str, Any], recording: Recording) -> dict[str, float]:
    found = {}
    for name, given in errors.items():
        if name not in recording.values:
            raise SpecError(f"errors.{name}", allowed="was not measured", advice=nearest(str(name), recording.values))
        try:
            found[name] = float(to_si(given, OVER_TIME[name]))
        except UnitError as error:
            raise SpecError(f"errors.{name}", given, str(error), error.advice) from error
        if not found[name] > 0.0:
            raise SpecError(f"errors.{name}", given, "must be above 0")
    return found


def _best(misfit: MotionMisfit, known: Mapping[str, float], loss: str, starts: int) -> Least:
    """The end of the search, with the sizes of errors as its residuals have them."""
    ranked = [(*cost_of(misfit, x, 1.0), k, x) for k, x in enumerate(candidates(misfit, starts))]
    missing, _, _, x = min(ranked, key=lambda item: item[:3])
    if missing:
        said = f"is not reached to its end by any of the {len(ranked)} rigs tried"
        raise SpecError("recording", allowed=said, advice="simulate one of them to see why, or narrow the ranges")
    for _ in range(PASSES):
        found = least(misfit, x, 1.0, loss)
        x = found.x
        anew = misfit.sizes | {name: size for name, size in _left(misfit, x).items() if name not in known}
        change = max(abs(anew[name] / misfit.sizes[name] - 1.0) for name in anew)
        if change < SETTLED:
            break
        misfit.sizes = anew
    return found


def _left(misfit: MotionMisfit, x: np.ndarray) -> dict[str, float]:
    """Standard deviation of the residuals of each quantity, SI."""
    recording = misfit.recording
    rows = misfit.moved(x).reshape(len(recording.values), -1)
    n, k = rows.size, len(misfit.free)
    found = {}
    for (name, values), row in zip(recording.values.items(), rows, strict=True):
        least_one = max(1e-9 * float(np.abs(values).max()), 1e-300)
        found[name] = max(float(np.sqrt(np.mean((row - values) ** 2) * n / (n - k))), least_one)
    return found


def _answer(
    misfit: MotionMisfit, best: Least, spread: Spread, ends: tuple[np.ndarray, np.ndarray], about: dict[str, Any]
) -> MotionFit:
    import xarray as xr

    recording = misfit.recording
    predicted, count = misfit.moved(best.x), len(recording)
    size = np.repeat([misfit.sizes[name] for name in recording.values], count)
    of_points = {
        "time": np.tile(recording.time, len(recording.values)),
        "measured": np.concatenate(list(recording.values.values())),
        "predicted": predicted,
        "size": size,
    }
    variables = of_numbers(misfit, best, spread, ends)
    variables |= {name: ("point", column, {"long_name": MOMENTS[name]}) for name, column in of_points.items()}
    variables["quantity"] = ("point", np.repeat(list(recording.values), count))
    notes = [*notes_of(misfit.free, best, spread), *recording.assumptions]
    if not misfit.inside:
        notes.append("the motion leaves the range of its map: give a chart that reaches further")
    rig = misfit.rig_at(best.x)
    about |= {
        "rig": rig_to_toml(rig), "given": rig_to_toml(misfit.rig), "notes": "\n".join(notes),
        "converged": int(best.converged), "message": best.message, "tried": misfit.tried,
        "mckibben_version": versions()["mckibben"],
    }  # fmt: skip
    dataset = xr.Dataset(variables, attrs=about)
    for name in dataset.variables:
        dataset[name].values.flags.writeable = False
    return MotionFit(rig, misfit.rig, dataset)
