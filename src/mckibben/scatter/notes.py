"""What must be known of tolerances, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mckibben.results.sensitivity import Sensitivity
from mckibben.results.verdict import Verdict
from mckibben.scatter.draw import Drawn
from mckibben.scatter.given import REACH, Distribution, Scattering

__all__ = ["notes"]

CURVED = 0.1
"""Difference between the standard deviation by sampling and by derivatives, over the latter, that is worth a word."""
TOGETHER = 0.05
"""Share of the variance by numbers together, likewise."""


def notes(
    numbers: tuple[Scattering, ...], found: Drawn, slopes: Sensitivity, effect: np.ndarray, assumed: tuple[str, ...]
) -> Iterator[str]:
    """The sentences, what spoils numbers first."""
    results = [str(name) for name in slopes.data["result"].values]
    if slopes.verdict != Verdict.STABLE:
        yield f"no estimate by derivatives: the state as meant is {slopes.verdict}: {slopes.reason}"
    for word, count in found.lost.items():
        what = "could not be computed" if word == "not computed" else f"have a state that is {word}"
        why = f", the first because: {found.why[word]}" if found.why[word] else ""
        yield f"{count} of {found.tried} muscles {what}{why}"
    if found.lost:
        yield "there are no Sobol indices therefore, and standard deviation and quantiles are those of the others"
    else:
        yield from _differences(results, found, effect)
    if any(one.distribution == Distribution.NORMAL for one in numbers):
        yield f"of normal tolerances one standard deviation is given; nothing beyond {REACH:g} of them is drawn"
    if any(one.distribution == Distribution.UNIFORM for one in numbers):
        yield "of uniform tolerances half the range is given"
    yield f"{len(found.results)} samples, {found.tried} muscles with those for Sobol indices"
    yield "the numbers scatter independently of each other"
    if assumed:
        yield f"assumed, not measured (*): {', '.join(assumed)}"


def _differences(results: list[str], found: Drawn, effect: np.ndarray) -> Iterator[str]:
    """Where derivatives are not the whole of it."""
    linear, sampled = np.sqrt((effect**2).sum(axis=0)), found.results.std(axis=0, ddof=1)
    for name, one, other, first in zip(results, linear, sampled, found.first.T, strict=True):
        if one > 0.0 and abs(other / one - 1.0) > CURVED:
            way = "above" if other > one else "below"
            off = 100.0 * abs(other / one - 1.0)
            yield f"{name}: the standard deviation by sampling is {off:.0f} % {way} the linear one; take the sampled"
        if other > 0.0 and 1.0 - first.sum() > TOGETHER:
            yield f"{name}: {100.0 * (1.0 - first.sum()):.0f} % of the variance are made by several numbers together"
