"""Sine and cosine of an angle, or of one whose sine and cosine are already known.

Most of the time of a pointwise derivative goes into sines and cosines, and a compiler computes the same one many times
over. Code that needs many derivatives at an angle passes it as a `Known`, for which two are computed.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from mckibben.compiled.once import once
from mckibben.model.parameters import Number, functions


class Known(NamedTuple):
    """An angle [rad] with its sine and cosine; differentiate by `value`."""

    value: Number
    sine: Number
    cosine: Number

    @classmethod
    def of(cls, value: Number) -> "Known":
        """The angle with its sine and cosine computed."""
        return cls(value, *_both()(value))


@cache
def _both() -> Callable[[Number], tuple[Number, Number]]:
    """Sine and cosine together, differentiated by each other."""
    both = jax.custom_jvp(once(_sine_and_cosine))

    @both.defjvp
    def _(at: tuple[Number], by: tuple[Number]) -> tuple[tuple[Number, Number], tuple[Number, Number]]:
        sine, cosine = both(*at)
        return (sine, cosine), (cosine * by[0], -sine * by[0])

    return both


_QUARTER = (1.57079632673412561417e0, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""pi/2 in three parts, the first two short enough that whole multiples of them are exact."""
_SINE = (1.58969099521155010221e-10, -2.50507602534068634195e-8, 2.75573137070700676789e-6,
         -1.98412698298579493134e-4, 8.33333333332248946124e-3, -1.66666666666666324348e-1)  # fmt: skip
_COSINE = (-1.13596475577881948265e-11, 2.08757232129817482790e-9, -2.75573143513906633035e-7,
           2.48015872894767294178e-5, -1.38888888888741095749e-3, 4.16666666666666019037e-2)  # fmt: skip
"""Minimax polynomials on +-pi/4 of (sin(x)/x - 1)/x^2 and (cos(x) - 1 + x^2/2)/x^4 in x^2 (Sun's fdlibm)."""


def _sine_and_cosine(value: Number) -> tuple[Number, Number]:
    """To the last digit or two. XLA calls the processor's sine number by number, which takes four times as long.

    The sign comes by a division, after which XLA keeps the values: it does what ends in cheaper operations again in
    every loop that uses them, here up to 14 times.
    """
    x = jnp.asarray(value)
    quarters = jnp.round(x * (2.0 / math.pi))
    for part in _QUARTER:
        x = x - quarters * part
    square = x * x
    sine, cosine = jnp.zeros_like(x), jnp.zeros_like(x)
    for s, c in zip(_SINE, _COSINE, strict=True):
        sine, cosine = sine * square + s, cosine * square + c
    sine, cosine = x + x * square * sine, 1.0 - 0.5 * square + square * square * cosine
    halves = jnp.floor(0.5 * quarters)
    swapped = quarters != 2.0 * halves
    sine, cosine = jnp.where(swapped, cosine, sine), jnp.where(swapped, -sine, cosine)
    half_turn = halves != 2.0 * jnp.floor(0.5 * halves)
    sign = jnp.where(half_turn, -1.0, 1.0)
    return sine / sign, cosine / sign


@cache
def _differentiated() -> tuple[Callable[..., Number], Callable[..., Number]]:
    """Sine and cosine of a `Known` angle, each of which knows that it is the derivative of the other."""
    sine = jax.custom_jvp(lambda value, sine, cosine: sine)
    cosine = jax.custom_jvp(lambda value, sine, cosine: cosine)
    sine.defjvp(lambda at, by: (sine(*at), cosine(*at) * by[0]))
    cosine.defjvp(lambda at, by: (cosine(*at), -sine(*at) * by[0]))
    return sine, cosine


def sin(angle: Any) -> Number:
    """Sine of a number or of a `Known` angle."""
    return _differentiated()[0](*angle) if isinstance(angle, Known) else functions(angle).sin(angle)


def cos(angle: Any) -> Number:
    """Cosine of a number or of a `Known` angle."""
    return _differentiated()[1](*angle) if isinstance(angle, Known) else functions(angle).cos(angle)


def tan(angle: Any) -> Number:
    """Tangent of a number or of a `Known` angle."""
    return sin(angle) / cos(angle) if isinstance(angle, Known) else functions(angle).tan(angle)


def slope(function: Callable[[Any], Number], at: Any) -> Number:
    """Derivative of a function of one angle, a number or `Known`."""
    if not isinstance(at, Known):
        return jax.grad(function)(at)
    return jax.grad(lambda value: function(at._replace(value=value)))(at.value)


def radians(angle: Any) -> Number:
    """The angle [rad] itself."""
    return angle.value if isinstance(angle, Known) else angle
