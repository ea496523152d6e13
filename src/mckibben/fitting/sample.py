"""Draws from the posterior of a fit: what is known of its numbers after the data, without taking anything as straight.

The posterior of x is the likelihood of normal errors times what is known beforehand; where nothing is, all of a
number's range is as likely (of its logarithm where that is searched). An unknown size of the errors is integrated out
with the density 1/sigma, which leaves S^(-n/2) of the sum of squares S.

Each chain is one of Metropolis and Hastings by emcee. Most steps propose from a t distribution around the best values,
with the covariance of the linear model, whatever the present state; where the problem is nearly linear nearly all of
them are taken, so that a draw costs one evaluation of the model. The others go some way from where the chain is, which
finds its way along a curved valley.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mckibben.fitting.misfit import Compared
from mckibben.fitting.search import residuals_of, slopes_of
from mckibben.fitting.uncertain import OPEN
from mckibben.spec import SpecError

__all__ = ["Drawn", "drawn"]

FREEDOM = 5.0
"""Degrees of freedom of the t distribution: its tails are wider than those of most posteriors."""
WIDER = 1.2
"""Its scale over that of the linear model."""
GLOBAL = 0.7
"""Part of the steps that propose from it."""
NARROW = 0.7
"""Scale of the other steps over that of the linear model."""
TUNE = 0.2
"""Steps that are made and left out before the first draw, over the draws."""


class Drawn(NamedTuple):
    """Draws of several chains."""

    x: np.ndarray  #: (chain, draw, number)
    rhat: np.ndarray  #: (number) how much more chains differ among each other than within: near 1 when they agree
    effective: np.ndarray  #: (number) how many independent draws they are worth for the mean
    effective_tail: np.ndarray  #: (number) the same for the ends of a 90 % interval
    accepted: float  #: part of the steps that were taken


def drawn(
    misfit: Compared, best: np.ndarray, sigma: float | None, draws: int, chains: int, seed: int,
    watch: Callable[[int, int], None] = lambda done, total: None,
) -> Drawn:  # fmt: skip
    """Draws of x around the best one; `sigma` is the size of an error, None where the data themselves tell it."""
    emcee, stats = _libraries()
    n = len(misfit.measured.force)
    size = sigma if sigma is not None else _size(misfit, best)
    density = _density(misfit, n, sigma)
    root = _root(misfit, best, size)
    moves = [(emcee.moves.MHMove(_anywhere(best, WIDER * root)), GLOBAL),
             (emcee.moves.MHMove(_near(NARROW * root)), 1.0 - GLOBAL)]  # fmt: skip
    sampler = emcee.EnsembleSampler(chains, len(best), density, moves=moves)
    random = np.random.RandomState(seed)
    begin = np.clip(best + random.standard_normal((chains, len(best))) @ root, 1e-6, 1.0 - 1e-6)
    found = np.array([density(row) for row in begin])
    begin[~np.isfinite(found)] = best
    tune = max(10, int(TUNE * draws))
    steps = sampler.sample(emcee.State(begin, random_state=random.get_state()), iterations=tune + draws,
                           skip_initial_state_check=True)  # fmt: skip
    for done, _ in enumerate(steps, 1):
        watch(done, tune + draws)
    x = np.swapaxes(sampler.get_chain(discard=tune), 0, 1)
    rhat, bulk, tail = (np.array([float(of(x[..., k])) for k in range(len(best))]) for of in stats)
    return Drawn(x, rhat, bulk, tail, float(np.mean(sampler.acceptance_fraction)))


def _libraries() -> tuple[Any, tuple[Callable[[np.ndarray], Any], ...]]:
    try:
        import emcee
        from arviz_stats.base import array_stats
    except ImportError as error:
        said = "takes emcee and arviz-stats"
        raise SpecError("sample", allowed=said, advice='pip install "mckibben[bayes]"') from error
    axes = {"chain_axis": 0, "draw_axis": 1}
    return emcee, (
        lambda x: array_stats.rhat(x, **axes),
        lambda x: array_stats.ess(x, method="bulk", **axes),
        lambda x: array_stats.ess(x, method="tail", prob=0.9, **axes),
    )


def _size(misfit: Compared, best: np.ndarray) -> float:
    """Root of the sum of squares over the degrees of freedom [N]."""
    measured = misfit.measured
    left = np.sqrt(measured.weights) * (misfit(best).force - measured.force)
    return float(np.sqrt(left @ left / max(len(left) - len(best), 1)))


def _density(misfit: Compared, n: int, sigma: float | None) -> Callable[[np.ndarray], float]:
    """Logarithm of the posterior density of x, but for a constant."""

    def density(x: np.ndarray) -> float:
        if not ((x >= 0.0) & (x <= 1.0)).all():
            return -np.inf
        residuals = residuals_of(misfit, x, sigma or 1.0)
        squares = residuals[:n] @ residuals[:n]
        of_data = -0.5 * squares if sigma is not None else -0.5 * n * np.log(max(float(squares), 1e-300))
        found = float(of_data - 0.5 * residuals[n:] @ residuals[n:])
        return found if np.isfinite(found) else -np.inf

    return density


def _root(misfit: Compared, best: np.ndarray, size: float) -> np.ndarray:
    """R with R^T R the covariance of the linear model; directions that the data leave open are as wide as the range."""
    _, values, rows = np.linalg.svd(slopes_of(misfit, best, size), full_matrices=False)
    lengths = np.minimum(1.0 / np.maximum(values, 1e-300), OPEN)
    return np.asarray(lengths[:, None] * rows)


Proposal = Callable[[np.ndarray, Any], tuple[np.ndarray, np.ndarray]]


def _anywhere(best: np.ndarray, root: np.ndarray) -> Proposal:
    """From a t distribution around the best, wherever a chain is; with the ratio of densities that this takes."""
    k, back = len(best), np.linalg.inv(root)

    def density(x: np.ndarray) -> np.ndarray:
        squares = np.sum(((x - best) @ back) ** 2, axis=1)
        return np.asarray(-0.5 * (FREEDOM + k) * np.log1p(squares / FREEDOM))

    def propose(x: np.ndarray, random: Any) -> tuple[np.ndarray, np.ndarray]:
        normal = random.standard_normal(x.shape)
        there = best + (normal @ root) * np.sqrt(FREEDOM / random.chisquare(FREEDOM, len(x)))[:, None]
        return there, density(x) - density(there)

    return propose


def _near(root: np.ndarray) -> Proposal:
    """From a normal distribution around where a chain is."""
    return lambda x, random: (x + random.standard_normal(x.shape) @ root, np.zeros(len(x)))
