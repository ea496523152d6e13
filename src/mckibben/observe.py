"""What a lab reads off one state, as a differentiable function of the muscle's numbers and the state's unknowns."""

import numpy as np
from jaxtyping import Float

from .discretise.line import Line
from .discretise.mesh import values
from .lazy import Array, jax, jnp
from .model.chamber import chamber_density
from .model.energy import scales
from .model.fibres import fibre_densities
from .model.kinematics import height_rate, radius, volume_rate
from .model.parameters import Number, Parameters
from .recover import NODES, tension
from .solver.problem import LENGTH, VOLUME, Space
from .variables import STEP

OBSERVED: dict[str, tuple[str, str]] = {
    name: STEP[name]
    for name in (
        "length", "contraction", "force", "pressure", "volume", "energy_bending_1", "energy_bending_2", "energy_twist",
        "energy_chamber", "energy",
    )
} | {
    "peak_fibre_tension": ("N", "largest tension of a fibre along its length"),
    "largest_radius": ("m", "largest radius along the length"),
}  # fmt: skip
"""Results of one state: unit and meaning."""

WINDOW = 9
"""Nodes through which a maximum between nodes is sought."""
_OFFSETS = np.arange(WINDOW) - float(WINDOW // 2)
_SERIES = np.linalg.inv(np.vander(_OFFSETS))


def observe(space: Space, p: Parameters, b: Number, w: Float[Array, " w"]) -> dict[str, Float[Array, ""]]:
    """The `OBSERVED` results, in SI units, of a symmetric state w = (u, force, pressure) on a half line."""
    assert isinstance(space.basis, Line)
    basis, law, unit = space.basis, space.law, scales(p, space.law)
    u, F, P = w[:-2], w[-2] * unit[0] / unit[LENGTH], w[-1] * unit[0] / unit[VOLUME]
    mesh = space.mesh(p, b)

    def local(at: Array) -> tuple[Array, Array]:
        """dL/dtheta at one point of the mesh, and what is integrated."""
        theta, psi, kappa = basis.form.state(at[0], at[1:], p)

        def lagrangian(theta: Array) -> tuple[Array, Array]:
            parts = (*fibre_densities(theta, psi, kappa, p), chamber_density(theta, p, law))
            z, V = height_rate(theta, psi, p), volume_rate(theta, psi, p)
            return sum(parts) - F * z - P * V, jnp.stack([*parts, z, V])

        return jax.grad(lagrangian, has_aux=True)(theta)

    slope, densities = jax.vmap(local)(values(mesh, basis.form, u, p))
    bending_1, bending_2, twist, chamber, length, volume = mesh.weights @ densities
    # the costate p' = dL/dtheta is zero at mid-length of a symmetric state
    integral = basis.integral(p, b, slope[None], NODES, jnp.asarray)[0]
    theta, psi, kappa = (field[0] for field in basis.profile(p, b, u[None], NODES, jnp.asarray))
    along = jax.vmap(tension, (0, 0, 0, 0, None, None, None, None))
    pull = along(theta, psi, kappa, integral - integral[NODES // 2], F, P, p, law)
    tallest = jax.vmap(peak)(jnp.stack([pull, radius(theta, p)]))
    return {
        "length": length, "contraction": 1.0 - length / p.H0, "force": F, "pressure": P, "volume": volume,
        "energy_bending_1": bending_1, "energy_bending_2": bending_2, "energy_twist": twist,
        "energy_chamber": chamber, "energy": bending_1 + bending_2 + twist + chamber,
        "peak_fibre_tension": tallest[0], "largest_radius": tallest[1],
    }  # fmt: skip


def peak(field: Float[Array, " n"]) -> Float[Array, ""]:
    """Largest value of a smooth field given at uniform nodes, symmetric about the middle one.

    It is sought on the polynomial through the `WINDOW` nodes about the largest one: the value at the nodes alone would
    have the derivative of the nearest node, which is wrong by as much as the maximum lies beside it.
    """
    half = len(field) // 2 + 1
    largest = jnp.argmax(field[:half])
    first = jnp.clip(largest - WINDOW // 2, 0, len(field) - WINDOW)
    near = jax.lax.dynamic_slice(field, (first,), (WINDOW,))
    series = _SERIES @ near
    slope, bend = jnp.polyder(series), jnp.polyder(series, 2)
    start = jnp.asarray(_OFFSETS)[largest - first]
    low, high = jnp.maximum(start - 1.0, _OFFSETS[0]), start + 1.0
    flat = 1e-9 * jnp.abs(near).max()

    def newton(at: Array) -> Array:
        """One step, held between the neighbours; none where the field is level or has no maximum."""
        curved = jnp.polyval(bend, at)
        step = jnp.where(curved < -flat, jnp.polyval(slope, at) / jnp.where(curved < -flat, curved, 1.0), 0.0)
        return jnp.clip(at - step, low, high)

    at = jax.lax.stop_gradient(start)
    for _ in range(6):
        at = jax.lax.stop_gradient(newton(at))
    return jnp.polyval(series, newton(at))  # the last step carries the derivative of the place
