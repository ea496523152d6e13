"""How the paper's formulation is often solved: scipy's SLSQP on 43 B-splines, derivatives by finite differences.

Written out in plain NumPy, in mm, N and MPa, without the package's mechanics. A few states only: it is slow.
"""

from typing import Any

import numpy as np
from curve import LONG, MUSCLE, PRESSURES
from numpy.polynomial import legendre
from scipy.interpolate import BSpline
from scipy.optimize import minimize
from timing import once

STATES = (0, 10, 20)
"""Which of the curve's states."""
ELEMENTS = 40

Floats = np.ndarray[Any, np.dtype[np.float64]]


class Paper:
    """theta as 43 clamped cubic B-splines on 40 elements with 3 Gauss points each (Sec. II.F of the paper)."""

    def __init__(self) -> None:
        braid, chamber = MUSCLE.braid, MUSCLE.chamber
        assert chamber is not None
        self.R0, self.H0, self.t0, self.N = 1e3 * braid.radius, 1e3 * braid.length, braid.angle, braid.fibres
        self.B = [1e6 * stiffness for stiffness in braid.fibre.stiffnesses]
        self.A0 = np.pi * 1e3 * chamber.thickness * (1e3 * chamber.thickness + 2.0 * self.R0)
        self.c1, self.c2 = 1e-6 * chamber.law.c1, 1e-6 * chamber.law.c2
        xi, w = legendre.leggauss(3)
        x = ((np.arange(ELEMENTS)[:, None] + (xi + 1.0) / 2.0) / ELEMENTS).ravel()
        self.w = np.tile(w / 2.0, ELEMENTS) * self.H0 / ELEMENTS
        knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, ELEMENTS + 1), np.ones(3)])
        splines = BSpline(knots, np.eye(ELEMENTS + 3), 3)
        self.basis = [splines(x, nu=k)[:, 2:-2] / self.H0**k for k in range(3)]  # clamped: two are held at each end

    def fields(self, u: Floats) -> tuple[Floats, ...]:
        """theta, theta', theta'', z' at the Gauss points."""
        theta, slope, bend = self.basis[0] @ u + self.t0, self.basis[1] @ u, self.basis[2] @ u
        root = np.sqrt(np.maximum(1.0 - (self.R0 * np.tan(self.t0) * slope) ** 2, 1e-12))  # Eq. (12)
        return theta, slope, bend, root

    def length(self, u: Floats) -> float:
        """h [mm]."""
        theta, _, _, root = self.fields(u)
        return float(self.w @ (np.sin(theta) / np.sin(self.t0) * root))

    def energy(self, u: Floats, pressure: float) -> float:
        """Pi [mJ] without the force's part, Eqs. (20-28)."""
        theta, slope, bend, root = self.fields(u)
        R0, s0, c0 = self.R0, np.sin(self.t0), np.cos(self.t0)
        kappa = -R0 * np.tan(self.t0) * bend / root
        hoop, axial = np.cos(theta) / c0, np.sin(theta) / s0
        u1 = 2.0 * s0 * slope
        u2 = -c0 / R0 * np.cos(theta) * root + s0 * np.sin(theta) * kappa + c0**2 / R0
        u3 = c0 / R0 * np.sin(theta) * root + s0 * np.cos(theta) * kappa - c0 * s0 / R0
        fibres = self.N / (2.0 * s0) * (self.B[0] * u1**2 + self.B[1] * u2**2 + self.B[2] * u3**2)
        squares = hoop**2, axial**2, (hoop * axial) ** -2.0
        wall = self.c1 * (sum(squares) - 3.0) + self.c2 * (sum(1.0 / x for x in squares) - 3.0)
        volume = np.pi * (R0 * hoop) ** 2 * axial * root
        return float(self.w @ (fibres + self.A0 * wall - pressure * volume))

    def solve(self, u: Floats, pressure: float) -> tuple[Floats, float, int]:
        """Unknowns, force [N] and energy evaluations; the force is the multiplier of the length."""
        held = {"type": "eq", "fun": lambda u: self.length(u) - 1e3 * LONG}
        found = minimize(
            self.energy, u, (pressure,), "SLSQP", constraints=[held], options={"maxiter": 1000, "ftol": 1e-10}
        )
        assert found.success, found.message
        by_energy = slopes(lambda u: self.energy(u, pressure), found.x)
        by_length = slopes(self.length, found.x)
        return found.x, float(by_energy @ by_length / (by_length @ by_length)), int(found.nfev)


def slopes(function: Any, u: Floats, step: float = 1e-6) -> Floats:
    """Central differences."""
    return np.array([(function(u + d) - function(u - d)) / (2.0 * step) for d in step * np.eye(len(u))])


def measure(exact: Floats) -> list[dict[str, Any]]:
    """The first, the middle and the last state of the curve, each from the one before."""
    paper = Paper()

    def path() -> tuple[list[float], int]:
        u, forces, count = np.zeros(ELEMENTS - 1), [], 0
        for k in STATES:
            u, force, calls = paper.solve(u, 1e-6 * PRESSURES[k])
            forces.append(force)
            count += calls
        return forces, count

    times, (forces, count) = once(path)
    off = float(np.abs(np.array(forces) - exact[list(STATES)]).max() / np.abs(exact).max())
    name = "43 B-splines, scipy SLSQP, finite differences"
    return [{"name": name, "states": len(STATES), "error": off, "energy_evaluations": count, **times}]
