"""Work along a path of states."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from mckibben.measure.work import hermite, slopes, work

pytestmark = pytest.mark.measure


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_the_spline_is_that_of_scipy(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    expected, t = CubicSpline(np.arange(count), values), np.linspace(0.0, 1.0, 5)
    at = np.arange(count - 1)[:, None] + t
    value, slope = hermite(values, slopes(values), t)
    assert value == pytest.approx(expected(at), abs=1e-14)
    assert slope == pytest.approx(expected(at, 1), abs=1e-13)


def test_work_of_cubics_is_exact() -> None:
    """F = t^3 over h = t^2 and P = 1 + t over V = t^3, whose integrals are 2 t^5/5 and t^3 + 3 t^4/4."""
    t = np.arange(7.0)
    found = work(t**3, t**2, 1.0 + t, t**3)
    assert found == pytest.approx(0.4 * t**5 + t**3 + 0.75 * t**4, rel=1e-13)


def test_too_few_states_for_work() -> None:
    none, one = np.zeros(0), np.ones(1)
    assert work(none, none, none, none).shape == (0,)
    assert work(one, one, one, one).tolist() == [0.0]
