"""The step within a radius: the exact minimiser of a quadratic model, by the conditions that tell it."""

import numpy as np
import pytest

from mckibben.solver.trust_region import trust_region_step

pytestmark = pytest.mark.solver

# curvatures: positive, one nearly zero, one negative, all negative
SPECTRA = ((1.0, 2.0, 5.0, 9.0), (1e-9, 1.0, 3.0, 4.0), (-0.5, 0.5, 2.0, 7.0), (-3.0, -2.0, -1.0, -0.1))


@pytest.mark.parametrize("radius", [1e-3, 0.3, 1e3])
@pytest.mark.parametrize("spectrum", SPECTRA, ids=repr)
def test_it_is_the_minimiser(spectrum: tuple[float, ...], radius: float) -> None:
    """(H + shift) s = -g with shift >= 0 and H + shift positive, and |s| = radius unless the shift is zero."""
    random = np.random.default_rng(5)
    q = np.linalg.qr(random.normal(size=(4, 4)))[0]
    hessian, gradient = q @ np.diag(spectrum) @ q.T, random.normal(size=4)
    step = trust_region_step(hessian, gradient, radius)
    length = float(np.linalg.norm(step))
    shift = float(-(step @ (hessian @ step + gradient)) / length**2)
    size = float(np.abs(hessian).max()) + np.linalg.norm(gradient) / radius
    assert length <= radius * (1.0 + 1e-3)
    assert shift >= -1e-12 * size
    assert spectrum[0] + shift >= -1e-12 * size
    np.testing.assert_allclose(hessian @ step + shift * step, -gradient, rtol=0.0, atol=1e-14 * size * length)
    if length < radius * (1.0 - 2e-3):
        assert abs(shift) < 1e-9 * size


def test_hard_case() -> None:
    """The gradient has no part along the most negative mode: the step is completed along it."""
    step = trust_region_step(np.diag([-1.0, 2.0, 3.0]), np.array([0.0, 1.0, 1.0]), 2.0)
    np.testing.assert_allclose(np.abs(step), [np.sqrt(4.0 - 1.0 / 9.0 - 1.0 / 16.0), 1.0 / 3.0, 0.25], rtol=1e-12)
