"""Everything read off a state, once: totals, fields along the length, tension, extremes, and how far to trust it.

One differentiable function of the muscle's numbers and the state's unknowns. Results, curves, sweeps, derivatives and
verdicts all use it, mapped and compiled; a compiler leaves out what is not asked for. A symmetric state is read on half
its length and mirrored.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.discretise.fields import Placed, place, points_at, variables
from mckibben.discretise.fields import known as with_sines
from mckibben.measure.peak import peak
from mckibben.model.angle import cos, radians, slope
from mckibben.model.energy import lagrangian
from mckibben.model.fibres import fibre_densities
from mckibben.model.kinematics import fibre_strains, height_rate, radius, volume_rate
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.tension import conserved, tension
from mckibben.model.wall import chamber_density, chamber_pull, chamber_stretches, contact_pressure
from mckibben.solver.newton import batch_size, positive
from mckibben.solver.problem import Basis
from mckibben.solver.stability import stiffnesses
from mckibben.solver.system import Local, System, Unknowns, assemble, localise, residual

__all__ = ["ENERGIES", "NODES", "Reading", "Stable", "read", "read_many", "stable"]

ENERGIES = ("bending_1", "bending_2", "twist", "chamber")
"""The parts of the stored energy, in the order in which they are kept."""
NODES = 129
"""Output points along the length, crowded at the fittings like the mesh, where the fields vary most."""


class Reading(NamedTuple):
    """One state in SI units; fields at the output points, those of a symmetric state on its first half."""

    numbers: dict[str, Float[Array, ""]]  #: by the names of a result's variables
    fields: dict[str, Float[Array, " n"]]
    largest_slope: Float[Array, ""]  #: of the meridian, |psi| [rad]
    conserved_variation: Float[Array, ""]
    coefficient_tail: Float[Array, ""]


def nodes(basis: Basis) -> int:
    """Output points that are computed."""
    return NODES // 2 + 1 if basis.half else NODES


def read(basis: Basis, on: Placed, state: Unknowns) -> Reading:
    """Everything of one state."""
    p, sampling, operators = on.p, basis.sampling(nodes(basis)), basis.operators()
    F, P = state.loads[0] * on.unit[0] / on.unit[1], state.loads[1] * on.unit[0] / on.unit[2]
    M = state.loads[2] * on.unit[0] if basis.closes else 0.0
    inner = _points(basis, on, state.u)
    outer = points_at(basis, on, state.u, sampling)

    def local(at: Point) -> tuple[Array, tuple[Array, ...], Array, Array]:
        pull = slope(lambda theta: lagrangian(at._replace(theta=theta), p, F, P), at.theta)
        return pull, (*fibre_densities(at, p), chamber_density(at, p)), height_rate(at, p), volume_rate(at, p)

    pull, densities, rate, swept = jax.vmap(local)(inner)
    weights = jnp.asarray(operators.weights) * on.jacobian
    parts = [jnp.sum(weights * density) for density in densities]
    length, volume = jnp.sum(weights * rate), jnp.sum(weights * swept)
    inner_costate, costate = _costates(basis, on, pull, M, sampling)
    found = jax.vmap(lambda at, c: _fields(at, c, F, P, p))(outer, costate)
    found["z"] = sampling.integral @ (on.jacobian * rate)
    ends = np.array([0] if basis.half else [0, -1])
    checked = jax.tree.map(lambda one, other: jnp.concatenate([one, other[ends]]), inner, outer)
    variation = _variation(on, checked, jnp.concatenate([inner_costate, costate[ends]]), F, P, weights)
    inner_tension = jax.vmap(lambda at, c: tension(at, c, F, P, p))(inner, inner_costate)
    inner_radius = jax.vmap(lambda at: radius(at, p))(inner)
    tallest = jax.vmap(lambda field: peak(field, basis.harmonics()))(jnp.stack([inner_tension, inner_radius]))
    numbers = {
        "length": length, "contraction": 1.0 - length / p.H0, "force": F, "pressure": P, "volume": volume,
        **{f"energy_{name}": part for name, part in zip(ENERGIES, parts, strict=True)}, "energy": sum(parts),
        "peak_fibre_tension": tallest[0], "largest_radius": tallest[1],
        "air_volume": volume if p.tube is None else volume - p.tube.rubber,
    }  # fmt: skip
    return Reading(numbers, found, jnp.abs(found["psi"]).max(), variation, basis.tail(state.u))


def _points(basis: Basis, on: Placed, u: Array) -> Point:
    """The state at the quadrature points."""
    return basis.form.point(with_sines(basis.form, variables(basis, on, u)), on.p)


def _costates(basis: Basis, on: Placed, pull: Array, M: Number, sampling: Any) -> tuple[Array, Array]:
    """The costate p' = dL/dtheta at the quadrature points and at the output points.

    It is zero at mid-length of a symmetric state; where equal radii are a condition it is its multiplier at v = H0.
    """
    swept = on.jacobian * pull
    middle = NODES // 2
    inner = jnp.asarray(basis.inner_integral()) @ swept
    outer = jnp.asarray(sampling.integral) @ swept
    end = outer[-1] - M if basis.closes else outer[middle]
    return inner - end, outer - end


def _fields(at: Point, costate: Number, F: Number, P: Number, p: Parameters) -> dict[str, Number]:
    bending1, bending2, twist = fibre_densities(at, p)
    hoop, axial, thickness = chamber_stretches(at, p)
    u1, u2, u3 = fibre_strains(at, p)
    chamber_axial = chamber_pull(at, p) * cos(at.psi)
    total_axial = F + jnp.pi * radius(at, p) ** 2 * P
    return {
        "theta": radians(at.theta), "psi": radians(at.psi), "r": radius(at, p),
        "stretch_hoop": hoop, "stretch_axial": axial, "stretch_thickness": thickness,
        "u1": u1, "u2": u2, "u3": u3,
        "density_bending_1": bending1, "density_bending_2": bending2, "density_twist": twist,
        "density_fibres": bending1 + bending2 + twist, "density_chamber": chamber_density(at, p),
        "fibre_tension": tension(at, costate, F, P, p),
        "share_chamber": chamber_axial / total_axial, "share_mesh": 1.0 - chamber_axial / total_axial,
        "contact_pressure": contact_pressure(at, P, p),
    }  # fmt: skip


def _variation(on: Placed, at: Point, costate: Array, F: Number, P: Number, weights: Array) -> Float[Array, ""]:
    """Relative variation of the conserved quantity over the quadrature points and the fittings after them.

    The fittings count together like one point of the mesh.
    """
    kept, size = jax.vmap(lambda at, c: conserved(at, c, F, P, on.p))(at, costate)
    q, ends = len(weights), len(kept) - len(weights)
    weight = jnp.concatenate([weights / weights.sum(), jnp.full(ends, 1.0 / (q * ends))])
    weight = weight / weight.sum()
    return jnp.sqrt(weight @ (kept - weight @ kept) ** 2) / jnp.maximum(size.max(), 1e-300)


class Stable(NamedTuple):
    """What a state is stable under; True may be trusted, False asks for a count of its modes."""

    length: Bool[Array, ""]
    force: Bool[Array, ""]
    antisymmetric: Bool[Array, ""]


def stable(basis: Basis, on: Placed, local: Local, s: System, volume: Array, together: bool = False) -> Stable:
    """Stability of a state under length and force control, with the pressure held, or the `volume`."""
    t = stiffnesses(basis, on, local, s, together)
    always = [jnp.where(volume, t.gradients[1], 0.0), *t.gradients[2:]]
    force = positive(t.stiffness, jnp.stack(always))
    length = positive(t.stiffness, jnp.stack([t.gradients[0], *always]))
    sideways = positive(t.antisymmetric, t.closure[None]) if basis.half else jnp.array(True)
    return Stable(length, force, sideways)


AT_ONCE = 8
"""States that are read in step."""


@kernel
def read_many(
    basis: Basis, p: Parameters, b: Number, states: Unknowns, volume: Bool[Array, ""], count: Int[Array, ""]
) -> tuple[Reading, Stable, Array]:
    """Readings, stability and residuals of the first `count` of n states; beyond, what happens to be there.

    n is 1 or a multiple of `AT_ONCE`.
    """
    on, n = place(basis, p, b), len(states.u)
    size = min(n, AT_ONCE, batch_size(basis.unknowns))

    def one(state: Unknowns) -> tuple[Reading, Stable, Array]:
        local = localise(basis, on, state)
        s = assemble(basis, on, local, len(state.loads))
        return read(basis, on, state), stable(basis, on, local, s, volume), residual(s, state.loads)

    def some(k: Any) -> Any:
        return jax.vmap(one)(jax.tree.map(lambda rows: jax.lax.dynamic_slice_in_dim(rows, k * size, size), states))

    blank = jax.tree.map(lambda s: jnp.zeros((n, *s.shape[1:]), s.dtype), jax.eval_shape(some, 0))

    def put(k: Any, rows: Any) -> Any:
        return jax.tree.map(
            lambda row, new: jax.lax.dynamic_update_slice_in_dim(row, new, k * size, 0), rows, some(k)
        )  # fmt: skip

    found: tuple[Reading, Stable, Array] = jax.lax.fori_loop(0, (count + size - 1) // size, put, blank)
    return found
