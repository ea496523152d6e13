"""One muscle on one discretisation, and what the robust search asks of it."""

from functools import partial
from typing import Any, NamedTuple

import attrs
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.bspline import Spline
from mckibben.discretise.fields import Placed, place, variables
from mckibben.discretise.spectral import Line
from mckibben.model.angle import radians
from mckibben.model.energy import QUANTITIES, stored, works
from mckibben.model.gap import inflated, leaves
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.system import Unknowns, assemble, localise

__all__ = [
    "CLOSURE",
    "LENGTH",
    "VOLUME",
    "Balance",
    "Basis",
    "Problem",
    "balance",
    "curvature",
    "setting",
    "slopes",
]

Basis = Line | Spline

LENGTH, VOLUME, CLOSURE = (QUANTITIES.index(name) for name in ("length", "volume", "closure"))


class Balance(NamedTuple):
    """The four quantities at unknowns u, dimensionless, with their gradients."""

    theta: Float[Array, " q"]  #: braid angle at the points [rad]
    totals: Float[Array, "4"]
    gradients: Float[Array, "4 m"]


@kernel
def balance(basis: Basis, p: Parameters, b: Number, u: Float[Array, " m"], pressure: Any = None) -> Balance:
    """By plain differentiation of the totals, as quick when compiled with the least optimisation.

    `pressure`, dimensionless, is that at which a chamber that may leave the braid is.
    """
    on = place(basis, p, b)
    weights = jnp.asarray(basis.operators().weights) * on.jacobian

    def totals(u: Array) -> tuple[Array, tuple[Array, Array]]:
        at = basis.form.point(variables(basis, on, u), on.p, on.made)
        if pressure is not None:
            at = jax.vmap(lambda at: inflated(at, pressure * on.unit[0] / on.unit[2], on.p))(at)
        densities = jax.vmap(lambda at: jnp.stack([stored(at, on.p), *works(at, on.p)]))(at)
        found = weights @ densities / on.unit
        return found, (radians(at.theta), found)

    gradients, (theta, found) = jax.jacrev(totals, has_aux=True)(u)
    return Balance(theta, found, gradients)


@partial(kernel, often=True)
def curvature(
    basis: Basis, p: Parameters, b: Number, u: Float[Array, " m"], shares: Float[Array, "4"]
) -> Float[Array, "m m"]:  # fmt: skip
    """Second derivatives of shares of the four quantities together: of the Lagrangian these are 1, -F, -P and -M."""
    on = place(basis, p, b)
    return assemble(basis, on, localise(basis, on, Unknowns(u, -shares[1:]), shares[0]), 3).stiffness


class Setting(NamedTuple):
    """What does not change while a muscle is on a discretisation."""

    unit: Float[Array, "4"]  #: of energy [J], length [m], volume [m^3], closure [rad]
    v: Float[Array, " q"]  #: material coordinate of the points [m]
    metric: Float[Array, "m m"]  #: norm of a step
    slopes: Float[Array, "q m"]  #: change of psi at the points by each unknown, about the cylinder


@kernel
def setting(basis: Basis, p: Parameters, b: Number) -> Setting:
    """Units, points and norms.

    The norm of a step is mean(dpsi^2) + (0.05 H0)^2 mean(dkappa^2), so that short waves count, and likewise for further
    fields. The part of theta that is itself unknown (free ends, splines) counts by its mean square.
    """
    on, operators = place(basis, p, b), basis.operators()
    weight = operators.weights * on.jacobian / (operators.weights @ on.jacobian)
    slope, bend = slopes(basis, on), slopes(basis, on, 1)
    lift = jnp.asarray(operators.lifts[0])
    norm = (slope.T * weight) @ slope + (0.05 * p.H0) ** 2 * ((bend.T * weight) @ bend) + (lift.T * weight) @ lift
    for order, field in zip(basis.form.orders[2:], operators.fields[2:], strict=True):
        part = jnp.asarray(field) / on.jacobian[:, None] ** order
        norm = norm + (0.05 * p.H0) ** (2 * order) * ((part.T * weight) @ part)
    for other in operators.lifts[1:]:
        norm = norm + (other.T * weight) @ other
    return Setting(on.unit, jnp.asarray(basis.coordinate(operators.x, p, b)), norm, slope)


def slopes(basis: Basis, on: Placed, field: int = 0) -> Float[Array, "q m"]:
    """Change of psi (or of its derivative, `field` 1) at the points by each unknown, about the cylinder."""
    scale = on.jacobian[:, None] ** basis.form.orders[field]
    return basis.slope_factor(on.p) * (jnp.asarray(basis.operators().fields[field]) / scale)


@attrs.frozen
class Problem:
    """A discretisation on one muscle: its numbers, the placement of points, units and norms."""

    basis: Basis
    p: Parameters
    b: float  #: how strongly points are crowded into the end layers
    setting: Any  #: `Setting` of NumPy arrays

    @classmethod
    def of(cls, basis: Basis, p: Parameters, b: float) -> "Problem":
        """Set up units and norms."""
        return cls(basis, p, b, Setting(*map(np.asarray, setting(basis, p, b))))

    @property
    def unit(self) -> np.ndarray:
        """Of energy [J], length [m], volume [m^3] and closure [rad]."""
        return np.asarray(self.setting.unit)

    @property
    def load_unit(self) -> np.ndarray:
        """Units of the multipliers: 1, force [N], pressure [Pa], closing moment [J]."""
        return self.unit[0] / self.unit

    @property
    def loads(self) -> int:
        """How many loads are unknowns: force, pressure and, where equal end radii are a condition, closing moment."""
        return 3 if self.basis.closes else 2

    @property
    def leaves(self) -> bool:
        """Whether the chamber may leave the braid, so that energy and volume depend on the pressure as well."""
        return leaves(self.p)

    def balance(self, u: np.ndarray, pressure: float = 0.0) -> Balance:
        """The four dimensionless quantities and their gradients, at a dimensionless pressure where that matters."""
        at = (np.asarray(pressure),) if self.leaves else ()
        return Balance(*map(np.asarray, balance(self.basis, self.p, self.b, u, *at)))

    def curvature(self, u: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """Second derivatives by the unknowns of the four quantities, added up in shares."""
        return np.asarray(curvature(self.basis, self.p, self.b, u, shares))

    def moved(self, du: np.ndarray) -> float:
        """Largest change of psi [rad] at the points by a change of the unknowns."""
        return float(np.abs(self.setting.slopes @ du).max())
