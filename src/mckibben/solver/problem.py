"""One muscle on one discretisation: the functions a solver calls, compiled once per kind of muscle and size."""

from typing import Any

import attrs
import numpy as np
from jaxtyping import Float

from ..discretise.assemble import Assembly, assemble
from ..discretise.bspline import Spline
from ..discretise.line import Line
from ..discretise.mesh import Mesh
from ..kernel import kernel
from ..lazy import Array, jnp
from ..model.energy import quantities, scales
from ..model.parameters import Law, Number, Parameters

LENGTH, VOLUME, CLOSURE = 1, 2, 3
"""Positions in `model.energy.QUANTITIES`, and of their multipliers force, pressure and closing moment in `loads`."""


@attrs.frozen
class Space:
    """The static part of a problem: a discretisation and a chamber law. Hashable; compiled code hangs on it."""

    basis: Line | Spline
    law: Law

    def mesh(self, p: Parameters, b: Number) -> Mesh:
        """Operators on a muscle."""
        return self.basis.mesh(p, b)

    @property
    def half(self) -> bool:
        """Whether it is a half line, for which there are quicker equations (`lockstep`)."""
        return isinstance(self.basis, Line) and self.basis.half

    @property
    def line(self) -> Line:
        """The basis, which must be a line."""
        assert isinstance(self.basis, Line)
        return self.basis

    def density(self, p: Parameters) -> Any:
        """Pointwise quantities of the local fields x = (theta, y), in units of `scales`."""
        unit = scales(p, self.law)
        return lambda x: quantities(*self.basis.form.state(x[0], x[1:], p), p, self.law) / unit

    def assemble(self, p: Parameters, b: Number, u: Any, coefficients: Any) -> Assembly:
        """Totals, gradients and combined tangents at u."""
        return assemble(self.mesh(p, b), self.basis.form, self.density(p), u, p, coefficients)


@kernel
def setting(space: Space, p: Parameters, b: Number) -> tuple[Float[Array, " 4"], Mesh]:
    """Units of the four quantities, and the operators."""
    return scales(p, space.law), space.mesh(p, b)


@kernel
def evaluate(space: Space, p: Parameters, b: Number, u: Float[Array, " m"]) -> Assembly:
    """The four quantities with gradients and one tangent each."""
    return space.assemble(p, b, u, jnp.eye(4))


def bordered(
    space: Space, p: Parameters, b: Number, w: Float[Array, " w"], select: Any, targets: Float[Array, "2"]
) -> tuple[Float[Array, "w w"], Float[Array, " w"], Float[Array, "2"]]:
    """Equilibrium R(w) = 0 on any space: dR/dw, R, and length and volume, all dimensionless.

    w = (u, force, pressure); R is the gradient of the potential energy by u, and what `select` holds minus `targets`.
    """
    row = jnp.stack([jnp.ones_like(w[-2]), -w[-2], -w[-1], jnp.zeros_like(w[-1])])
    a = space.assemble(p, b, w[:-2], row[None])
    G = a.gradients[LENGTH : VOLUME + 1]
    matrix = jnp.block([[a.tangents[0], -G.T], [select[:, :2] @ G, select[:, 2:]]])
    values = a.totals[LENGTH : VOLUME + 1]
    miss = select @ jnp.concatenate([values, w[-2:]]) - targets
    return matrix, jnp.concatenate([row @ a.gradients, miss]), values


@attrs.frozen
class Problem:
    """A space on one muscle: numbers, point placement, units and operators."""

    space: Space
    p: Parameters
    b: float  #: how strongly points are crowded into the end layers
    unit: np.ndarray  #: of energy, length, volume, closure
    mesh: Any  #: `Mesh` of NumPy arrays

    @classmethod
    def of(cls, space: Space, p: Parameters, b: float) -> "Problem":
        """Set up operators and units."""
        unit, mesh = setting(space, p, b)
        arrays: Any = (np.asarray(part) for part in mesh)
        return cls(space, p, b, np.asarray(unit), Mesh(*arrays))

    @property
    def load_unit(self) -> np.ndarray:
        """Units of the multipliers: 1, force [N], pressure [Pa], closing moment [J]."""
        return np.asarray(self.unit[0] / self.unit)

    def evaluate(self, u: np.ndarray) -> Assembly:
        """The four dimensionless quantities and their derivatives."""
        return evaluate(self.space, self.p, self.b, u)

    def metric(self) -> np.ndarray:
        """Norm of a step: mean(dpsi^2) + (0.05 H0)^2 mean(dkappa^2), so that short waves count.

        The part of theta that is itself unknown (free ends, splines) counts by its mean square.
        """
        weight, H0 = self.mesh.weights / self.mesh.weights.sum(), float(self.p.H0)
        slope, bend = self.slopes
        angle = self.mesh.angle
        norm = slope.T * weight @ slope + (0.05 * H0) ** 2 * bend.T * weight @ bend + angle.T * weight @ angle
        return np.asarray(norm)

    @property
    def slopes(self) -> tuple[np.ndarray, np.ndarray]:
        """Change of (psi, kappa) at the points by each unknown, about the cylinder."""
        factor = float(self.space.basis.slope_factor(self.p))
        return factor * self.mesh.fields[:, 0], factor * self.mesh.fields[:, 1]
