"""Other ways to the same 21 states: SciPy's trust-constr with exact derivatives, and collocation by `solve_bvp`.

trust-constr minimises the paper's 43 B-splines with the package's own gradients and Hessians; `solve_bvp` solves the
Hamiltonian form of the test that checks the package (`tests/test_hamiltonian.py`), with its derivatives given.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from curve import LONG, MUSCLE, PATH, PRESSURES, error, problem
from scipy.optimize import NonlinearConstraint, minimize
from timing import once

from mckibben.discretise.bspline import Spline
from mckibben.solver.held import targets_of
from mckibben.solver.problem import LENGTH, VOLUME

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from test_hamiltonian import Half


def trust_constr() -> list[float]:
    """Forces [N] of the curve; each state from the one before."""
    on = problem(Spline(43))
    u, forces = np.zeros(on.basis.unknowns), []
    for held in PATH:
        length, pressure = targets_of((held,), on.unit, on.loads)[0]

        def energy(u: np.ndarray, pressure: float = pressure) -> float:
            totals = on.balance(u).totals
            return float(totals[0] - pressure * totals[VOLUME])

        def slope(u: np.ndarray, pressure: float = pressure) -> np.ndarray:
            gradients = np.asarray(on.balance(u).gradients)
            return np.asarray(gradients[0] - pressure * gradients[VOLUME])

        def bend(u: np.ndarray, pressure: float = pressure) -> np.ndarray:
            return on.curvature(u, np.array([1.0, 0.0, -pressure, 0.0]))

        holding = NonlinearConstraint(
            lambda u: np.asarray(on.balance(u).totals)[LENGTH],
            length,
            length,
            jac=lambda u: np.asarray(on.balance(u).gradients)[LENGTH],
            hess=lambda u, v: v[0] * on.curvature(u, np.array([0.0, 1.0, 0.0, 0.0])),
        )
        options = {"gtol": 1e-8, "xtol": 1e-10, "maxiter": 500}
        found = minimize(energy, u, jac=slope, hess=bend, method="trust-constr", constraints=holding, options=options)
        u = found.x
        forces.append(float(-found.v[0][0] * on.load_unit[LENGTH]))
    return forces


def collocation(tolerance: float) -> list[float]:
    """Forces [N] of the curve, from its end of high pressure."""
    half = Half(MUSCLE, length_held=True)
    H0, high = 2.0 * half.half, float(PRESSURES[-1])
    found = half.rest()
    for pressure in (0.3 * high, high):
        found = half.solve(found, H0, pressure, 1e-3)
    for share in (0.25, 0.5, 0.75):
        found = half.solve(found, H0 + share * (LONG - H0), high, 1e-3)
    forces = []
    for pressure in PRESSURES[::-1]:
        found = half.solve(found, LONG, float(pressure), tolerance)
        forces.append(float(found.p[0] * half.force_unit))
    return forces[::-1]


def measure(exact: np.ndarray) -> list[dict[str, Any]]:
    """The whole curve by each."""
    rows = []
    ways: dict[str, Any] = {
        "43 B-splines, scipy trust-constr, exact Hessian": trust_constr,
        "solve_bvp, tolerance 1e-3": lambda: collocation(1e-3),
        "solve_bvp, tolerance 1e-8": lambda: collocation(1e-8),
    }
    for name, way in ways.items():
        cold = once(way)[0]["median_s"]
        times, forces = once(way)
        rows.append(
            {"name": name, "states": len(PATH), "error": error(np.array(forces), exact), "cold_s": cold, **times}
        )
    return rows
