"""What the quadrature misses where, between two points, a chamber with a gap begins to touch the mesh, or fibres that
carry no compression go slack (theory page).

Of the tube alone and of the tube held to the mesh, the energies less the work on the gap differ by k q^2/2, where q is
the pressure by which the tube presses; those of fibres that pull and of slack ones likewise, where q is their strain
and k their axial stiffness per unit v. The sum over the points takes one on one side and the other on the other. Its
error in the first derivatives, whose slope jumps by k q' grad q, is at most h^2/12 of that jump; of a force or a volume
it is that times the change of q with the length or the pressure.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from mckibben.compiled.arrays import Array
from mckibben.discretise.fields import Placed, Sampling, points_at, states
from mckibben.model.angle import sin
from mckibben.model.axial import axial_stiffness
from mckibben.model.gap import borne, leaves
from mckibben.model.kinematics import facing, stretches
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point, made_angle
from mckibben.model.wall import lying
from mckibben.solver.problem import Basis
from mckibben.solver.system import System, Unknowns

__all__ = ["Missed", "kinks_of", "missed"]

WITHIN, AT_END = 1.0 / 8.0, 3.0 / 8.0
"""Largest error over h times the change of slope from point to point: between two points, and before the first.

Of a slope that is constant on either side 1/12 and 1/4; half as much again is for one that is not, which had 1.1 times
the error in validation/touching.md.
"""
LEAST = 1e-300
HELD = ({"length", "pressure"}, {"force", "pressure"}, {"length", "volume"}, {"force", "volume"})
"""What is held, as `Missed` has it."""


class Missed(NamedTuple):
    """Largest relative errors of a state, by what was held while it was found."""

    length: Float[Array, ""]  #: length and pressure held: of the force
    force: Float[Array, ""]  #: force and pressure held: of the length
    length_volume: Float[Array, ""]  #: length and volume held: of force and pressure
    force_volume: Float[Array, ""]  #: force and volume held: of length and pressure

    def under(self, held: Sequence[Any]) -> Any:
        """Those under what is held; the largest where that is something else, a gas or a ratio."""
        names = {str(name) for name in held}
        for these, bound in zip(HELD, self, strict=True):
            if names == these:
                return bound
        return np.max(np.stack(self), axis=0)


def presses(at: Point, P: Number, p: Parameters) -> tuple[Number, Number]:
    """q [Pa], along the axis, by which the tube presses at the mesh's radius (it is free below 0), and k [m^2/Pa]."""
    hoop, axial, _ = stretches(at, p)
    bears, slope = jax.value_and_grad(borne)(hoop, axial, lying(at, p))
    return P * facing(at) - bears, 2.0 * jnp.pi * p.R0**2 * hoop * axial / slope


def pulls(at: Point, P: Number, p: Parameters) -> tuple[Number, Number]:
    """q, the strain of fibres that carry no compression, and k [J/m], their axial stiffness per unit v at rest."""
    return at.stretch - 1.0, p.N / sin(made_angle(at, p)) * axial_stiffness(p)


Kink = Callable[[Point, Number, Parameters], tuple[Number, Number]]


def kinks_of(p: Parameters) -> tuple[Kink, ...]:
    """What may have a kink along a muscle of these parameters."""
    return ((presses,) if leaves(p) else ()) + ((pulls,) if p.slack is not None else ())


def missed(basis: Basis, on: Placed, state: Unknowns, s: System, outer: Sampling) -> Missed:
    """Bounds of what a state owes to kinks between its points; 0 where all of it is on one side of them.

    The first point of `outer` is a fitting; so is its last one on a full line.
    """
    each = [_missed(kink, basis, on, state, s, outer) for kink in kinks_of(on.p)]
    return jax.tree.map(lambda *bounds: sum(bounds), *each)


def _missed(kink: Kink, basis: Basis, on: Placed, state: Unknowns, s: System, outer: Sampling) -> Missed:
    p, unit = on.p, on.unit

    def everywhere(u: Array, P: Array) -> tuple[Array, Array]:
        return jax.vmap(lambda at: kink(at, P * unit[0] / unit[2], p))(states(basis, on, u))

    P = state.loads[1]
    (q, k), along = jax.linearize(everywhere, state.u, P)
    ends = points_at(basis, on, state.u, outer)
    beyond = jax.vmap(lambda at: kink(at, P * unit[0] / unit[2], p)[0])(ends)
    h = jnp.asarray(basis.operators().weights) * on.jacobian
    size = _edges(q, h, beyond[0], None if basis.half else beyond[-1]) * k / unit[0]

    held = jnp.array([0, *range(2, len(state.loads))])  # length, and equal end radii where they are a condition
    G, n = s.gradients[held], len(state.u)
    table = jnp.block([[s.stiffness, -G.T], [-G, jnp.zeros((len(held), len(held)))]])
    sides = jnp.zeros((len(table), 2)).at[n, 0].set(-1.0).at[:n, 1].set(s.gradients[1])
    by_length, by_pressure = jnp.linalg.solve(table, sides).T  # a unit more of each, the other held
    volumes = s.gradients[1] @ jnp.stack([by_length[:n], by_pressure[:n]], axis=1)
    swells = 0.0 if s.by_loads is None else s.by_loads[1, 1]
    slopes = jnp.array([[by_length[n], by_pressure[n]], [volumes[0], volumes[1] + swells]])
    q_length = along(by_length[:n], jnp.zeros_like(P))[0]
    q_pressure = along(by_pressure[:n], jnp.ones_like(P))[0]

    def bound(each: Array, of: Array) -> Array:
        """Of the sum over the kinks, each with the largest nearby."""
        total = size @ _largest_near(jnp.abs(each))
        return jnp.where(total > 0.0, total / jnp.maximum(jnp.abs(of), LEAST), 0.0)

    load = jnp.abs(state.loads[0]) + jnp.pi * p.R0**2 * unit[1] / unit[2] * jnp.abs(P)
    soft = q_pressure / slopes[1, 1]
    length, pressure = jnp.linalg.solve(slopes, jnp.stack([q_length, -q_pressure]))
    return Missed(
        bound(q_length, load),
        bound(q_length / slopes[0, 0], s.values[0]),
        jnp.maximum(bound(soft, P), bound(q_length + slopes[0, 1] * soft, load)),
        jnp.maximum(bound(pressure, P), bound(length, s.values[0])),
    )


def _edges(q: Array, h: Array, first: Array, last: Array | None) -> Array:
    """At the points: h times the change of q beside each place where it changes its sign, times the share missed."""

    def between(a: Array, b: Array) -> Array:
        return jnp.where((a > 0.0) != (b > 0.0), jnp.abs(a - b), 0.0)

    inside = WITHIN * 0.25 * (h[1:] + h[:-1]) * between(q[1:], q[:-1])
    found = jnp.zeros_like(q).at[1:].add(inside).at[:-1].add(inside)
    found = found.at[0].add(AT_END * h[0] * between(q[0], first))
    return found if last is None else found.at[-1].add(AT_END * h[-1] * between(q[-1], last))


def _largest_near(each: Array) -> Array:
    """The largest of each point's own and its neighbours'."""
    wide = jnp.pad(each, 1, mode="edge")
    return jnp.maximum(each, jnp.maximum(wide[2:], wide[:-2]))
