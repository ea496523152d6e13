"""From rest to the states of a test in compiled code alone, so that it can be traced, batched and compiled as a whole.

It is quick and not as robust as the search of `solver/path.py`: what it does not reach is NaN.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Placed, place
from mckibben.model.cylinder import inside_at_rest
from mckibben.model.gap import leaves
from mckibben.model.parameters import Number, Parameters
from mckibben.solver.follow import follow
from mckibben.solver.held import ROWS, Now, read_rows, rows_of, units
from mckibben.solver.problem import Basis
from mckibben.solver.system import Unknowns, system
from mckibben.spec.loading import Step

__all__ = ["Wanted", "approach", "begin", "reading", "rest", "target", "wanted"]

LEG = 10
"""States on each straight leg of the way to the first state of a step."""
CLOSE = 1e-6
"""Last Newton step of a state, whose error is then about its square."""


class Wanted(NamedTuple):
    """What a step holds: the names of the rows, and their dimensionless targets state by state."""

    names: tuple[str, ...]
    targets: Float[Array, "n 2"]


def rest(on: Placed) -> Now:
    """What the undeformed muscle reads."""
    one = jnp.ones_like(on.unit[0])
    volume = inside_at_rest(on.p) / on.unit[2] if leaves(on.p) else one
    return read_rows(on.unit, jnp.stack([one, volume]), jnp.stack([0.0 * one, 0.0 * one]), on.p)


def begin(basis: Basis, on: Placed) -> tuple[Unknowns, Now]:
    """The undeformed muscle, or the cylinder of the first fitting's own radius with the loads that hold it."""
    state = Unknowns(jnp.zeros(basis.unknowns), jnp.zeros(3 if basis.closes else 2))
    if on.p.end_radii is None:
        return state, rest(on)
    s = system(basis, on, state)
    axial = jnp.delete(s.gradients, 1, axis=0)
    loads = jnp.insert(jnp.linalg.lstsq(axial.T, s.rest)[0], 1, 0.0)
    return state._replace(loads=loads), read_rows(on.unit, s.values, loads, on.p)


def reading(basis: Basis, on: Placed, state: Unknowns) -> Now:
    """What a state reads, in SI units."""
    return read_rows(on.unit, system(basis, on, state).values, state.loads, on.p)


def target(name: str, now: Now) -> Number:
    """The target at which a named row holds now."""
    return ROWS[name](now, 0.0)


def wanted(step: Step, present: Now, on: Placed) -> Wanted:
    """What a step holds, from what the muscle reads as it begins; gas sealed in is that of the present."""
    size, columns, names = units(on.unit), [], []
    for name in step.controls:
        path = getattr(step, name)
        knots = [jnp.asarray(number, float) / size[name] for number in path.waypoints]
        knots = [getattr(present, name) / size[name], *knots] if path.needs_present else knots
        columns.append(path.weights(step.points) @ jnp.stack(knots))
        names.append(str(name))
    if step.gas is not None:
        names.append(str(step.gas))
        columns.append(jnp.full(step.points, 1.0) * target(names[-1], present))
    return Wanted(tuple(names), jnp.stack(columns, axis=1))


def approach(basis: Basis, p: Parameters, b: Number, steps: tuple[Step, ...]) -> tuple[Unknowns, ...]:
    """States of each step, with a leading dimension; from the first that is not reached on NaN."""
    on = place(basis, p, b)
    state, have = begin(basis, on)
    walk = _Walk(basis, p, b, on)
    found = []
    for index, step in enumerate(steps):
        asked = wanted(step, have, on)
        if index == 0 and step.gas is None:
            state, have = walk.pressure_first(state, have, asked)
        size = units(on.unit)
        present = jnp.stack([target(name, have) / size[name] for name in asked.names])
        lead = _straight(present, asked.targets[0])
        states, have = walk.along(asked.names, state, have, jnp.concatenate([lead, asked.targets]))
        found.append(jax.tree.map(lambda row: row[LEG:], states))
        state = jax.tree.map(lambda row: row[-1], states)
    return tuple(found)


class _Walk(NamedTuple):
    basis: Any
    p: Parameters
    b: Number
    on: Placed

    def pressure_first(self, state: Unknowns, have: Now, asked: Wanted) -> tuple[Unknowns, Now]:
        """Pressure before length or force: it stretches the braid, which would fold if it were compressed without."""
        names, targets, size = asked.names, asked.targets, units(self.on.unit)
        axial = "length" if "length" in names else "force"
        top = targets[:, names.index("pressure")].max() if "pressure" in names else jnp.ones(())
        now = jnp.stack([getattr(have, name) / size[name] for name in (axial, "pressure")])
        end = targets[0, names.index(axial)] if axial in names else now[0]
        above, aside = jnp.stack([now[0], top]), jnp.stack([end, top])
        way = jnp.concatenate([_straight(now, above), _straight(above, aside), aside[None]])
        states, last = self.along((axial, "pressure"), state, have, way)
        return jax.tree.map(lambda row: row[-1], states), last

    def along(self, names: tuple[str, ...], state: Unknowns, have: Now, way: Array) -> tuple[Unknowns, Now]:
        """States along a way that begins where `state` is, NaN beyond the part reached; what the last one reads.

        Where the other end has not its radius yet, it gets it on the first leg.
        """
        loads = len(state.loads)
        own, which = rows_of(names, loads)
        n = way.shape[0]
        if loads == 3:
            share = jnp.clip(1.0 - jnp.arange(n) / LEG, 0.0, 1.0)
            way = jnp.concatenate([way, (share * have.closure)[:, None]], axis=1)
        track = follow(
            (self.basis, own), self.p, self.b, state, jnp.asarray(which), way, jnp.asarray(n), jnp.asarray(CLOSE)
        )
        reached = jnp.arange(n) < track.good

        def kept(row: Array) -> Array:
            return jnp.where(reached[:, None], row, jnp.nan)

        states = jax.tree.map(kept, track.state)
        return states, reading(self.basis, self.on, jax.tree.map(lambda row: row[-1], states))


def _straight(start: Array, end: Array) -> Array:
    """`LEG` points from the start on, the end left out."""
    return start + jnp.linspace(0.0, 1.0, LEG, endpoint=False)[:, None] * (end - start)
