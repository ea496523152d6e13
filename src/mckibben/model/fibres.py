"""Elastic energy of the mesh of Kirchhoff rods, per unit v."""

from mckibben.model.angle import sin
from mckibben.model.axial import axial_energy, axial_tension
from mckibben.model.kinematics import fibre_strains, natural_strains
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point, made_angle

__all__ = ["axial_density", "axial_force", "fibre_densities"]


def fibre_densities(at: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Energy of all N fibres per unit v [J/m]: geodesic bending, normal bending, twist (integrand of Eq. 20).

    A fibre is 1/sin(theta0) long per unit v, which gives the factor N/(2 sin(theta0)).
    """
    strains, natural = fibre_strains(at, p), natural_strains(at, p)
    factor = p.N / (2.0 * sin(made_angle(at, p)))
    d1, d2, d3 = (factor * B * (u - u0) ** 2 for B, u, u0 in zip((p.B1, p.B2, p.B3), strains, natural, strict=True))
    if p.stiffening is None:
        return d1, d2, d3
    n, c = p.stiffening.exponent, p.stiffening.curvature
    more1, more2, more3 = (1.0 + 2.0 / n * ((u - u0) / c) ** (n - 2) for u, u0 in zip(strains, natural, strict=True))
    return d1 * more1, d2 * more2, d3 * more3


def axial_force(at: Point, p: Parameters) -> Number:
    """Tension T [N] of a fibre that stretches."""
    return axial_tension(at.stretch - 1.0, p)


def axial_density(at: Point, p: Parameters) -> Number:
    """Energy of the stretch of all N fibres per unit v [J/m]: N EA/(2 sin(theta0)) (lambda - 1)^2, or by their law."""
    if p.axial is not None:
        return p.N / sin(made_angle(at, p)) * axial_energy(at.stretch - 1.0, p)
    return p.N / (2.0 * sin(made_angle(at, p))) * axial_force(at, p) * (at.stretch - 1.0)
