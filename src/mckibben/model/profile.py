"""The braid angle as made where it varies along the length: cubics through what is given (theory page)."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from mckibben.compiled.arrays import Array
from mckibben.model.angle import Known, radians
from mckibben.model.parameters import Number, Parameters, numbers
from mckibben.model.point import Made
from mckibben.spec.angle_profile import Between
from mckibben.spec.muscle import Muscle

__all__ = ["at_share", "evened", "extremes", "fibre_length", "fibre_lengths", "made_at"]

GAUSS = 16
"""Points of an integral from one place to the next, between which the angle is a cubic."""
LOOKED_AT = 401
"""Places at which the least and the largest angle are looked for."""


def along(share: Array, p: Parameters) -> tuple[Array, Array]:
    """Braid angle [rad] of a programmed braid at shares of its length, and its derivative by the share."""
    x, y = _nodes(p)
    return _hermite(share, x, y, _spline(x, y) if p.profile.between == Between.SPLINE else _monotone(x, y))


def made_at(share: Array, p: Parameters) -> Made | None:
    """How the braid is made at shares v/H0 of its length (n); None where it has one angle."""
    if p.profile is None:
        return None
    angle, rate = along(share, p)
    return Made(Known.of(angle), rate / p.H0)


def at_share(share: float, p: Parameters) -> Parameters:
    """The numbers of a braid that has the angle of one place all along."""
    return p if p.profile is None else p._replace(theta0=along(jnp.asarray(share), p)[0], profile=None)


def evened(p: Parameters) -> Parameters:
    """The numbers of a braid of one angle whose fibres are as long: for what knows of cylinders alone."""
    if p.profile is None:
        return p
    return p._replace(theta0=jnp.arcsin(p.H0 / fibre_length(p)), profile=None)


def fibre_length(p: Parameters) -> Number:
    """Length of a fibre as made [m], from fitting to fitting: the integral of 1/sin(theta0)."""
    if p.profile is None:
        return p.H0 / jnp.sin(p.theta0)
    x, _ = _nodes(p)
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    width = jnp.diff(x)
    share = x[:-1, None] + width[:, None] * (0.5 + 0.5 * points)
    return p.H0 * jnp.sum(0.5 * width * ((1.0 / jnp.sin(along(share, p)[0])) @ weights))


def extremes(p: Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest braid angle [rad] as made of many braids, whose numbers are arrays (n)."""
    found = jax.vmap(lambda p: along(jnp.linspace(0.0, 1.0, LOOKED_AT), p)[0])(p)
    return np.asarray(found.min(axis=1)), np.asarray(found.max(axis=1))


def fibre_lengths(muscle: Muscle) -> Any:
    """The same of a muscle, or of many whose numbers are arrays."""
    braid = muscle.braid
    if braid.angle_profile is None:
        return np.asarray(braid.length) / np.sin(braid.angle)
    p = numbers(muscle)
    parts = (p.H0, p.theta0, p.profile)
    shape = np.broadcast_shapes(*(np.shape(number) for number in jax.tree.leaves(parts)))
    flat = jax.tree.map(lambda number: jnp.broadcast_to(jnp.asarray(number, float), shape).reshape(-1), parts)

    def one(H0: Number, theta0: Number, profile: Any) -> Number:
        return fibre_length(p._replace(H0=H0, theta0=theta0, profile=profile))

    return np.asarray(jax.vmap(one)(*flat)).reshape(shape)


def _nodes(p: Parameters) -> tuple[Array, Array]:
    """Shares of the length, and the angles there [rad], over the whole length."""
    x = jnp.stack([jnp.zeros(()), *(jnp.asarray(at, float) for at in p.profile.places)])
    y = jnp.stack([jnp.asarray(angle, float) for angle in (radians(p.theta0), *p.profile.angle)])
    if not p.profile.mirrored:
        return x, y
    return jnp.concatenate([x, 1.0 - x[-2::-1]]), jnp.concatenate([y, y[-2::-1]])


def _hermite(share: Array, x: Array, y: Array, m: Array) -> tuple[Array, Array]:
    """Values and slopes at shares of the cubics through points with slopes m."""
    w, d = jnp.diff(x), jnp.diff(y)
    k = jnp.clip(jnp.searchsorted(x, share, side="right") - 1, 0, len(w) - 1)
    t = (share - x[k]) / w[k]
    a, b, c = w[k] * m[k], 3.0 * d[k] - w[k] * (2.0 * m[k] + m[k + 1]), w[k] * (m[k] + m[k + 1]) - 2.0 * d[k]
    return y[k] + t * (a + t * (b + t * c)), (a + t * (2.0 * b + 3.0 * t * c)) / w[k]


def _spline(x: Array, y: Array) -> Array:
    """Slopes at the points of the cubic spline: a line, a parabola, or without a knot next to the ends."""
    w, s = jnp.diff(x), jnp.diff(y) / jnp.diff(x)
    n = len(x)
    if n == 2:
        return jnp.stack([s[0], s[0]])
    inner = 3.0 * (w[1:] * s[:-1] + w[:-1] * s[1:])
    first: tuple[Any, Any]
    last: tuple[Any, Any]
    if n == 3:
        first, last, right = (1.0, 1.0), (1.0, 1.0), (2.0 * s[0], 2.0 * s[1])
    else:
        a, b = x[2] - x[0], x[-1] - x[-3]
        first, last = (w[1], a), (b, w[-2])
        right = (
            ((w[0] + 2.0 * a) * w[1] * s[0] + w[0] ** 2 * s[1]) / a,
            (w[-1] ** 2 * s[-2] + (2.0 * b + w[-1]) * w[-2] * s[-1]) / b,
        )
    k = jnp.arange(1, n - 1)
    table = jnp.zeros((n, n)).at[k, k - 1].set(w[1:]).at[k, k].set(2.0 * (w[1:] + w[:-1])).at[k, k + 1].set(w[:-1])
    table = table.at[0, :2].set(jnp.stack(first)).at[-1, -2:].set(jnp.stack(last))
    return jnp.linalg.solve(table, jnp.concatenate([right[0][None], inner, right[1][None]]))


def _monotone(x: Array, y: Array) -> Array:
    """Slopes at the points of the monotone cubic: weighted harmonic means, 0 where the way turns back (Fritsch and
    Butland 1984), and three-point ones at the ends, kept from overshooting."""
    w, s = jnp.diff(x), jnp.diff(y) / jnp.diff(x)
    if len(s) == 1:
        return jnp.stack([s[0], s[0]])
    first, second = 2.0 * w[1:] + w[:-1], w[1:] + 2.0 * w[:-1]
    same = s[:-1] * s[1:] > 0.0
    before, after = (jnp.where(same, one, 1.0) for one in (s[:-1], s[1:]))
    inner = jnp.where(same, (first + second) / (first / before + second / after), 0.0)
    return jnp.concatenate([_end(w[0], w[1], s[0], s[1])[None], inner, _end(w[-1], w[-2], s[-1], s[-2])[None]])


def _end(w0: Number, w1: Number, s0: Number, s1: Number) -> Array:
    """Slope at an end: of the way of the piece there, and at most three times its slope where the next turns back."""
    slope = ((2.0 * w0 + w1) * s0 - w0 * s1) / (w0 + w1)
    slope = jnp.where((s0 * s1 < 0.0) & (jnp.abs(slope) > 3.0 * jnp.abs(s0)), 3.0 * s0, slope)
    return jnp.where(slope * s0 > 0.0, slope, 0.0)
