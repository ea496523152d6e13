"""Many states at once: a last Newton step, what they are worth, and the numbers that a sweep keeps.

Made to be mapped over muscles, like `solver.march`; the formulas are those of `recover` and `stability`.
"""

from functools import partial
from typing import Any, NamedTuple

import attrs
import numpy as np
from jaxtyping import Bool, Float, Int

from .discretise.line import Line, stretch
from .kernel import jitted
from .lazy import Array, jax, jnp
from .model.angle import Known, slope
from .model.chamber import chamber_density
from .model.fibres import fibre_densities
from .model.kinematics import angle_rate, height_rate, radius, volume_rate
from .model.parameters import Law, Number
from .recover import NODES, conserved, tension
from .solver.lockstep import (
    LOADS,
    Constants,
    Design,
    Local,
    Sample,
    assemble,
    constants,
    correct,
    localise,
    residual,
    sample,
    system,
)
from .solver.lockstep import stiffness as tangent

HALF = NODES // 2 + 1
"""Output points of one half, the end and the middle included."""


class Appraised(NamedTuple):
    """One state, in SI units."""

    w: Float[Array, " w"]  #: unknowns after the last step
    fields: dict[str, Array]  #: what `_fields` reads off it
    residual: Array
    change: Array  #: largest change of psi [rad] by the last step
    held: Bool[Array, ""]  #: stable under what is held
    loads: Bool[Array, ""]  #: stable with the force held instead of the length
    antisymmetric: Bool[Array, ""]  #: stable against antisymmetric disturbances


def appraise(line: Line, law: Law, d: Design, b: Number, w: Array, select: Array, target: Array) -> Appraised:
    """A state near equilibrium, after one more Newton step."""
    on, even = constants(line), constants(attrs.evolve(line, modes="even"))
    local = localise(line, law, d, w[-LOADS:], sample(line, d, w))
    equations = assemble(on, d, local)
    c = correct(equations, w, select, target)
    loads = _positive(equations.stiffness, select[:, 1:2] * equations.gradients[1])
    antisymmetric = _positive(tangent(even, d, local), _closing(on, even, line, local)[None])
    w = w + c.step
    left = residual(system(line, law, d, w, sample(line, d, w)), w)
    change = jnp.abs(on.shape @ c.step[:-LOADS]).max()
    return Appraised(w, _fields(line, law, d, b, w), left, change, c.stable, loads, antisymmetric)


def _positive(K: Array, held: Array) -> Array:
    """Whether K is positive definite on what the rows `held` leave free."""
    size = jnp.trace(jnp.abs(K)) / jnp.maximum(jnp.sum(held**2), 1e-30)
    return jnp.isfinite(jnp.linalg.cholesky(K + size * held.T @ held)).all()


def _closing(on: Constants, even: Constants, line: Line, local: Local) -> Array:
    """Antisymmetric theta is zero at mid-length: what that asks of antisymmetric modes (as in `stability`)."""
    closing = (0.5 * on.weights * local.turn) @ even.shape
    return closing.at[-1].add(1.0) if line.ends == "free" else closing


def _fields(line: Line, law: Law, d: Design, b: Number, w: Array) -> dict[str, Array]:
    """Totals and extremes of the state w; see `recover` for the formulas."""
    on, at, p, J = constants(line), line.sampling(NODES), d.p, d.jacobian
    u, F, P = w[: line.size], w[-2] * d.unit[0] / d.unit[1], w[-1] * d.unit[0] / d.unit[2]
    inner = sample(line, d, w)
    psi = at.shape[:HALF] @ u
    shift = w[line.size] if line.ends == "free" else 0.0
    theta = p.theta0.value + shift + at.odd_integral[:HALF] @ (J * angle_rate(inner.psi, p))
    outer = Sample(Known.of(theta), Known.of(psi), (at.slope[:HALF] @ u) / stretch(at.x[:HALF], p, b))

    def local(at: Sample) -> tuple[Array, Array]:
        def densities(theta: Known) -> Array:
            parts = (*fibre_densities(theta, at.psi, at.kappa, p), chamber_density(theta, p, law))
            return jnp.stack([*parts, height_rate(theta, at.psi, p), volume_rate(theta, at.psi, p)])

        signs = jnp.stack([one, one, one, one, -F, -P])
        return slope(lambda theta: signs @ densities(theta), at.theta), densities(at.theta)

    one = jnp.ones_like(F)
    pull, densities = jax.vmap(local)(inner)
    totals = (on.weights * J) @ densities
    swept = J * pull
    whole = at.even_integral[HALF - 1] @ swept  # the costate p' = dL/dtheta is zero at mid-length
    costate = jnp.concatenate([on.cumulate @ swept, at.even_integral[:HALF] @ swept]) - whole
    q = len(J)
    everywhere = jax.tree.map(lambda *parts: jnp.concatenate(parts), inner, outer)
    kept, size = jax.vmap(lambda at, costate: conserved(at.theta, at.psi, at.kappa, costate, F, P, p, law))(
        everywhere, costate
    )
    loads = jax.vmap(lambda at, costate: tension(at.theta, at.psi, at.kappa, costate, F, P, p, law))(outer, costate[q:])
    copies = np.concatenate([np.ones(q), np.full(HALF - 1, 2.0), [1.0]])
    mean = copies @ kept / copies.sum()
    weight = jnp.concatenate([on.weights * J / (on.weights @ J), jnp.zeros(HALF)]).at[q].set(1.0 / q)
    variation = jnp.sqrt((kept - mean) ** 2 @ weight / weight.sum()) / jnp.maximum(size.max(), 1e-300)
    coefficients = jnp.abs(u)
    tail = coefficients[-2:].max() / jnp.maximum(coefficients.max(), 1e-12)
    return {
        "force": F, "pressure": P, "energies": totals[:4], "length": totals[4], "volume": totals[5],
        "conserved_variation": variation, "coefficient_tail": tail, "peak_fibre_tension": loads.max(),
        "largest_radius": radius(outer.theta, p).max(), "largest_slope": jnp.abs(psi).max(),
    }  # fmt: skip


@partial(jitted, static_argnums=(0, 1))
def appraised(
    line: Line,
    law: Law,
    designs: Design,
    b: Float[Array, " batch"],
    w: Float[Array, "batch n w"],
    select: Float[Array, "2 4"],
    targets: Float[Array, "batch n 2"],
    count: Int[Array, ""],
) -> Appraised:
    """The first `count` states of every muscle; leaves have leading dimensions (n, batch) and are zero beyond."""

    def at(k: Any) -> Appraised:
        one = partial(appraise, line, law, select=select)
        return jax.vmap(lambda d, b, w, target: one(d, b, w, target=target))(designs, b, w[:, k], targets[:, k])

    blank = jax.tree.map(lambda s: jnp.zeros((w.shape[1], *s.shape), s.dtype), jax.eval_shape(at, 0))
    return jax.lax.fori_loop(
        0, count, lambda k, rows: jax.tree.map(lambda row, one: row.at[k].set(one), rows, at(k)), blank
    )
