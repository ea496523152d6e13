"""The muscle whose forces differ least from the measured ones: bounded least squares of SciPy, exact Jacobians."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from mckibben.fitting.misfit import Compared
from mckibben.spec.errors import SpecError, nearest

__all__ = ["LOSSES", "Least", "candidates", "check_options", "cost_of", "least", "residuals_of", "slopes_of"]

LOSSES = ("linear", "soft_l1", "huber", "cauchy")
"""How large differences count: squared, or less than that."""
CLOSE = 1e-8
"""Relative change of the sum of squares, and of the numbers, at which a search ends."""


@attrs.frozen(eq=False)
class Least:
    """Where a search ended."""

    x: np.ndarray
    jacobian: np.ndarray  #: (n + priors, k) of the residuals by x, as the loss weighs them
    residuals: np.ndarray  #: (n + priors), over the size of an error
    cost: float  #: half the sum of squares, as the loss counts them
    evaluations: int
    message: str
    converged: bool


def check_options(loss: str, level: float) -> None:
    """SpecError for a loss that is not known, or a level of intervals out of range."""
    if loss not in LOSSES:
        raise SpecError("loss", loss, "must be one of " + ", ".join(LOSSES), nearest(str(loss), LOSSES))
    if not 0.5 <= level < 1.0:
        raise SpecError("level", level, "must be at least 0.5 and below 1", "0.95 is usual")


def residuals_of(misfit: Compared, x: np.ndarray, sigma: float) -> np.ndarray:
    """Residuals over their size: those of the points, then those of what is known."""
    measured = misfit.measured
    found = [np.sqrt(measured.weights) / sigma * (misfit(x).force - measured.force)]
    for one, value in zip(misfit.free, misfit.values(x), strict=True):
        if one.prior is not None:
            mean, sd = one.prior
            found.append(np.array([(value - mean) / sd]))
    return np.concatenate(found)


def slopes_of(misfit: Compared, x: np.ndarray, sigma: float) -> np.ndarray:
    """Their derivatives by x."""
    weight = np.sqrt(misfit.measured.weights) / sigma
    found = [weight[:, None] * misfit(x).slopes]
    for k, one in enumerate(misfit.free):
        if one.prior is not None:
            found.append((np.arange(len(x)) == k)[None] * one.slope(float(x[k])) / one.prior[1])
    return np.concatenate(found)


def cost_of(misfit: Compared, x: np.ndarray, sigma: float) -> tuple[int, float]:
    """Of a start: how many points have no state, and half the sum of squares of the others."""
    residuals = residuals_of(misfit, x, sigma)
    return int(np.isnan(residuals).sum()), 0.5 * float(np.nansum(residuals**2))


def candidates(misfit: Compared, count: int) -> list[np.ndarray]:
    """Starts: the muscle as given, then points that fill the range evenly (Sobol); the same ones every time."""
    k = len(misfit.free)
    start = np.clip(misfit.start, 0.02, 0.98)
    if count <= 1:
        return [start]
    from scipy.stats import qmc  # takes half a second to import

    spread = qmc.Sobol(k, scramble=False).random(1 << int(count - 1).bit_length())[1:count]
    offset = np.array([one.name.startswith("offset.") for one in misfit.free])
    return [start, *(np.where(offset, 0.5, 0.05 + 0.9 * row) for row in spread)]


def least(
    misfit: Compared, start: np.ndarray, sigma: float, loss: str, fixed: tuple[int, float] | None = None,
    watch: Callable[[int], None] = lambda count: None,
) -> Least:  # fmt: skip
    """Search from a start; one of the numbers may be fixed at a value of its x.

    The cost is infinite where the muscle of the start has no state at some point.
    """
    from scipy.optimize import least_squares

    moving = np.array([fixed is None or k != fixed[0] for k in range(len(misfit.free))])
    n = len(misfit.measured.force)
    count = 0

    def whole(part: np.ndarray) -> np.ndarray:
        x = np.empty(len(moving))
        x[moving] = part
        if fixed is not None:
            x[fixed[0]] = fixed[1]
        return x

    def residuals(part: np.ndarray) -> Any:
        nonlocal count
        count += 1
        watch(count)
        return residuals_of(misfit, whole(part), sigma)

    def jacobian(part: np.ndarray) -> Any:
        return slopes_of(misfit, whole(part), sigma)[:, moving]

    begin = np.clip(start[moving], 1e-6, 1.0 - 1e-6)
    found, by = residuals(begin), _loss(loss, n)
    if not moving.any():
        counted = found**2 if isinstance(by, str) else by(found**2)[0]
        return Least(whole(begin), np.zeros((len(found), 0)), found, 0.5 * float(counted.sum()), 1, "fixed", True)
    if not np.isfinite(found).all():
        return Least(whole(begin), jacobian(begin), found, math.inf, 1, "a point is beyond reach at the start", False)
    solved = least_squares(
        residuals, begin, jacobian, bounds=(0.0, 1.0), method="trf", x_scale=1.0, loss=by,
        ftol=CLOSE, xtol=CLOSE, gtol=1e-12, max_nfev=200,
    )  # fmt: skip
    x = whole(solved.x)
    return Least(x, solved.jac, solved.fun, float(solved.cost), count, str(solved.message), solved.status > 0)


def _loss(name: str, n: int) -> Any:
    """A loss for the n points; what is known beforehand always counts squared."""
    if name == "linear":
        return name

    def rho(z: np.ndarray) -> np.ndarray:
        if name == "soft_l1":
            t = 1.0 + z
            found = np.stack([2.0 * (np.sqrt(t) - 1.0), t**-0.5, -0.5 * t**-1.5])
        elif name == "cauchy":
            t = 1.0 + z
            found = np.stack([np.log(t), 1.0 / t, -1.0 / t**2])
        else:  # Huber
            far = z > 1.0
            t = np.where(far, z, 1.0)
            found = np.where(far, np.stack([2.0 * t**0.5 - 1.0, t**-0.5, -0.5 * t**-1.5]),
                             np.stack([z, np.ones_like(z), np.zeros_like(z)]))  # fmt: skip
        found[:, n:] = np.stack([z[n:], np.ones(len(z) - n), np.zeros(len(z) - n)])
        return np.asarray(found)

    return rho
