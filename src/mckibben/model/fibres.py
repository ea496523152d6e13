"""Elastic energy of the mesh of Kirchhoff rods, per unit v."""

from mckibben.model.angle import sin
from mckibben.model.kinematics import fibre_strains, natural_strains
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point

__all__ = ["fibre_densities"]


def fibre_densities(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Energy of all N fibres per unit v [J/m]: geodesic bending, normal bending, twist (integrand of Eq. 20).

    A fibre is 1/sin(theta0) long per unit v, which gives the factor N/(2 sin(theta0)).
    """
    strains, natural = fibre_strains(at, p), natural_strains(p)
    factor = p.N / (2.0 * sin(p.theta0))
    d1, d2, d3 = (factor * B * (u - u0) ** 2 for B, u, u0 in zip((p.B1, p.B2, p.B3), strains, natural, strict=True))
    return d1, d2, d3
