"""THE equation: stored energy and load terms per unit v (Eqs. 20-28).

    Pi = integral w dv - F (h - H0) - P (V - V0),   w = w_fibres + w_chamber

Everything else (forces, tangents, stability, sensitivities) is derived from `quantities` by differentiation.
"""

from ..lazy import Array, jax, jnp
from .chamber import chamber_density
from .fibres import fibre_densities
from .kinematics import angle_rate, height_rate, volume_rate
from .parameters import Law, Number, Parameters

QUANTITIES = ("energy", "length", "volume", "closure")
"""What `quantities` integrates to: stored energy, length h, volume V, and theta(H0) - theta(0)."""


def stored(theta: Number, psi: Number, kappa: Number, p: Parameters, law: Law) -> Number:
    """Stored energy per unit v [J/m]: fibres (Eq. 20) and chamber (Eq. 26)."""
    return sum(fibre_densities(theta, psi, kappa, p)) + chamber_density(theta, p, law)


def quantities(theta: Number, psi: Number, kappa: Number, p: Parameters, law: Law) -> Array:
    """Densities per unit v of the four `QUANTITIES`."""
    return jnp.stack([
        stored(theta, psi, kappa, p, law),
        height_rate(theta, psi, p),
        volume_rate(theta, psi, p),
        angle_rate(psi, p),
    ])  # fmt: skip


def scales(p: Parameters, law: Law) -> Array:
    """Units that make the quantities of order one: a characteristic energy [J], H0 [m], V0 [m^3] and 1 rad."""
    modulus = jax.grad(jax.grad(lambda t: chamber_density(p.theta0 + t, p, law)))(0.0)
    energy = p.H0 * (p.N * (p.B1 + p.B2 + p.B3) / p.R0**2 + jnp.abs(modulus))
    return jax.lax.stop_gradient(jnp.stack([energy, p.H0, jnp.pi * p.R0**2 * p.H0, jnp.ones_like(p.H0)]))
