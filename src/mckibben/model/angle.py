"""Sine and cosine of an angle, or of one whose sine and cosine are already known.

Most of the time of a pointwise derivative goes into sines and cosines, and a compiler computes the same one many times
over. Code that needs many derivatives at an angle passes it as a `Known`, for which two are computed.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from mckibben.model.parameters import Number, functions


class Known(NamedTuple):
    """An angle [rad] with its sine and cosine; differentiate by `value`."""

    value: Number
    sine: Number
    cosine: Number

    @classmethod
    def of(cls, value: Number) -> "Known":
        """The angle with its sine and cosine computed."""
        return cls(value, jnp.sin(value), jnp.cos(value))


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
