"""`tolerances()`: how far results scatter where the numbers of a muscle do."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mckibben.experiments.foresee import refuse_friction
from mckibben.experiments.sensitivity import sensitivity
from mckibben.measure.report import versions
from mckibben.results.sensitivity import Sensitivity
from mckibben.results.tolerances import Tolerances, dataset
from mckibben.results.variables import OBSERVED
from mckibben.results.verdict import Verdict
from mckibben.scatter.draw import drawn
from mckibben.scatter.given import Scattering, scattering
from mckibben.scatter.notes import notes
from mckibben.spec import Muscle, SpecError, Test
from mckibben.spec.errors import nearest
from mckibben.spec.text import to_toml
from mckibben.sweeps.outcome import STATES

__all__ = ["tolerances"]

RESULTS = tuple(name for name in OBSERVED if name in STATES)
"""Results that have derivatives and that sweeps keep."""
FEWEST, MOST = 16, 2**17
FINE = 1e-6
"""Relative error of the state whose derivatives are taken: it is only one."""


def tolerances(
    muscle: Muscle,
    test: Test,
    vary: Mapping[str, Any],
    of: Sequence[str] | str | None = None,
    state: int = -1,
    *,
    distribution: str = "normal",
    samples: int = 1024,
    tolerance: float = 1e-4,
    watch: Callable[[int, int], None] | None = None,
) -> Tolerances:
    """How far results of a test scatter where numbers of the muscle and of the test do, and which of them does it.

    Two answers are given. By derivatives, to first order: a standard deviation of each result, and the share that each
    number has in its square. By sampling: muscles are drawn (quasi-random numbers, the same at every call) and put to
    the test, which gives a distribution, and Sobol indices: the share of the variance that a number makes by itself
    (first order), and that in which it has a part (total; they differ where numbers work together).
    The numbers scatter independently of each other.

    Args:
        muscle: the muscle as meant.
        test: as for `run`; not along a branch.
        vary: number -> tolerance, {"braid.angle": "1 deg", "chamber.thickness": "10 %"}; numbers are named as for
            `sensitivity`, those of the test begin with "test.". A share in per cent is one of the number. A tolerance
            is one standard deviation of a normal distribution (cut off at 4 of them), or half the range of a uniform
            one: "0.1 mm uniform", or "0.1 mm normal".
        of: results, as for `sensitivity`. By default what the test is for: the force; contraction and length where
            the force is held; the pressure where it is free.
        state: which state of the test, counted from 0, or from the last one as -1.
        distribution: "normal" or "uniform", of the tolerances that do not say it themselves.
        samples: muscles that make the distribution, a power of 2. Sobol indices take half as many more for each number.
        tolerance: relative error of each state, as for `sweep`.
        watch: called with (muscles done, muscles in all).

    Returns:
        `Tolerances`: tables `spread` and `table`, `notes`. A state that is not stable is NaN, counted, and said in
        the notes; there are no Sobol indices then, and the quantiles are those of the other states.

    Raises:
        SpecError: for an unknown number or result, a tolerance that is not above 0 or that leaves the allowed range,
            friction, and a number of samples that is no power of 2.

    Source: A. Saltelli and others, Computer Physics Communications 181 (2010) 259, by scipy.stats.sobol_indices.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> vary = {"braid.angle": "0.5 deg", "chamber.thickness": "0.1 mm"}
    >>> found = mk.tolerances(mk.presets.paper(), test, vary, samples=64)
    >>> print(found.table.round(1).iloc[:, 1:3])
                                              tolerance  force share [%]
    braid.angle        0.5 deg (one standard deviation)             99.8
    chamber.thickness   0.1 mm (one standard deviation)              0.2
    """
    refuse_friction(muscle, "tolerances", "sweep() over some values of each number")
    numbers = scattering(muscle, test, vary, distribution)
    names = _results(muscle, test, of)
    if isinstance(samples, bool) or not isinstance(samples, int) or samples & (samples - 1):
        raise SpecError("samples", samples, "must be a power of 2", "such as 1024")
    if not FEWEST <= samples <= MOST:
        raise SpecError("samples", samples, f"must be from {FEWEST} to {MOST}")
    slopes = sensitivity(muscle, test, names, [one.name for one in numbers], state, tolerance=min(tolerance, FINE))
    found = drawn(muscle, test, numbers, names, state, samples, tolerance, watch)
    effect, value = _linear(slopes, numbers)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = effect**2 / (effect**2).sum(axis=0)
    results = {
        name: {"value": value[k], "unit": OBSERVED[name][0], "meaning": OBSERVED[name][1]}
        for k, name in enumerate(names)
    }
    about = {
        "title": f"McKibben muscle, {test.kind} test, state {slopes.data.attrs['state']}: tolerances",
        "state": slopes.data.attrs["state"], "verdict": slopes.verdict, "reason": slopes.reason,
        "tried": found.tried, "lost": sum(found.lost.values()),
        "muscle": to_toml(muscle, allow_custom=True), "test": to_toml(test), "assumed": ", ".join(muscle.assumed),
        "mckibben_version": versions()["mckibben"],
    }  # fmt: skip
    shares = {"effect": effect, "share": share, "first": found.first, "total": found.total}
    described = {one.name: _described(one, slopes) for one in numbers}
    about["notes"] = "\n".join(notes(numbers, found, slopes, effect, muscle.assumed))
    return Tolerances(muscle, test, dataset(described, results, shares, (found.numbers, found.results), about))


def _results(muscle: Muscle, test: Test, of: Sequence[str] | str | None) -> tuple[str, ...]:
    """Names of the results asked for; what the last step of the test leaves free if none are."""
    if of is None:
        controls = test.as_steps(muscle)[-1].controls
        free = next(name for name in ("force", "length", "pressure") if name not in controls)
        return ("contraction", "length") if free == "length" else (free,)
    names = (of,) if isinstance(of, str) else tuple(of)
    if not names:
        raise SpecError("of", allowed="must name at least one result", advice="one of " + ", ".join(RESULTS))
    for name in names:
        if name not in RESULTS:
            raise SpecError("of", name, "must be one of " + ", ".join(RESULTS), nearest(str(name), RESULTS))
    return tuple(dict.fromkeys(names))


def _linear(slopes: Sensitivity, numbers: tuple[Scattering, ...]) -> tuple[np.ndarray, list[float]]:
    """Change of each result by one standard deviation of each number, and the results; NaN unless it is stable."""
    rows = slopes.data["absolute"].sel(number=[one.name for one in numbers]).values
    signed = np.array([-one.deviation if one.turned else one.deviation for one in numbers])
    stable = 1.0 if slopes.verdict == Verdict.STABLE else np.nan
    return stable * rows * signed[:, None], (stable * slopes.data["result_value"].values).tolist()


def _described(one: Scattering, slopes: Sensitivity) -> dict[str, Any]:
    known = slopes.data.sel(number=one.name)
    unit = str(known["number_unit"].values)
    return {
        "value": one.value, "tolerance": one.size, "deviation": one.deviation,
        "distribution": str(one.distribution), "unit": unit,
        "display": one.display,
        "shown": one.text(one.value),
        "said": one.said, "meaning": one.declared.meaning, "assumed": bool(known["number_assumed"].values),
    }  # fmt: skip
