"""Compiled functions: `@kernel` is `jax.jit` with the first argument static, and knows executables kept on the disk.

Inside `keeping(folder)` a kernel is read from the folder, or compiled and written to it. Kernels there are compiled
with the least optimisation: a single curve takes some milliseconds more, and the first one several seconds less.
"""

import functools
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar

import attrs
import jax
import jax.numpy as jnp

from . import kept

P = ParamSpec("P")
R = TypeVar("R")

OPTIONS: dict[str, Any] = {"xla_cpu_use_fusion_emitters": False}
"""For repeated use: with the former emitters of loops XLA compiles in two thirds of the time, to faster code."""
QUICK: dict[str, Any] = OPTIONS | {"xla_backend_optimization_level": 0}
"""For a single use: half the time to compile again, three times the time to run."""


@attrs.frozen
class _Place:
    """Where kernels are kept, and who compiles them ahead."""

    folder: Path
    pool: ThreadPoolExecutor


_place: _Place | None = None


@contextmanager
def keeping(folder: Path) -> Iterator[None]:
    """Keep kernels in a folder, if nobody else can write to it and they run on the CPU."""
    global _place
    if not (jax.default_backend() == "cpu" and kept.private(folder)):
        yield
        return
    before = _place
    with ThreadPoolExecutor(max_workers=1, thread_name_prefix="kernels") as pool:
        _place = _Place(folder, pool)
        try:
            yield
        finally:
            _place = before
            pool.shutdown(wait=False, cancel_futures=True)


class Kernel(Generic[P, R]):
    """A function compiled for each static first argument and each set of shapes; the other arguments are arrays."""

    def __init__(self, function: Callable[P, R]) -> None:
        functools.update_wrapper(self, function)
        self._inside = jax.jit(function, static_argnums=0)  # within other compiled functions, which set the options
        self._jit = jax.jit(function, static_argnums=0, compiler_options=OPTIONS)
        self._kept: dict[Any, Future[Any]] = {}
        self._lock = threading.Lock()
        self.lower = self._jit.lower

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        static, *arrays = args
        leaves, tree = jax.tree.flatten(arrays)
        if kwargs or any(isinstance(leaf, jax.core.Tracer) for leaf in leaves):
            return self._inside(*args, **kwargs)
        compiled = None if _place is None else self._find(static, leaves, tree)
        return self._jit(*args) if compiled is None else compiled(*arrays)

    def prepare(self, *args: Any) -> None:
        """Have the kernel read or compiled in the background, where kernels are kept; arrays count by shape alone."""
        if _place is not None:
            leaves, tree = jax.tree.flatten(args[1:])
            _place.pool.submit(self._find, args[0], leaves, tree)

    def _find(self, static: Any, leaves: list[Any], tree: Any) -> Any:
        """The executable, or None where it cannot be kept."""
        place, shapes = _place, tuple((jnp.shape(leaf), jnp.result_type(leaf)) for leaf in leaves)
        if place is None:
            return None
        index = (place.folder, static, tree, shapes)
        with self._lock:
            known = self._kept.get(index)
            if known is None:
                mine = self._kept[index] = Future()
        if known is not None:
            return known.result()
        made = None
        try:
            made = self._made(place.folder, static, shapes, tree)
        finally:
            mine.set_result(made)
        return made

    def _made(self, folder: Path, static: Any, shapes: tuple[Any, ...], tree: Any) -> Any:
        """The executable, read or compiled and written."""
        try:
            name = kept.key(f"{self.__module__}.{self.__qualname__}", static, (str(tree), shapes), QUICK)
        except kept.UnkeepableError:
            return None
        file = folder / f"{self.__name__.strip('_')}-{name}{kept.SUFFIX}"
        found = kept.read(file)
        if found is None:
            arrays = jax.tree.unflatten(tree, [jax.ShapeDtypeStruct(*shape) for shape in shapes])
            found = self.lower(static, *arrays).compile(compiler_options=QUICK)
            kept.write(file, found)
        return found

    def _cache_size(self) -> int:
        return self._jit._cache_size() + self._inside._cache_size() + len(self._kept)

    def clear_cache(self) -> None:
        """Forget what was compiled in this process."""
        self._jit.clear_cache()
        self._inside.clear_cache()
        self._kept.clear()


def kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """Compile a function whose first argument is static (hashable) and whose others are arrays."""
    return Kernel(function)
