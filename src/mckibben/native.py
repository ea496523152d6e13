"""Executables of XLA run by jaxlib alone, because importing JAX takes longer than a test does.

JAX has no public way to run what it has compiled without itself. So this uses jaxlib's inner names, stays small, and
whoever calls it is ready for any exception: JAX then does the work, slower.
"""

import os
import sys
import threading
from collections.abc import Sequence
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "1")  # as JAX does
from jaxlib import _jax, xla_client
from jaxlib.cpu import _lapack

from .lazy import imported, jax

_lock = threading.Lock()
flatten = _jax.pytree.default_registry().flatten
"""As `jax.tree.flatten`."""


class _Form:
    """Shape and type of an array, as JAX's abstract values tell them."""

    weak_type = False

    def __init__(self, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
        self.shape, self.dtype = shape, dtype


class _Whole(_jax.SingleDeviceSharding):  # type: ignore[misc]
    """An array that lies on one device."""

    memory_kind = None

    def _to_xla_hlo_sharding(self, _: int) -> Any:
        return xla_client.HloSharding.replicate()


class _Host(NamedTuple):
    """The processor as a device."""

    client: Any
    devices: Any
    whole: _Whole

    def put(self, value: Any) -> Any:
        """An argument; it is copied."""
        array, once = np.asarray(value), _jax.HostBufferSemantics.IMMUTABLE_ONLY_DURING_CALL
        form = _Form(array.shape, array.dtype)
        return _jax.batched_device_put(form, self.whole, [array], list(self.devices), True, False, once, True)


def alone() -> bool:
    """Whether JAX would run on the processor and on nothing else, told without importing it where that can be."""
    asked = os.environ.get("JAX_PLATFORMS", "")
    others = asked != "cpu" if asked else any(map(find_spec, ("jax_plugins", "libtpu")))
    return jax.default_backend() == "cpu" if others or imported() else True


@cache
def _host() -> _Host:
    client: Any = xla_client.make_cpu_client(asynchronous=False)
    _find_lapack()
    device = client.local_devices()[0]
    return _Host(client, _jax.DeviceList((device,)), _Whole(device))


def _find_lapack() -> None:
    """Have executables find LAPACK, without which those that call it would crash.

    jaxlib takes it from two modules of SciPy; the package around them would take longer to import than all of jaxlib.
    """
    import scipy

    for name in ("scipy.linalg.cython_blas", "scipy.linalg.cython_lapack"):
        if name not in sys.modules:
            found = PathFinder.find_spec(name, [str(Path(scipy.__file__).parent / "linalg")])
            if found is None or found.loader is None:
                raise ImportError(name)
            sys.modules[name] = module_from_spec(found)
            found.loader.exec_module(sys.modules[name])
    _lapack.initialize()
    for name, value in _lapack.registrations().items():
        if name.endswith("_ffi"):
            xla_client.register_custom_call_target(name, value, platform="cpu", api_version=1)


class Executable:
    """A function compiled for arguments of given shapes; takes and gives NumPy arrays in pytrees."""

    def __init__(self, serialized: bytes, results: Any, forms: Sequence[tuple[tuple[int, ...], str]]) -> None:
        with _lock:
            host = _host()
        self._host, self._tree = host, flatten(results)[1]
        self._loaded = host.client.deserialize_executable(serialized, host.devices)
        self._handlers = [
            _jax.array_result_handler(_Form(shape, np.dtype(dtype)), host.whole, True, True) for shape, dtype in forms
        ]

    def __call__(self, *arrays: Any) -> Any:
        leaves, _ = flatten(arrays)
        results = self._loaded.execute_sharded([self._host.put(leaf) for leaf in leaves])
        return self._tree.unflatten([np.asarray(one) for one in results.consume_with_handlers(self._handlers)])


def serialize(compiled: Any) -> tuple[bytes, Any, list[tuple[tuple[int, ...], str]]]:
    """What `Executable` takes, of a `jax.stages.Compiled` that keeps all its arguments: it can be pickled.

    The results are a pytree with their numbers for leaves, because JAX's own description of one needs JAX to be read.
    """
    executable = compiled.runtime_executable()
    forms = [(tuple(leaf.shape), leaf.dtype.str) for leaf in jax.tree.leaves(compiled.out_info)]
    results = compiled.out_tree.unflatten(range(len(forms)))
    return executable.client.serialize_executable(executable), results, forms
