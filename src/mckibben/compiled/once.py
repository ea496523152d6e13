"""Parts of kernels that Python runs through once for all of them.

Some two fifths of the time until a first result went into tracing: Python ran through the same pointwise mechanics, and
through its derivatives, for every kernel and every number of unknowns. What is marked here is kept as a program that
JAX copies into whatever kernel uses it; arguments of other shapes or structures are run through anew.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import jax

__all__ = ["once"]

Function = TypeVar("Function", bound=Callable[..., Any])


def once(function: Function, static: int | tuple[int, ...] = ()) -> Function:
    """The same function, of pytrees of numbers and arrays; those at the `static` places are hashable."""
    return cast(Function, jax.jit(function, static_argnums=static, inline=True))
