"""One compiled function: made from a Python function, or from what another process has made, by JAX's public means.

It takes a flat list of arrays and gives a pytree. JAX sees lists only, whose structure any process can make anew; the
structure of the results is kept as a pytree with their numbers for leaves, because JAX's own cannot be pickled.
"""

import functools
import itertools
import secrets
import threading
from collections.abc import Callable, Sequence
from typing import Any

import jax
import numpy as np
from jax.experimental.serialize_executable import deserialize_and_load, serialize

from mckibben.compiled.options import Options, understood

__all__ = ["Executable", "compiled", "loaded", "tracing"]


class _Tracing(threading.local):
    """Whether this thread traces a kernel now."""

    now = False


tracing = _Tracing()
_turns = itertools.count()
_one_at_a_time = threading.Lock()
"""Python traces one function at a time anyway, and faster so: only the compiler runs beside."""


class Executable:
    """What `compiled` and `loaded` give. Results are NumPy arrays where JAX runs on the processor: none is copied."""

    def __init__(self, function: jax.stages.Compiled, inputs: int, results: Any) -> None:
        self._function, self._inputs, self._results = function, inputs, results
        self._tree: Any = jax.tree.structure(results)
        self._here = jax.default_backend() == "cpu"
        self.ran = False  #: whether it has ever given results
        self.used = next(_turns)  #: when it was made or last called, among all of them

    def __call__(self, leaves: Sequence[Any]) -> Any:
        self.used = next(_turns)
        results = self._function(list(leaves))
        if self._here:
            results = [np.asarray(one) for one in results]
        self.ran = True
        return self._tree.unflatten(results)

    def portable(self) -> tuple[bytes, int, Any]:
        """What `loaded` takes; can be pickled if the structure of the results can."""
        return serialize(self._function)[0], self._inputs, self._results


def compiled(function: Callable[..., Any], name: str, forms: Sequence[Any], options: Options) -> Executable:
    """Compile a function of arrays of given shapes and types."""
    structure: Any = None

    def flat(leaves: list[Any]) -> list[Any]:
        nonlocal structure
        results, structure = jax.tree.flatten(function(leaves))
        return results

    # An executable that JAX reads from its own cache cannot be serialised again: so it must not find one by that name.
    flat.__name__ = f"{name}_{secrets.token_hex(4)}"
    with _one_at_a_time:
        tracing.now = True
        try:
            lowered = jax.jit(flat).lower([jax.ShapeDtypeStruct(*form) for form in forms])
        finally:
            tracing.now = False
    made = lowered.compile(compiler_options=understood(options))
    return Executable(made, len(forms), structure.unflatten(range(structure.num_leaves)))


@functools.cache
def _linear_algebra() -> None:
    """Have executables find LAPACK. JAX looks it up when it first lowers what needs it; without, they would crash."""
    jax.jit(jax.lax.linalg.cholesky).lower(jax.ShapeDtypeStruct((1, 1), np.float64))


def loaded(serialized: bytes, inputs: int, results: Any) -> Executable:
    """What was compiled before, for the first device of this process."""
    _linear_algebra()
    arguments = jax.tree.structure((([0] * inputs,), {}))
    flat = jax.tree.structure([0] * len(jax.tree.leaves(results)))
    device = jax.devices()[0]
    function = deserialize_and_load(serialized, arguments, flat, backend=device.client, execution_devices=[device])
    return Executable(function, inputs, results)
