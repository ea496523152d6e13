"""How sure a fit is: standard errors, correlations, directions that the data leave open, profile likelihoods.

Everything is in x, 0 to 1 between the bounds of each number, and turned into numbers at the end.
"""

from __future__ import annotations

import attrs
import numpy as np

from mckibben.fitting.misfit import Compared
from mckibben.fitting.search import Least, least

__all__ = ["OPEN", "Spread", "intervals_of", "members", "profile", "spread_of"]

OPEN = 0.5
"""Standard error along a direction, in parts of the ranges, from which on the data do not determine it."""
NEVER = 1e-12
"""Singular value over the largest one below which a direction does nothing."""
SHARE = 0.3
"""Part of a direction from which on a number belongs to it."""


@attrs.frozen(eq=False)
class Spread:
    """Of a fit with k numbers, all in x."""

    covariance: np.ndarray  #: (k, k); infinite where nothing is known
    scale: float  #: variance of a residual
    directions: tuple[np.ndarray, ...]  #: unit vectors (k) along which the data say nothing

    @property
    def errors(self) -> np.ndarray:
        """Standard errors (k)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> np.ndarray:
        """(k, k), NaN where an error is infinite."""
        size = np.where(np.isfinite(self.errors) & (self.errors > 0.0), self.errors, np.nan)
        with np.errstate(invalid="ignore"):
            return np.asarray(self.covariance / np.outer(size, size))

    @property
    def undetermined(self) -> np.ndarray:
        """Which numbers belong to a direction that is open (k)."""
        found = [members(direction) for direction in self.directions]
        return np.any(found, axis=0) if found else np.zeros(len(self.covariance), bool)


def members(direction: np.ndarray) -> np.ndarray:
    """Which numbers belong to a direction (k); one of many small parts has those of the largest."""
    size = np.abs(direction)
    return size >= min(SHARE, float(size.max()))


def spread_of(found: Least, known_size: bool) -> Spread:
    """From the Jacobian at the end of a search; the size of the errors comes from the residuals unless it is known."""
    n, k = found.jacobian.shape
    scale = 1.0 if known_size else 2.0 * found.cost / max(n - k, 1)
    _, values, rows = np.linalg.svd(found.jacobian, full_matrices=False)
    sure = values > NEVER * values[0]
    lengths = np.where(sure, np.sqrt(scale) / np.where(sure, values, 1.0), np.inf)
    directions = tuple(row for row, length in zip(rows, lengths, strict=True) if length > OPEN)
    covariance = (rows[sure].T * lengths[sure] ** 2) @ rows[sure]
    if not sure.all():
        lost = (np.abs(rows[~sure]) > 1e-6).any(axis=0)
        covariance = np.where(np.outer(lost, lost), np.inf, covariance)
    return Spread(covariance, scale, directions)


def profile(
    misfit: Compared, best: Least, spread: Spread, k: int, sigma: float, loss: str, distance: float
) -> tuple[float, float]:
    """x at which the sum of squares, least for number k held there, has grown by `distance` standard errors squared.

    0 or 1 where it does not grow so far within the bounds.
    """
    from scipy.optimize import brentq

    error = spread.errors[k] if np.isfinite(spread.errors[k]) else OPEN
    by = spread.covariance[:, k] / spread.covariance[k, k] if np.isfinite(spread.covariance[:, k]).all() else None

    def excess(x: float) -> float:
        near = np.clip(best.x + (0.0 if by is None else by * (x - best.x[k])), 0.0, 1.0)
        found = least(misfit, near, sigma, loss, (k, x))
        grown = max(2.0 * (found.cost - best.cost), 0.0) / spread.scale
        return float(np.sqrt(grown)) - distance if np.isfinite(grown) else 1e3

    ends = []
    for side, bound in ((-1.0, 0.0), (1.0, 1.0)):
        inside, outside = float(best.x[k]), float(best.x[k])
        step, end = distance * error, bound
        while outside != bound:
            outside = bound if abs(inside + side * step - best.x[k]) >= abs(bound - best.x[k]) else inside + side * step
            if excess(outside) > 0.0:
                end = float(brentq(excess, inside, outside, xtol=1e-3 * distance * min(error, 1.0), rtol=1e-6))
                break
            inside, step = outside, 2.0 * step
        ends.append(end)
    return ends[0], ends[1]


def intervals_of(
    misfit: Compared, best: Least, spread: Spread, sigma: float, loss: str, level: float, profiles: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends in x, by standard errors or by profiles."""
    from scipy.stats import t

    distance = float(t.ppf(0.5 + 0.5 * level, max(len(best.residuals) - len(best.x), 1)))
    if profiles:
        ends = [profile(misfit, best, spread, k, sigma, loss, distance) for k in range(len(best.x))]
        return np.array([low for low, _ in ends]), np.array([high for _, high in ends])
    reach = distance * np.where(np.isfinite(spread.errors), spread.errors, 1.0)
    return np.clip(best.x - reach, 0.0, 1.0), np.clip(best.x + reach, 0.0, 1.0)
