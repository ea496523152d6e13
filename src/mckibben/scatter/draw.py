"""Muscles drawn from the tolerances, quasi-randomly; their results; and shares of the variance by what they show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from operator import attrgetter
from typing import Any

import attrs
import numpy as np

from mckibben.results.verdict import Verdict
from mckibben.scatter.given import Scattering
from mckibben.spec import Muscle, Path, Test
from mckibben.spec.contraction import DECLARED as CONTRACTION
from mckibben.spec.plausible import trusted
from mckibben.sweeps.sweep import sweep

__all__ = ["Drawn", "drawn"]

SEED = 2023
"""Of the quasi-random numbers: the same call draws the same muscles."""


@attrs.frozen
class Drawn:
    """Muscles that were tried: n first ones and n second ones, and for each number the first with it from the second.

    The first and the second, 2n, are the samples of the distribution.
    """

    numbers: np.ndarray  #: (2n, d)
    results: np.ndarray  #: (2n, r) SI; NaN where the state is not stable
    first: np.ndarray  #: (d, r) Sobol indices; NaN unless every state is stable
    total: np.ndarray  #: (d, r)
    lost: dict[str, int]  #: how many of all that were tried are of each verdict but stable
    why: dict[str, str]  #: the first reason that was given for each
    tried: int


def drawn(
    muscle: Muscle,
    test: Test,
    scattering: tuple[Scattering, ...],
    results: tuple[str, ...],
    state: int,
    samples: int,
    tolerance: float,
    watch: Callable[[int, int], None] | None,
) -> Drawn:
    """`samples` muscles, and as many more as Sobol indices take, put to the test in one sweep."""
    from scipy.stats import qmc  # here, because it takes a second to import

    d, n = len(scattering), samples // 2
    shares = qmc.Sobol(2 * d, rng=SEED).random(n)
    one, other = shares[:, :d], shares[:, d:]
    mixed = np.repeat(one[None], d, axis=0)
    for k in range(d):
        mixed[k, :, k] = other[:, k]
    numbers = _at(scattering, np.concatenate([one, other, mixed.reshape(-1, d)]))
    with trusted():  # they are in SI
        table = _table(muscle, test, scattering, numbers)
        data = sweep(muscle, test, designs=table, tolerance=tolerance, workers=0, watch=watch)
    seen = data.isel(step=state)
    words = [word.replace("_", " ") for word in data["verdict"].attrs["flag_meanings"].split()]
    verdicts = np.array(words)[seen["verdict"].values + 1]  # the first word stands for -1
    stable = verdicts == str(Verdict.STABLE)
    found = np.where(stable[:, None], np.stack([seen[name].values for name in results], axis=1), np.nan)
    lost = Counter(verdicts[~stable].tolist())
    reasons = data["reason"].values
    why = {word: next((str(r) for r in reasons[verdicts == word] if r), "") for word in lost}
    first, total = _indices(found, n, d) if stable.all() else (np.full((d, len(results)), np.nan),) * 2
    return Drawn(numbers[: 2 * n], found[: 2 * n], first.copy(), total.copy(), dict(lost), why, len(found))


def _at(scattering: tuple[Scattering, ...], shares: np.ndarray) -> np.ndarray:
    """The numbers (muscles, d) below which shares of all lie."""
    return np.stack([one.at(shares[:, k]) for k, one in enumerate(scattering)], axis=1)


def _indices(found: np.ndarray, n: int, d: int) -> tuple[np.ndarray, np.ndarray]:
    """Sobol indices (d, results) of first order and total; zero for a result that does not scatter."""
    from scipy.stats import sobol_indices

    found = np.concatenate([found, found[:, :1]], axis=1)  # scipy fails on one result of one number
    r = found.shape[1]
    values = {"f_A": found[:n].T, "f_B": found[n : 2 * n].T, "f_AB": found[2 * n :].reshape(d, n, r).swapaxes(1, 2)}
    seen = sobol_indices(func=values, n=n)
    return seen.first_order.reshape(r, d)[:-1].T, seen.total_order.reshape(r, d)[:-1].T


def _table(muscle: Muscle, test: Test, scattering: tuple[Scattering, ...], numbers: np.ndarray) -> dict[str, list[Any]]:
    """The columns of a sweep's table: a field each, whole where several numbers make it."""
    table: dict[str, list[Any]] = {}
    for one, column in zip(scattering, numbers.T.tolist(), strict=True):
        field, place = _field(one.name)
        if field not in table:
            whole = _whole(muscle, test, field)
            table[field] = [whole] * len(column)
        table[field] = [_put(whole, place, value) for whole, value in zip(table[field], column, strict=True)]
    return table


def _field(name: str) -> tuple[str, Any]:
    """The field that a number is in, and its place there: "chamber.law.mu[1]" is number 1 of "chamber.law.mu"."""
    head, constants, key = name.partition(".constants.")
    if constants:
        return f"{head}.constants", key
    name, bracket, place = name.removesuffix("]").rpartition("[") if name.endswith("]") else (name, "", "")
    name = name.replace("[", ".").replace("]", "")  # "test.steps[1].length" is the field "test.steps.1.length"
    return name, int(place) if bracket else None


def _whole(muscle: Muscle, test: Test, field: str) -> Any:
    """What a field is, before anything scatters; None for a single number."""
    owner: Any = muscle
    names = field.split(".")
    if names[0] == "test":
        owner, names = test, names[1:]
    names = ["length" if name == CONTRACTION.name else name for name in names]
    for name in names:
        owner = owner[int(name)] if name.isdecimal() else attrgetter(name)(owner)
    return owner


def _put(whole: Any, place: Any, value: float) -> Any:
    """A field with one of its numbers anew."""
    if isinstance(whole, Path):
        waypoints = list(whole.waypoints)
        waypoints[place or 0] = value
        return attrs.evolve(whole, waypoints=tuple(waypoints))
    if isinstance(whole, tuple):
        return tuple(value if k == place else item for k, item in enumerate(whole))
    return dict(whole) | {place: value} if place is not None else value
