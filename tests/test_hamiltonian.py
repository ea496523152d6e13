"""States against the same mechanics in Hamiltonian form, solved by SciPy's collocation: only the energy is shared.

Unknown along the half length are theta, psi, the costate p of theta, the moment m = dL/dkappa and the height z (theory
page, what equilibrium gives for free): with L = w - F z' - P pi r^2 z' and a = 1/(R0 tan(theta0)),

    theta' = -a sin(psi),  psi' = kappa(m),  p' = dL/dtheta,  m' = dL/dpsi + p a cos(psi),  z' = s cos(psi);

theta = theta0, z = 0 and psi = 0 (clamped) or m = 0 (pinned) at the fitting, psi = p = 0 at mid-length. With the length
held F is an unknown number. Solved from the cylinder at rest by continuation: pressure first, then length or force.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from cases import CASES, held, muscle
from scipy.integrate import solve_bvp

import mckibben as mk
from mckibben.model.energy import lagrangian, scales
from mckibben.model.kinematics import angle_rate, height_rate
from mckibben.model.parameters import Parameters, parameters
from mckibben.model.point import Point

pytestmark = pytest.mark.reference

TOLERANCE = 1e-6
"""Of the collocation's relative residuals; the force is then good to 1e-9 or better."""
CHUNK = 512
THETA, PSI, COSTATE, MOMENT, HEIGHT = range(5)
STATES = [case for case in CASES["reference"] if case["name"] in ("R01", "R03", "R11", "R13", "R18", "R30")]


def rates(y: jax.Array, load: jax.Array, p: Parameters) -> jax.Array:
    """d(theta, psi, p, m, z)/dv at one point; load = (F, P); SI units."""
    theta, psi, costate, moment, _ = y

    def density(theta: Any, psi: Any, kappa: Any) -> Any:
        return lagrangian(Point(theta, psi, kappa), p, load[0], load[1])

    by_kappa = jax.grad(density, argnums=2)  # linear in kappa, because L is quadratic in it
    still = by_kappa(theta, psi, jnp.zeros(()))
    kappa = (moment - still) / (by_kappa(theta, psi, 1.0 / p.R0) - still) / p.R0
    by_theta, by_psi = jax.grad(density, argnums=(0, 1))(theta, psi, kappa)
    at, a = Point(theta, psi, kappa), 1.0 / (p.R0 * jnp.tan(p.theta0))
    return jnp.stack([
        angle_rate(at, p), kappa, by_theta, by_psi + costate * a * jnp.cos(psi), height_rate(at, p),
    ])  # fmt: skip


@jax.jit
def everywhere(p: Parameters, y: jax.Array, load: jax.Array) -> tuple[jax.Array, ...]:
    """Rates at points (n, 5) and their derivatives by the state and by F."""
    at = partial(rates, p=p)
    by_state, by_load = jax.vmap(jax.jacfwd(at, argnums=(0, 1)), (0, None))(y, load)
    return jax.vmap(at, (0, None))(y, load), by_state, by_load[:, :, :1]


class Half:
    """Half of a muscle as a boundary-value problem in x = 2 v/H0, with numbers of order one."""

    def __init__(self, m: mk.Muscle, length_held: bool) -> None:
        self.p, self.clamped = parameters(m), str(m.ends) == "clamped"
        self.length_held, self.half = length_held, 0.5 * float(self.p.H0)
        energy = float(scales(self.p)[0])
        self.unit, self.force_unit = np.array([1.0, 1.0, energy, energy, self.half]), energy / self.half

    def rest(self) -> Any:
        """The cylinder as made, on points crowded at the fitting."""
        x = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 60)])
        y = np.zeros((5, len(x)))
        y[THETA], y[HEIGHT] = float(self.p.theta0), x
        return Guess(x, y, np.zeros(1) if self.length_held else None)

    def solve(self, guess: Any, axial: float, pressure: float, tol: float) -> Any:
        """From a guess (an earlier solution) to the state with a length [m] or force [N] and a pressure [Pa] held."""

        def load(F: np.ndarray) -> np.ndarray:
            return np.array([F[0] * self.force_unit if self.length_held else axial, pressure])

        def fun(x: np.ndarray, y: np.ndarray, F: Any = ()) -> np.ndarray:
            return self._at(y, load(F))[0]

        def jac(x: np.ndarray, y: np.ndarray, F: Any = ()) -> Any:
            _, by_state, by_force = self._at(y, load(F))
            return (by_state, by_force) if self.length_held else by_state

        def bc(start: np.ndarray, end: np.ndarray, F: Any = ()) -> np.ndarray:
            held = start[PSI] if self.clamped else start[MOMENT]
            miss = [start[THETA] - float(self.p.theta0), held, start[HEIGHT], end[PSI], end[COSTATE]]
            return np.array([*miss, end[HEIGHT] - 0.5 * axial / self.half] if self.length_held else miss)

        found = solve_bvp(fun, bc, guess.x, guess.y, p=guess.p, fun_jac=jac, tol=tol, max_nodes=20_000)
        assert found.success, found.message
        return found

    def _at(self, y: np.ndarray, load: np.ndarray) -> tuple[np.ndarray, ...]:
        """Rates and their derivatives at n points in units of order one; in chunks, so that one shape is compiled."""
        n = y.shape[1]
        full = np.pad(y.T * self.unit, ((0, -n % CHUNK), (0, 0)), mode="edge").reshape(-1, CHUNK, 5)
        parts = zip(*(everywhere(self.p, chunk, load) for chunk in full), strict=True)
        rate, by_state, by_force = (np.concatenate(part)[:n] for part in parts)
        scale = self.half / self.unit
        by_state = by_state * scale[:, None] * self.unit
        by_force = by_force * scale[:, None] * self.force_unit
        return (rate * scale).T, np.moveaxis(by_state, 0, -1), np.moveaxis(by_force, 0, -1)


class Guess(NamedTuple):
    """A start in the form of a solution of `solve_bvp`."""

    x: np.ndarray
    y: np.ndarray
    p: np.ndarray | None


def independent(m: mk.Muscle, axial: str, target: float, pressure: float) -> float:
    """Force [N] with the length held, length [m] with the force held."""
    half = Half(m, axial == "length")
    start = 2.0 * half.half if half.length_held else 0.0
    found = half.rest()
    for P in (0.3 * pressure, pressure):
        found = half.solve(found, start, P, 1e-3)
    for share in np.linspace(0.0, 1.0, 9)[1:]:
        found = half.solve(found, start + share * (target - start), pressure, 1e-3)
    found = half.solve(found, target, pressure, TOLERANCE)
    return float(found.p[0] * half.force_unit if half.length_held else 2.0 * found.y[HEIGHT, -1] * half.half)


@pytest.mark.parametrize("case", STATES, ids=lambda case: f"{case['name']}: {case['about']}")
def test_collocation_of_the_hamiltonian_form_agrees(case):
    m, at = muscle(case), held(case)
    other = independent(m, case["control"], at[case["control"]], at["pressure"])
    state = mk.solve(m, **at, tolerance=1e-10)
    assert (state.force if case["control"] == "length" else state.length) == pytest.approx(other, rel=1e-8)
