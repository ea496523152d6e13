"""The gap: a chamber inside the braid that may leave it, blown up by its own pressure until it touches (theory page).

Beside a place of the mesh with the hoop stretch h and the axial stretch s the chamber has the hoop stretch H <= h (both
of the radius R0) that minimises its energy less the work of the pressure on what it encloses. Where H = h it touches.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_derivatives import SymbolicZero

from mckibben.model.kinematics import facing, radius, stretches
from mckibben.model.parameters import Number, Parameters
from mckibben.model.point import Point
from mckibben.model.wall import lying, mean_density
from mckibben.spec.laws import ArrudaBoyce, Gent, NeoHookean

__all__ = ["STEADY", "borne", "contact_of", "found_hoop", "inflated", "leaves", "peak", "pressed", "relaxed_density"]

CLOSE = 1e-9
"""Last relative step of the search for a free radius; it converges quadratically."""
MOST = 60
"""Steps at most: halving alone would end there."""
COLLAPSED = 0.5
"""Share of the radius without pressure below which a vacuum would have to press the chamber: it is not followed."""

STEADY = (NeoHookean, Gent, ArrudaBoyce)
"""Laws by which a tube at a given length bears the more the wider it is: dW/dI1 does not fall (theory page)."""


def leaves(p: Parameters) -> bool:
    """Whether the chamber may leave the braid."""
    return p.tube is not None and p.tube.gap is not None


def borne(hoop: Number, axial: Number, p: Parameters) -> Number:
    """Pressure [Pa] that the chamber alone bears as a cylinder with these stretches of the mesh's R0 and H0."""
    return p.A0 * jax.grad(lambda one: mean_density(one, axial, p))(hoop) / (2.0 * jnp.pi * p.R0**2 * hoop * axial)


def slack_hoop(axial: Number, p: Parameters) -> Number:
    """Hoop stretch, of R0, of the chamber that is stretched along its axis alone: any such rubber keeps its volume."""
    assert p.tube is not None
    return 1.0 / (p.tube.hoop * jnp.sqrt(axial * p.tube.axial))


def smallest_hoop(axial: Number, p: Parameters) -> Number:
    """The least hoop stretch that is followed: half of that without pressure, and above where the bore closes."""
    assert p.tube is not None
    share = COLLAPSED if p.tube.across is None else jnp.maximum(COLLAPSED, jnp.sqrt(1.001 * (1.0 - p.tube.across)))
    return share * slack_hoop(axial, p)


def search(hoop: Number, axial: Number, pressure: Number, p: Parameters) -> Number:
    """H beside a mesh with these stretches, at the pressure [Pa] along the axis: `hoop` where the two touch.

    Newton within brackets in H^-4, in which the pressure of a thin neo-Hookean tube is linear.
    """
    rest = slack_hoop(axial, p)

    def miss(y: Number) -> Number:
        return borne(rest * y**-0.25, axial, p) - pressure

    touching = borne(hoop, axial, p)
    free = touching > pressure
    low = (rest / hoop) ** 4
    high = (rest / smallest_hoop(axial, p)) ** 4
    first = low + (1.0 - low) * (touching - pressure) / jnp.where(free, touching, 1.0)

    def inside(y: Number, low: Number, high: Number) -> Number:
        return jnp.where((y > low) & (y < high), y, 0.5 * (low + high))

    def more(now: Any) -> Any:
        return free & (now[3] > CLOSE) & (now[4] < MOST)

    def again(now: Any) -> Any:
        y, low, high, _, count = now
        value, slope = jax.value_and_grad(miss)(y)
        low, high = jnp.where(value > 0.0, y, low), jnp.where(value > 0.0, high, y)
        new = inside(y - value / slope, low, high)
        return new, low, high, jnp.abs(new / y - 1.0), count + 1

    start = (inside(first, low, high), low, high, jnp.ones_like(low), jnp.zeros_like(low))
    y = jax.lax.while_loop(more, again, start)[0]
    return jnp.where(free, rest * y**-0.25, hoop)


@jax.custom_jvp
def settled(found: Number, hoop: Number, axial: Number, pressure: Number, p: Parameters) -> Number:
    """H, which was found, as a function of the others."""
    return found


@partial(settled.defjvp, symbolic_zeros=True)
def _settled_jvp(primals: Any, tangents: Any) -> tuple[Number, Number]:
    """By the implicit function theorem: to any order, since H in it is `settled` again."""
    found, hoop, axial, pressure, p = primals
    by_hoop, by_axial, by_pressure = (_dense(by, at) for by, at in zip(tangents[1:4], primals[1:4], strict=True))
    H = settled(found, hoop, axial, pressure, p)
    slope, along = jax.grad(borne, (0, 1))(H, axial, p)
    miss = along * by_axial - by_pressure + _by_numbers(lambda p: borne(H, axial, p), p, tangents[4])
    return H, jnp.where(found >= hoop, by_hoop, -miss / slope)


@jax.custom_jvp
def relaxed(found: Number, hoop: Number, axial: Number, pressure: Number, p: Parameters) -> Number:
    """What the chamber stores, and the work that the pressure does not do on the gap, per unit v [J/m]: least by H."""
    return _at_hoop(settled(found, hoop, axial, pressure, p), hoop, axial, pressure, p)


@partial(relaxed.defjvp, symbolic_zeros=True)
def _relaxed_jvp(primals: Any, tangents: Any) -> tuple[Number, Number]:
    """With H held, since the least is stationary in it; the next derivative has H vary, to its first order alone."""
    found, hoop, axial, pressure, p = primals
    by_hoop, by_axial, by_pressure = (_dense(by, at) for by, at in zip(tangents[1:4], primals[1:4], strict=True))
    H, touches = settled(found, hoop, axial, pressure, p), found >= hoop
    hoop_pull, axial_pull = jax.grad(lambda h, a: p.A0 * mean_density(h, a, p), (0, 1))(H, axial)
    area = jnp.pi * p.R0**2
    gap = jnp.where(touches, 0.0, hoop**2 - H**2)
    by = jnp.where(touches, hoop_pull, 2.0 * area * hoop * axial * pressure) * by_hoop
    by = by + (axial_pull + pressure * area * gap) * by_axial + area * gap * axial * by_pressure
    return _at_hoop(H, hoop, axial, pressure, p), by + _by_numbers(
        lambda p: _at_hoop(H, hoop, axial, pressure, p), p, tangents[4]
    )


def _at_hoop(H: Number, hoop: Number, axial: Number, pressure: Number, p: Parameters) -> Number:
    return p.A0 * mean_density(H, axial, p) + pressure * jnp.pi * p.R0**2 * (hoop**2 - H**2) * axial


def _dense(tangent: Any, primal: Number) -> Number:
    return jnp.zeros_like(primal) if isinstance(tangent, SymbolicZero) else tangent


def _by_numbers(function: Any, p: Parameters, tangents: Any) -> Number:
    """Change of a function of a muscle's numbers; nothing is computed where they do not change."""
    if all(isinstance(leaf, SymbolicZero) for leaf in jax.tree.leaves(tangents, is_leaf=_is_zero)):
        return 0.0
    dense = jax.tree.map(_dense, tangents, p, is_leaf=_is_zero)
    return jax.jvp(function, (p,), (dense,))[1]


def _is_zero(leaf: Any) -> bool:
    return isinstance(leaf, SymbolicZero)


def found_hoop(at: Point, P: Number, p: Parameters) -> Number:
    """H of a state at a gauge pressure P [Pa], as a number that nothing depends on."""
    p = lying(at, p)
    hoop, axial, _ = stretches(at, p)
    return search(*jax.lax.stop_gradient((hoop, axial, P * facing(at))), jax.lax.stop_gradient(p))


def inflated(at: Point, P: Number, p: Parameters, found: Any = None) -> Point:
    """The state with H at a gauge pressure P [Pa], `found` before or not; as it is where the chamber has no gap."""
    if not leaves(p):
        return at
    found = found_hoop(at, P, p) if found is None else found
    hoop, axial, _ = stretches(at, p)
    return at._replace(blown=settled(found, hoop, axial, P * facing(at), lying(at, p)))


def relaxed_density(at: Point, P: Number, p: Parameters, found: Any = None) -> Number:
    """Energy of a chamber with a gap per unit v, and the work not done on the gap [J/m]: w_c + P pi (r^2 - a^2) s c."""
    found = found_hoop(at, P, p) if found is None else found
    hoop, axial, _ = stretches(at, p)
    return relaxed(found, hoop, axial, P * facing(at), lying(at, p))


def contact_of(at: Point, P: Number, p: Parameters) -> tuple[Number, Number, Number]:
    """Whether an inflated state touches (1 or 0), its gap [m], and the pressure of the chamber on the mesh [Pa]."""
    touches = at.blown >= stretches(at, p)[0]
    gap = jnp.where(touches, 0.0, radius(at, p) - p.R0 * at.blown)
    return jnp.where(touches, 1.0, 0.0), gap, jnp.where(touches, pressed(at, P, p), 0.0)


def pressed(at: Point, P: Number, p: Parameters) -> Number:
    """Pressure [Pa] of the chamber on the mesh where they touch; below 0 where P would have to grow for that."""
    hoop, axial, _ = stretches(at, p)
    return P - borne(hoop, axial, lying(at, p)) / facing(at)


def peak(p: Parameters) -> tuple[Number, Number]:
    """Pressure [Pa] and radius [m] from which a chamber that is blown up alone bears less, before it touches the braid.

    At the length nearest to that as made at which it does, of all that fibres which do not stretch allow; NaN where it
    bears the more the wider it is at all of them.
    """
    angles = jnp.linspace(jnp.deg2rad(3.0), jnp.deg2rad(87.0), 43)

    def at(theta: Number) -> tuple[Number, Number]:
        hoop, axial, _ = stretches(Point.cylinder(theta), p)
        hoops = slack_hoop(axial, p) + jnp.linspace(0.0, 1.0, 49) * (hoop - slack_hoop(axial, p))
        bears = jax.vmap(lambda one: borne(one, axial, p))(hoops)
        falls = (bears[1:] < bears[:-1] * (1.0 - 1e-9)) & (hoops[1:] > hoops[:-1])
        k = jnp.argmax(falls)
        return jnp.where(falls.any(), bears[k], jnp.nan), p.R0 * hoops[k]

    pressures, radii = jax.vmap(at)(angles)
    nearest = jnp.argmin(jnp.where(jnp.isnan(pressures), jnp.inf, jnp.abs(angles - p.theta0)))
    return pressures[nearest], radii[nearest]
