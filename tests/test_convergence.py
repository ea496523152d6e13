"""How fast the force converges with the number of unknowns, and that the error estimate bounds its error on the way."""

import numpy as np
import pytest
from readings import recovered

import mckibben as mk
from mckibben.solver.bench import Bench
from mckibben.solver.equilibrium import Equilibrium
from mckibben.solver.find import find
from mckibben.solver.held import Held

pytestmark = pytest.mark.solver

REFERENCE = mk.presets.reference()
STIFF = REFERENCE.replace("braid.fibre", mk.Fibre(B1=57.5e-6, B2=57.5e-6, B3=41e-6))
"""100 times as stiff: its end layers are so wide that uniform elements resolve them."""


def state(muscle: mk.Muscle, length: float, size: int, b: float = 2.0, discretisation: str = "spectral") -> Equilibrium:
    """The state at 1 bar, with points crowded by b."""
    problem = Bench.of(muscle).problem(size, b, discretisation)
    found = find(problem, Held.of(length=length, pressure=1e5))
    assert found.converged
    return found


def estimate(found: Equilibrium) -> float:
    return float(recovered(found).error[0])


@pytest.mark.parametrize("length", [0.115, 0.055])
@pytest.mark.parametrize("b", [0.5, 1.2], ids=["uniform", "crowded"])
def test_spectral_convergence(length: float, b: float) -> None:
    """The logarithm of the error is a straight line over the number of unknowns, so the local power only grows."""
    sizes = np.array([6, 12, 18, 24])
    exact = state(REFERENCE, length, 48).force
    states = [state(REFERENCE, length, size, b) for size in sizes.tolist()]
    error = np.array([abs(found.force / exact - 1.0) for found in states])
    slope, _ = np.polyfit(sizes, np.log(error), 1)
    assert slope < -0.8
    assert np.corrcoef(sizes, np.log(error))[0, 1] < -0.994
    power = -np.diff(np.log(error)) / np.diff(np.log(sizes))
    assert (np.diff(power) > 0.9).all()
    assert power[-1] > 17.0
    assert (error[1::2] < 0.05 * np.array([estimate(found) for found in states[1::2]])).all()


@pytest.mark.parametrize(("length", "exact"), [(0.2277, -8.555708500), (0.2280, -8.569649803)])
def test_the_estimate_of_a_wavy_wall(length: float, exact: float) -> None:
    """A long slack braid, pushed: the last two coefficients are 50 times smaller than those before them, by chance.

    Forces on 256 unknowns [N]; the error is of 1e-6.
    """
    fibre = mk.Fibre(diameter="0.238 mm", E="2.63 GPa", nu=0.4)
    braid = mk.Braid(radius="20.6 mm", length="229.5 mm", angle="66.9 deg", fibres=52, fibre=fibre)
    wall = mk.Chamber(thickness="0.386 mm", law=mk.MooneyRivlin(c1="0.952 MPa", c2="0.261 MPa"))
    problem = Bench.of(mk.Muscle(braid=braid, chamber=wall)).problem(192, 2.87)
    found = find(problem, Held.of(length=length, pressure=0.0))
    error = abs(found.force / exact - 1.0)
    assert 1e-6 < error < estimate(found) < 5e-6


def test_cubic_splines_converge_with_the_fourth_power_of_their_length() -> None:
    """Where they resolve the end layer: an energy of second derivatives, so twice (4 - 2)."""
    sizes, exact = np.array([13, 23, 43]), state(STIFF, 0.070, 24, 1.0).force
    error = [abs(state(STIFF, 0.070, size, 0.0, "paper").force / exact - 1.0) for size in sizes.tolist()]
    slope, _ = np.polyfit(np.log(sizes - 3), np.log(error), 1)
    assert slope == pytest.approx(-4.0, abs=0.1)
    assert error[-1] < 3e-5


def test_the_papers_mesh_does_not_resolve_a_thin_end_layer() -> None:
    """Clamped reference muscle: an error of 1e-2 with 43 splines, which the estimate does not hide."""
    coarse, exact = state(REFERENCE, 0.115, 43, 0.0, "paper"), state(REFERENCE, 0.115, 24)
    error = abs(coarse.force / exact.force - 1.0)
    assert error == pytest.approx(0.0088181, rel=1e-4)
    assert error < estimate(coarse) < 0.05
