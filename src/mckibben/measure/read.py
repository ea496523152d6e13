"""Everything read off a state, once: totals, fields along the length, tension, extremes, and how far to trust it.

One differentiable function of the muscle's numbers and the state's unknowns. Results, curves, sweeps, derivatives and
verdicts all use it, mapped and compiled; a compiler leaves out what is not asked for. A symmetric state is read on half
its length and mirrored.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Bool, Float, Int

from mckibben.compiled.arrays import Array
from mckibben.compiled.kernel import kernel
from mckibben.compiled.once import once
from mckibben.compiled.rows import filled
from mckibben.discretise.fields import Placed, place, points_at, states
from mckibben.discretise.spectral import Line
from mckibben.measure.kink import Missed, kinks_of, missed
from mckibben.measure.peak import peak
from mckibben.measure.unresolved import asks_for_step, unresolved_all
from mckibben.model.angle import cos, radians, slope
from mckibben.model.energy import fittings_density, lagrangian
from mckibben.model.fibres import axial_density, fibre_densities
from mckibben.model.friction import crossing_density, crossing_moment
from mckibben.model.gap import contact_of, inflated
from mckibben.model.kinematics import fibre_strains, height_rate, radius, volume_rate
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.slide import shear_stress, slide_density
from mckibben.model.tension import conserved, tension
from mckibben.model.wall import chamber_density, chamber_pull, chamber_stretches, contact_pressure
from mckibben.solver.newton import batch_size, positive
from mckibben.solver.problem import Basis
from mckibben.solver.stability import stiffnesses
from mckibben.solver.system import Local, System, Unknowns, assemble, convex, localise, residual

__all__ = [
    "ENERGIES",
    "NODES",
    "Reading",
    "Stable",
    "costates",
    "nodes",
    "read",
    "read_many",
    "stable",
    "with_kinks",
    "with_unresolved",
]

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
    missed: Missed | None = None  #: what kinks (gaps, slack fibres) and a varying angle add to the error


def nodes(basis: Basis) -> int:
    """Output points that are computed."""
    return NODES // 2 + 1 if basis.half else NODES


def read(basis: Basis, on: Placed, state: Unknowns, kept: Any = None) -> Reading:
    """Everything of one state; `kept` is what the output points remember, where there is a memory."""
    p, sampling, operators = on.p, basis.sampling(nodes(basis)), basis.operators()
    F, P = state.loads[0] * on.unit[0] / on.unit[1], state.loads[1] * on.unit[0] / on.unit[2]
    M = state.loads[2] * on.unit[0] if basis.closes else 0.0
    inner, memory = states(basis, on, state.u), state.memory
    outer = points_at(basis, on, state.u, sampling)
    inner, outer = (jax.vmap(lambda at: inflated(at, P, p))(one) for one in (inner, outer))

    densities, rate, swept = jax.vmap(lambda at, memory: _local(at, p, memory))(inner, memory)
    first, of_first = jax.tree.map(lambda rows: rows[0], (inner, memory))
    names = tuple(_densities(first, p, of_first))
    weights = jnp.asarray(operators.weights) * on.jacobian
    parts = [jnp.sum(weights * density) for density in densities]
    length, volume = jnp.sum(weights * rate), jnp.sum(weights * swept)
    length = length if inner.give is None else length + jnp.sum(weights * inner.give)
    length = length if p.dead is None else length + p.dead
    inner_costates, outer_costates = costates(basis, on, inner, (F, P, M), sampling, memory)
    q = len(weights)
    points, pulls, memories = jax.tree.map(
        lambda *both: jnp.concatenate(both), (inner, inner_costates, memory), (outer, outer_costates, kept)
    )  # fmt: skip
    everywhere = jax.vmap(lambda at, c, kept: _fields(at, c, F, P, p, kept))(points, pulls, memories)
    found = {name: values[q:] for name, values in everywhere.items()}
    found["z"] = sampling.integral @ (on.jacobian * rate)
    ends = () if basis.half else (slice(-1, None),)
    at, along = jax.tree.map(  # on the mesh and the fittings; slices, since picking rows one by one is slow
        lambda rows: jnp.concatenate([rows[: q + 1], *(rows[end] for end in ends)]), (points, pulls)
    )
    conserves = memory is None and on.made is None  # neither what a path leaves nor what varies along the length does
    variation = _variation(on, at, along, F, P, weights) if conserves else jnp.asarray(jnp.nan)
    extremes = jnp.stack([everywhere[name][:q] for name in ("fibre_tension", "r")])
    tallest = jax.vmap(lambda field: peak(field, basis.harmonics()))(extremes)
    numbers = {
        "length": length, "contraction": 1.0 - length / p.rest, "force": F, "pressure": P, "volume": volume,
        **{f"energy_{name}": part for name, part in zip(names, parts, strict=True)}, "energy": sum(parts),
        "peak_fibre_tension": tallest[0], "largest_radius": tallest[1],
        "air_volume": volume if p.tube is None else volume - p.tube.rubber,
    }  # fmt: skip
    if inner.blown is not None:
        touching = jax.vmap(lambda at: contact_of(at, P, p)[0])(inner)
        numbers["contact"] = jnp.where(touching.all(), 1.0, weights @ touching / weights.sum())
    return Reading(numbers, found, jnp.abs(found["psi"]).max(), variation, _tail(basis, on, state.u))


def _tail(basis: Basis, on: Placed, u: Array) -> Array:
    tail: Array = basis.tail(u) if on.made is None else basis.tail(u, varied=True)
    return tail


def with_kinks(reading: Reading, basis: Basis, on: Placed, state: Unknowns, s: System) -> Reading:
    """A reading with what kinks add to its error, where a chamber may leave the mesh or fibres go slack."""
    if not kinks_of(on.p):
        return reading
    return reading._replace(missed=missed(basis, on, state, s, basis.sampling(nodes(basis))))


def with_unresolved(
    reading: Reading, basis: Basis, on: Placed, states: Unknowns, values: Array, each: int | None = None
) -> Reading:
    """Readings of n states with what the unknowns do not resolve, where nothing else tells it.

    `values` (n, l) are those of the equations; `on` is one muscle, or with each=0 n of them.
    """
    if states.memory is not None or not asks_for_step(basis, on.p):
        return reading
    assert isinstance(basis, Line)
    found = unresolved_all(basis, on, states, values, each)
    both = found if reading.missed is None else jax.tree.map(jnp.add, found, reading.missed)
    return reading._replace(missed=both)


@once
def _local(at: Point, p: Parameters, memory: Any) -> tuple[tuple[Number, ...], Number, Number]:
    """Densities of energy, of the length and of the volume."""
    return tuple(_densities(at, p, memory).values()), height_rate(at, p), volume_rate(at, p)


def _densities(at: Point, p: Parameters, memory: Any = None) -> dict[str, Number]:
    """The parts of the stored energy per unit v [J/m], by name."""
    parts = dict(zip(ENERGIES, (*fibre_densities(at, p), chamber_density(at, p)), strict=True))
    parts = parts if at.stretch is None else parts | {"stretch": axial_density(at, p)}
    parts = parts if at.give is None else parts | {"fittings": fittings_density(at, p)}
    parts = parts if memory is None else parts | {"crossings": crossing_density(at, p, memory)}
    return parts if memory is None or memory.slid is None else parts | {"sliding": slide_density(at, p, memory)}


Costates = tuple[Array, ...]
"""Of what is integrated along the length: theta, and the logarithm of the stretch where fibres stretch."""


def costates(
    basis: Basis, on: Placed, at: Point, loads: tuple[Number, ...], sampling: Any, memory: Any = None
) -> tuple[Costates, Costates]:
    """Costates at the quadrature points and at the output points: p' = dL/dtheta of theta, q' = dL/dlog(lambda) of the
    stretch, which theta owes q excess/cos^2(theta).

    They are zero at mid-length of a symmetric state; where equal radii are a condition that of theta is its multiplier
    at v = H0. A state that a path led to is asked for with the memory that the quadrature points had.
    """
    F, P, M = loads
    p, middle = on.p, NODES // 2

    def swept(pull: Array, end: Number) -> tuple[Array, Array]:
        tables = basis.inner_integral(), sampling.integral
        inner, outer = (jnp.asarray(table) @ (on.jacobian * pull) for table in tables)
        last = outer[-1] - end if basis.closes else outer[middle]
        return inner - last, outer - last

    if at.stretch is None:
        pulls = jax.vmap(lambda at, memory: _by_angle(at, (F, P, 0.0), p, memory))(at, memory)
        inner, outer = swept(pulls, M)
        return (inner,), (outer,)
    by_stretch = jax.vmap(lambda at, memory: _by_stretch(at, loads, p, memory))(at, memory)
    by_theta = jax.vmap(lambda at, memory: _by_angle(at, loads, p, memory))(at, memory)
    inner_stretch, outer_stretch = swept(by_stretch, 0.0)
    inner, outer = swept(by_theta - inner_stretch * at.excess / cos(at.theta) ** 2, 0.0)
    return (inner, inner_stretch), (outer, outer_stretch)


@once
def _by_angle(at: Point, loads: tuple[Number, ...], p: Parameters, memory: Any) -> Number:
    """dL/dtheta at one point."""
    F, P, M = loads
    return slope(lambda theta: lagrangian(at._replace(theta=theta), p, F, P, M, memory), at.theta)


@once
def _by_stretch(at: Point, loads: tuple[Number, ...], p: Parameters, memory: Any) -> Number:
    """dL/dlog(lambda) at one point."""
    F, P, M = loads

    def loaded(factor: Number) -> Number:
        return lagrangian(at._replace(stretch=factor * at.stretch), p, F, P, M, memory)

    found: Number = jax.grad(loaded)(1.0)
    return found


@once
def _fields(
    at: Point, costates: Costates, F: Number, P: Number, p: Parameters, memory: Any
) -> dict[str, Number]:  # fmt: skip
    density = _densities(at, p)
    bending1, bending2, twist = (density[name] for name in ENERGIES[:3])
    hoop, axial, thickness = chamber_stretches(at, p)
    u1, u2, u3 = fibre_strains(at, p)
    chamber_axial = chamber_pull(at, p) * cos(at.psi)
    area = jnp.pi * radius(at, p) ** 2 if at.blown is None else volume_rate(at, p) / height_rate(at, p)
    total_axial = F + area * P
    effects: dict[str, Number] = {}
    if at.blown is not None:
        _, effects["gap"], pressed = contact_of(at, P, p)
    if at.stretch is not None:
        effects |= {"fibre_stretch": at.stretch, "density_stretch": density["stretch"]}
    if at.roll is not None:
        effects["roll"] = radians(at.roll)
    if memory is not None:
        effects["crossing_moment"] = crossing_moment(at, p, memory)
        if memory.slid is not None:
            effects |= {"slide": at.slide, "shear_stress": shear_stress(at, p, memory)}
    return effects | {
        "theta": radians(at.theta), "psi": radians(at.psi), "r": radius(at, p),
        "stretch_hoop": hoop, "stretch_axial": axial, "stretch_thickness": thickness,
        "u1": u1, "u2": u2, "u3": u3,
        "density_bending_1": bending1, "density_bending_2": bending2, "density_twist": twist,
        "density_fibres": bending1 + bending2 + twist, "density_chamber": density["chamber"],
        "fibre_tension": tension(at, costates, F, P, p, memory),
        "share_chamber": chamber_axial / total_axial, "share_mesh": 1.0 - chamber_axial / total_axial,
        "contact_pressure": contact_pressure(at, P, p) if at.blown is None else pressed,
    }  # fmt: skip


def _variation(on: Placed, at: Point, costates: Costates, F: Number, P: Number, weights: Array) -> Float[Array, ""]:
    """Relative variation of the conserved quantity over the quadrature points and the fittings after them.

    The fittings count together like one point of the mesh.
    """
    kept, size = jax.vmap(lambda at, c: conserved(at, c, F, P, on.p))(at, costates)
    q, ends = len(weights), len(kept) - len(weights)
    weight = jnp.concatenate([weights / weights.sum(), jnp.full(ends, 1.0 / (q * ends))])
    weight = weight / weight.sum()
    return jnp.sqrt(weight @ (kept - weight @ kept) ** 2) / jnp.maximum(size.max(), 1e-300)


class Stable(NamedTuple):
    """What a state is stable under; True may be trusted, False asks for a count of its modes."""

    length: Bool[Array, ""]
    force: Bool[Array, ""]
    antisymmetric: Bool[Array, ""]


def stable(
    basis: Basis,
    on: Placed,
    local: Local,
    loads: int,
    volume: Array,
    each: int | None = None,
    together: bool = False,
) -> Stable:
    """Stability of n states with so many loads, under length and force control, with the pressure held or the `volume`.

    `on` is one muscle, or with each=0 n of them. A state that is convex is stable in every way; where all are no more
    is asked.
    """

    def counted(on: Placed, local: Local) -> Stable:
        t = stiffnesses(basis, on, local, assemble(basis, on, local, loads, together), together)
        always = [jnp.where(volume, t.gradients[1], 0.0), *t.gradients[2:]]
        force = positive(t.stiffness, jnp.stack(always))
        length = positive(t.stiffness, jnp.stack([t.gradients[0], *always]))
        sideways = positive(t.antisymmetric, t.closure) if basis.half else jnp.array(True)
        return Stable(length, force, sideways)

    sure = jax.vmap(partial(convex, basis))(local)
    found: Stable = jax.lax.cond(
        sure.all(), lambda: Stable(sure, sure, sure), lambda: jax.vmap(counted, (each, 0))(on, local)
    )
    return found


AT_ONCE = 8
"""States that are read in step."""


@kernel
def read_many(
    basis: Basis,
    p: Parameters,
    b: Number,
    states: Unknowns,
    volume: Bool[Array, ""],
    count: Int[Array, ""],
    kept: Any = None,
) -> tuple[Reading, Stable, Array]:
    """Readings, stability and residuals of the first `count` of n states; beyond, what happens to be there.

    Where they have a memory, `kept` is that of the output points (n rows).

    n is 1 or a multiple of `AT_ONCE`.
    """
    on, n, loads = place(basis, p, b), len(states.u), states.loads.shape[1]
    size = min(n, AT_ONCE, batch_size(basis.unknowns))

    def one(state: Unknowns, kept: Any) -> tuple[Reading, Array, Local, Array]:
        local = localise(basis, on, state)
        s = assemble(basis, on, local, len(state.loads))
        seen = with_kinks(read(basis, on, state, kept), basis, on, state, s)
        return seen, residual(s, state.loads), local, s.values

    def some(k: Array) -> tuple[Reading, Stable, Array]:
        rows = jax.tree.map(lambda rows: jax.lax.dynamic_slice_in_dim(rows, k * size, size), (states, kept))
        seen, off, local, values = jax.vmap(one)(*rows)
        seen = with_unresolved(seen, basis, on, rows[0], values)
        return seen, stable(basis, on, local, loads, volume), off

    found: tuple[Reading, Stable, Array]
    if n == 1:  # without the loop and the mapping it is compiled in two thirds of the time
        alone = one(*jax.tree.map(lambda row: row[0], (states, kept)))
        seen, off, local, values = jax.tree.map(lambda value: jnp.asarray(value)[None], alone)
        seen = with_unresolved(seen, basis, on, states, values)
        found = seen, stable(basis, on, local, loads, volume), off
    else:
        found = filled(some, (count + size - 1) // size, n)
    return found
