"""Draws from the posterior of a fit: against closed forms where the model is straight, a grid where it is curved."""

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import attrs
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import mckibben as mk
from mckibben.fitting.free import Free
from mckibben.fitting.misfit import Seen
from mckibben.fitting.sample import Drawn, drawn

pytestmark = pytest.mark.fitting

RANDOM = np.random.default_rng(5)
SLOPES = RANDOM.normal(size=(12, 2)) * [30.0, 8.0]
BEST = np.array([0.4, 0.55])
NOISE = RANDOM.normal(size=12)
NOISE -= SLOPES @ np.linalg.lstsq(SLOPES, NOISE)[0]  # so that BEST is the best


@attrs.define(eq=False)
class Model:
    """Forces as a plain function of x, which is the numbers themselves."""

    forces: Callable[[np.ndarray], np.ndarray]
    slopes: Callable[[np.ndarray], np.ndarray]
    force: np.ndarray
    free: tuple[Free, ...]

    @property
    def measured(self) -> Any:
        return SimpleNamespace(force=self.force, weights=np.ones(len(self.force)))

    @property
    def start(self) -> np.ndarray:
        return BEST

    def values(self, x: np.ndarray) -> np.ndarray:
        return x

    def __call__(self, x: np.ndarray) -> Seen:
        return Seen(self.forces(x), self.slopes(x))


def linear(priors: tuple[Any, Any] = (None, None), best: np.ndarray = BEST) -> Model:
    free = tuple(Free(f"{k}", "1", 0.0, 1.0, 0.5, prior=prior) for k, prior in enumerate(priors))
    return Model(lambda x: SLOPES @ x, lambda x: SLOPES, SLOPES @ best + NOISE, free)


def agrees(found: Drawn, mean: np.ndarray, sd: np.ndarray) -> None:
    """Within 3.5 standard errors of what so many draws tell; and the draws are many, and the chains agree."""
    seen = found.x.reshape(-1, found.x.shape[-1])
    assert (found.effective > 350).all()
    assert (found.rhat < 1.02).all()
    assert (np.abs(seen.mean(axis=0) - mean) < 3.5 * sd / np.sqrt(found.effective)).all()
    assert_allclose(seen.std(axis=0), sd, rtol=3.5 / np.sqrt(2.0 * found.effective.min()))


def test_errors_of_a_known_size() -> None:
    """The linear model: a normal posterior with the covariance of the fit."""
    found = drawn(linear(), BEST, 1.0, 500, 4, 1)
    agrees(found, BEST, np.sqrt(np.diag(np.linalg.inv(SLOPES.T @ SLOPES))))
    assert found.accepted > 0.6
    seen = found.x.reshape(-1, 2)
    covariance = np.linalg.inv(SLOPES.T @ SLOPES)
    expected = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert_allclose(np.corrcoef(seen.T)[0, 1], expected, atol=0.12)


def test_errors_of_an_unknown_size() -> None:
    """Student's t with n - k degrees of freedom: wider than the standard errors by the root of 10/8."""
    squares = NOISE @ NOISE / 10.0
    sd = np.sqrt(squares * np.diag(np.linalg.inv(SLOPES.T @ SLOPES)) * 10.0 / 8.0)
    agrees(drawn(linear(), BEST, None, 500, 4, 2), BEST, sd)


def test_what_is_known_beforehand() -> None:
    inverse = SLOPES.T @ SLOPES + np.diag([1.0 / 0.01**2, 0.0])
    mean = np.linalg.solve(inverse, SLOPES.T @ SLOPES @ BEST + np.array([0.42 / 0.01**2, 0.0]))
    agrees(drawn(linear(((0.42, 0.01), None)), mean, 1.0, 500, 4, 3), mean, np.sqrt(np.diag(np.linalg.inv(inverse))))


def test_bounds_cut_it_off() -> None:
    """At a bound: one side of a normal distribution."""
    one = SLOPES[:, :1]
    noise = NOISE - one[:, 0] * (one[:, 0] @ NOISE) / (one[:, 0] @ one[:, 0])
    model = Model(lambda x: one @ x, lambda x: one, noise, (Free("0", "1", 0.0, 1.0, 0.5),))
    sd = 1.0 / np.linalg.norm(one)
    found = drawn(model, np.array([1e-9]), 1.0, 700, 4, 4)
    assert (found.x >= 0.0).all()
    agrees(found, np.array([sd * np.sqrt(2.0 / np.pi)]), np.array([sd * np.sqrt(1.0 - 2.0 / np.pi)]))


def test_a_curved_model_against_a_grid() -> None:
    """Far from normal: of a force that grows with the square, mean and width by integration."""
    force = np.array([0.1, 0.3, 0.2])
    model = Model(lambda x: np.repeat(3.0 * x**2, 3), lambda x: np.full((3, 1), 6.0 * x[0]), force,
                  (Free("0", "1", 0.0, 1.0, 0.5),))  # fmt: skip
    grid = np.linspace(0.0, 1.0, 20001)
    weight = np.exp(-0.5 * ((3.0 * grid[:, None] ** 2 - force) ** 2).sum(axis=1) / 0.5**2)
    mean = np.average(grid, weights=weight)
    sd = np.sqrt(np.average((grid - mean) ** 2, weights=weight))
    agrees(drawn(model, np.array([np.sqrt(0.2 / 3.0)]), 0.5, 700, 4, 5), np.array([mean]), np.array([sd]))


def test_the_same_seed_gives_the_same() -> None:
    first, second, other = (drawn(linear(), BEST, 1.0, 50, 2, seed) for seed in (7, 7, 8))
    assert_array_equal(first.x, second.x)
    assert not np.array_equal(first.x, other.x)


@pytest.fixture(scope="module")
def fit() -> mk.Fit:
    """Of one number, nearly linear."""
    muscle = mk.presets.paper()
    curve = mk.run(muscle, mk.Isobaric(length="80 mm to 115 mm", pressure="1 bar", points=8))
    force = curve.force + 0.5 * np.random.default_rng(3).normal(size=8)
    table = {"length [m]": curve.length, "pressure [Pa]": np.full(8, 1e5), "force [N]": force}
    return mk.fit(muscle, mk.read_data(table), {"braid.angle": "35 deg to 39 deg"}, starts=1, force_error="0.5 N",
                  priors={"braid.angle": "37 deg +- 1 deg"})  # fmt: skip


def test_a_nearly_linear_fit_has_its_standard_errors(fit: mk.Fit) -> None:
    found = fit.sample(draws=60, chains=2)
    error = fit.data["error"].values
    assert dict(found.sizes) == {"chain": 2, "draw": 60, "number": 1}
    assert_allclose(found["sd"], error, rtol=3.0 / np.sqrt(2.0 * found["effective"].item()))
    assert_allclose(found["mean"], fit.data["value"], atol=3.0 * error[0] / np.sqrt(found["effective"].item()))
    assert_array_equal(found["fit_low"], fit.data["low"])
    assert_allclose(found["low"], fit.data["value"] - 1.96 * error, atol=0.6 * error[0])
    assert found.attrs["notes"] == ""
    assert found.attrs["accepted"] > 0.6


def test_what_was_known_is_kept(fit: mk.Fit, tmp_path: Any) -> None:
    (one,) = mk.load(mk.save(fit, tmp_path / "fit.nc")).free
    assert one.prior == pytest.approx((np.radians(37.0), np.radians(1.0)))


def test_bad_input(fit: mk.Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(mk.SpecError, match=r"sample.draws = 10: must be a whole number, at least 50"):
        fit.sample(draws=10)
    with pytest.raises(mk.SpecError, match=r"sample.chains"):
        fit.sample(chains=1)
    huber = attrs.evolve(fit, data=fit.data.assign_attrs(loss="huber"))
    with pytest.raises(mk.SpecError, match="normal errors"):
        huber.sample()
    old = attrs.evolve(fit, data=fit.data.drop_vars("prior"))
    with pytest.raises(mk.SpecError, match="fit again"):
        old.sample()
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(mk.SpecError, match=r'pip install "mckibben\[bayes\]"'):
        fit.sample()
