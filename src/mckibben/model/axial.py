"""Tension and energy of a fibre that stretches: proportional to its strain, or by points of a pull test."""

from typing import Any

import jax
import jax.numpy as jnp

from mckibben.compiled.arrays import Array
from mckibben.model.parameters import Number, Parameters

__all__ = ["axial_energy", "axial_stiffness", "axial_tension"]


def axial_tension(strain: Number, p: Parameters) -> Number:
    """Tension T [N] of one fibre at strain lambda - 1: EA times it, or by its law; 0 where a slack one is shorter."""
    if p.axial is None:
        return p.EA * jnp.where(_loose(strain, p), 0.0, strain)
    return jnp.where(_loose(strain, p), 0.0, _by_points(strain, p.axial)[0])


def axial_energy(strain: Number, p: Parameters) -> Number:
    """Energy of one fibre per unit of its length as made [N], by its law: the integral of the tension from rest on."""
    return jnp.where(_loose(strain, p), 0.0, _by_points(strain, p.axial)[1])


def _loose(strain: Number, p: Parameters) -> Any:
    return False if p.slack is None else strain < 0.0


def axial_stiffness(p: Parameters) -> Number:
    """Stiffness EA [N] of a fibre at rest, by its law the slope there."""
    return p.EA if p.axial is None else jax.grad(lambda strain: _by_points(strain, p.axial)[0])(0.0)


def _by_points(strain: Number, law: Any) -> tuple[Number, Number]:
    """Tension and its integral from rest on: cubic Hermite pieces, straight lines beyond the first and last point.

    A piece with ends f0, f1 and slopes m0, m1 over a width w, t = (x - x0)/w from 0 to 1:
    f = f0 + t (w m0 + t (3 d - 2 w m0 - w m1 + t (w m0 + w m1 - 2 d))), d = f1 - f0.
    """
    x, f = (jnp.stack([jnp.asarray(value, float) for value in values]) for values in (law.strain, law.force))
    m = _slopes(x, f)
    w, d = jnp.diff(x), jnp.diff(f)
    a, b, c = w * m[:-1], 3.0 * d - w * (2.0 * m[:-1] + m[1:]), w * (m[:-1] + m[1:]) - 2.0 * d
    whole = w * (f[:-1] + a / 2.0 + b / 3.0 + c / 4.0)
    before = jnp.concatenate([jnp.zeros(1), jnp.cumsum(whole)])
    at_rest = jnp.argmin(jnp.abs(x))
    e = jnp.asarray(strain)
    k = jnp.clip(jnp.sum(e[..., None] >= x, axis=-1) - 1, 0, len(w) - 1)
    t = jnp.clip((e - x[k]) / w[k], 0.0, 1.0)
    past = e - jnp.clip(e, x[0], x[-1])
    slope = jnp.where(past < 0.0, m[0], m[-1])
    inside = f[k] + t * (a[k] + t * (b[k] + t * c[k]))
    area = before[k] + w[k] * t * (f[k] + t * (a[k] / 2.0 + t * (b[k] / 3.0 + t * c[k] / 4.0)))
    return inside + slope * past, area - before[at_rest] + past * (inside + 0.5 * slope * past)


def _slopes(x: Array, f: Array) -> Array:
    """Slopes at the points: weighted harmonic means inside (Fritsch and Butland 1984), three-point ones at the ends."""
    w, s = jnp.diff(x), jnp.diff(f) / jnp.diff(x)
    if len(s) == 1:
        return jnp.stack([s[0], s[0]])
    first, second = 2.0 * w[1:] + w[:-1], w[1:] + 2.0 * w[:-1]
    inner = (first + second) / (first / s[:-1] + second / s[1:])
    ends = (_end(w[0], w[1], s[0], s[1]), _end(w[-1], w[-2], s[-1], s[-2]))
    return jnp.concatenate([ends[0][None], inner, ends[1][None]])


def _end(w0: Number, w1: Number, s0: Number, s1: Number) -> Array:
    """Slope at an end, kept from 0 to three times that of the piece there, so that the tension rises."""
    return jnp.clip(((2.0 * w0 + w1) * s0 - w0 * s1) / (w0 + w1), 0.0, 3.0 * s0)
