"""Fibres that stiffen: the moment, the limit of the paper's fibres, and the tension."""

from typing import Any

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import mckibben as mk
from mckibben.model.fibres import fibre_densities
from mckibben.model.parameters import parameters
from mckibben.model.point import Point

pytestmark = pytest.mark.effects

HELD: dict[str, Any] = {"length": "55 mm", "pressure": "0.5 bar"}


def stiffening(curvature: float, exponent: int = 4, **changes: Any) -> mk.Muscle:
    """The paper's muscle with fibres that stiffen."""
    law = mk.Stiffening(curvature=curvature, exponent=exponent)
    muscle = mk.presets.paper().replace("braid.fibre.stiffening", law)
    for name, value in changes.items():
        muscle = muscle.replace(name, value)
    return muscle


@pytest.mark.parametrize("exponent", [4, 6])
def test_the_moment_doubles_at_the_curvature(exponent: int) -> None:
    """Of normal bending on a cylinder, whose u2 and u3 depend on theta: at u2 - u20 = c its moment is twice B2 c."""
    plain, p = (parameters(muscle) for muscle in (mk.presets.paper(), stiffening(10.0, exponent)))

    def bending(theta: Any, numbers: Any) -> Any:
        return fibre_densities(Point.cylinder(theta), numbers)[1]

    R0, t0 = float(p.R0), float(p.theta0)
    theta = float(
        np.arccos(np.cos(t0) - 10.0 * R0 / np.cos(t0))
    )  # u2 - u20 = cos(theta0) (cos(theta0) - cos(theta))/R0
    slopes = [float(jax.grad(bending)(theta, numbers)) for numbers in (p, plain)]
    assert slopes[0] == pytest.approx(2.0 * slopes[1], rel=1e-12, abs=0.0)
    shares = [float(bending(theta, numbers)) for numbers in (p, plain)]
    assert shares[0] == pytest.approx((1.0 + 2.0 / exponent) * shares[1], rel=1e-12, abs=0.0)


def test_soft_strains_are_the_papers() -> None:
    """The force differs by (1/c)^(n - 2) as c grows."""
    plain = mk.solve(mk.presets.paper(), **HELD, tolerance=1e-9).force
    curvatures = np.array([1000.0, 2000.0, 4000.0])
    more = [mk.solve(stiffening(c), **HELD, tolerance=1e-9).force - plain for c in curvatures.tolist()]
    slope = np.polyfit(np.log(curvatures), np.log(np.abs(more)), 1)[0]
    assert abs(slope + 2.0) < 0.1  # strains of the end layers are not small beside c yet


def test_states_are_equilibria() -> None:
    """What is conserved is conserved, and the work is stored."""
    test = mk.Isobaric(pressure="0.5 bar", length="55 mm to 65 mm", points=61)
    curve = mk.run(stiffening(300.0), test, tolerance=1e-9)
    assert curve.data["conserved_variation"].max() < 1e-7
    stored = curve.data["energy"].values[-1] - curve.data["energy"].values[0]
    assert_allclose(curve.data["work"].values[-1], stored, rtol=2e-6)


def test_tension_is_that_of_fibres_that_hardly_stretch() -> None:
    inner, muscle = slice(16, 113), stiffening(300.0)
    tensions = [
        mk.solve(one, **HELD, tolerance=1e-9).result.data["fibre_tension"].values[0, inner]
        for one in (
            muscle,
            muscle.replace("braid.fibre.stretch", True).replace("braid.fibre.axial_stiffness", "1e5 N"),
            mk.presets.paper(),
        )
    ]
    size = tensions[0].max()
    assert np.abs(tensions[1] - tensions[0]).max() < 2e-5 * size
    assert np.abs(tensions[2] - tensions[0]).max() > 1e-3 * size  # of fibres that do not stiffen


@pytest.mark.parametrize("given", [{"curvature": "-1 1/m"}, {"curvature": "20 1/m", "exponent": 5},
                                   {"curvature": "20 1/m", "exponent": 2}])  # fmt: skip
def test_wrong_input(given: dict[str, Any]) -> None:
    with pytest.raises(mk.SpecError, match="stiffening"):
        mk.Stiffening(**given)
