"""The chamber's wall: its energy per unit v from the stretches of the mesh it rides on, and what derives from that.

The face that rides on the mesh has the radius and the meridian of the mesh. A thin wall has its stretches throughout;
a thick one those of an incompressible tube of this radius and axial stretch; bellows store energy by the axial one
alone (theory page).
"""

import jax
import jax.numpy as jnp
import numpy as np

from mckibben.model.angle import cos
from mckibben.model.chamber import energy_density
from mckibben.model.kinematics import radius, stretches
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.spec.bellows import Bellows

__all__ = [
    "chamber_density",
    "chamber_pull",
    "chamber_stretches",
    "contact_pressure",
    "lying",
    "mean_density",
    "touching_pressure",
]

GAUSS = 6
"""Points through a thick wall: errors below 1e-11 of the energy for a bore of half the outer diameter, 1e-7 for a
quarter."""


def mean_density(hoop: Number, axial: Number, p: Parameters) -> Number:
    """Energy per volume of rubber [Pa], averaged through the wall, where the mesh has these stretches; of bellows
    per unit v [J/m]."""
    hoop, axial = _mounted(hoop, axial, p)
    if isinstance(p.law, Bellows):
        as_made = 1.0 if p.tube is None else 1.0 / p.tube.axial  # length of bellows per unit v
        return 0.5 * as_made * p.law.axial_stiffness * (axial - 1.0) ** 2
    if p.tube is None or p.tube.across is None:
        return energy_density(hoop, axial, 1.0 / (hoop * axial), p.law)
    width = jnp.log1p(p.tube.across - 1.0)
    points, weights = np.polynomial.legendre.leggauss(GAUSS)

    def at(point: Number) -> Number:  # in the logarithm of the radius as made, in which no pole is near
        square = jnp.exp(0.5 * width * (1.0 + point))
        around = jnp.sqrt((hoop**2 + (square - 1.0) / axial) / square)
        return square * energy_density(around, axial, 1.0 / (around * axial), p.law)

    mean = width / (p.tube.across - 1.0) * (jax.vmap(at)(points) @ (0.5 * weights))
    bore = hoop**2 + (p.tube.across - 1.0) / axial  # the other face's radius squared: none, no tube
    return jnp.where(bore > 0.0, 1.0, jnp.nan) * mean


def _rubber(p: Parameters) -> Number:
    """What an energy per volume is of: rubber per unit v [m^2]; that of bellows is per unit v as it is."""
    return jnp.ones_like(p.A0) if isinstance(p.law, Bellows) else p.A0


def _mounted(hoop: Number, axial: Number, p: Parameters) -> tuple[Number, Number]:
    """Stretches of the rubber at the face that rides on the mesh, from those of the mesh."""
    return (hoop, axial) if p.tube is None else (hoop * p.tube.hoop, axial * p.tube.axial)


def lying(at: Point, p: Parameters) -> Parameters:
    """A muscle's numbers with the chamber that lies beside a point: where it has slid there, 1 + slide' times as much
    rubber per unit v, which is stretched less by as much; NaN where it would be turned inside out."""
    if at.slide_rate is None:
        return p
    assert p.tube is not None
    share = jnp.where(at.slide_rate > -1.0, 1.0 + at.slide_rate, jnp.nan)
    return p._replace(A0=p.A0 * share, tube=p.tube._replace(axial=p.tube.axial / share))


def _beside(at: Point, p: Parameters) -> tuple[Number, Number]:
    """Hoop and axial stretch of the chamber in those of the mesh: the mesh's own, or less where it has left it."""
    hoop, axial, _ = stretches(at, p)
    return (hoop if at.blown is None else at.blown), axial


def chamber_stretches(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Principal stretches of the rubber at the face that rides on the mesh: hoop, axial, thickness.

    Those of bellows are of the surface that their folds lie in; the wall itself keeps its thickness.
    """
    p = lying(at, p)
    hoop, axial, thickness = stretches(at, p)
    if p.tube is not None:
        hoop, axial = _mounted(*_beside(at, p), p)
        thickness = 1.0 / (hoop * axial)
    return hoop, axial, jnp.ones_like(thickness) if isinstance(p.law, Bellows) else thickness


def chamber_density(at: Point, p: Parameters) -> Number:
    """Energy of the chamber per unit v [J/m]: A0 psi(C) (Eq. 26)."""
    p = lying(at, p)
    hoop, axial = _beside(at, p)
    return _rubber(p) * mean_density(hoop, axial, p)


def chamber_pull(at: Point, p: Parameters) -> Number:
    """Meridian force of the chamber [N]: A0 d(psi)/d(lambda2) at fixed hoop stretch of the mesh."""
    p = lying(at, p)
    hoop, axial = _beside(at, p)
    return _rubber(p) * jax.grad(lambda a: mean_density(hoop, a, p))(axial)


def contact_pressure(at: Point, P: Number, p: Parameters) -> Number:
    """Pressure [Pa] of the chamber on the mesh: P less what the chamber itself bears; below 0 it would not touch.

    P - [cos(psi) dw/dr - kappa dw/ds] / (2 pi r s), normal equilibrium of the chamber as a surface (theory page).
    """
    p = lying(at, p)
    hoop, axial, _ = stretches(at, p)
    by_hoop, by_axial = jax.grad(lambda h, a: mean_density(h, a, p), argnums=(0, 1))(hoop, axial)
    borne = by_hoop * cos(at.psi) / p.R0 - by_axial * at.kappa
    return P - _rubber(p) * borne / (2.0 * jnp.pi * radius(at, p) * axial)


def touching_pressure(p: Parameters) -> Number:
    """Gauge pressure [Pa] that blows the tube alone up to the braid's radius as made, at the length as mounted."""
    return -contact_pressure(Point.cylinder(p.theta0), 0.0, p)
