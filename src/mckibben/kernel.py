"""Compiled functions: `@kernel` is `jax.jit` with the first argument static, and knows executables kept on the disk.

A kernel is read from the user's folder of compiled functions, or compiled and written to it. Inside `keeping(folder)`,
as the command line has it, kernels are compiled with the least optimisation: a single curve takes some milliseconds
more, and the first one several seconds less.
"""

import functools
import secrets
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from . import cache, kept, native
from .lazy import imported, jax

OPTIONS: dict[str, Any] = {
    "xla_cpu_use_fusion_emitters": False,
    "xla_cpu_multi_thread_eigen": False,
    "xla_disable_hlo_passes": "cpu-parallel-task-assigner",
}
"""With the former emitters of loops XLA compiles in two thirds of the time, to faster code. No work is divided among
threads: the same bits come out on one core and on many."""
QUICK: dict[str, Any] = OPTIONS | {"xla_backend_optimization_level": 0}
"""For few calls: half the time to compile again, three times the time to run."""


def _known(options: dict[str, Any]) -> dict[str, Any] | None:
    """Options that this compiler takes: None on other devices than the CPU, and where it no longer has them."""
    return options if _takes(tuple(options.items())) else None


@functools.cache
def _takes(options: tuple[tuple[str, Any], ...]) -> bool:
    if jax.default_backend() != "cpu":
        return False
    try:
        jax.jit(lambda x: x).lower(0.0).compile(compiler_options=dict(options))
    except jax.errors.JaxRuntimeError:
        return False
    return True


class _Place(NamedTuple):
    """Where kernels are kept, and how they are compiled."""

    folder: Path
    options: Any


_place: _Place | None = None


@contextmanager
def keeping(folder: Path | None, options: dict[str, Any] = QUICK) -> Iterator[None]:
    """Keep kernels in a folder, if there is one, nobody else can write to it, and they run on the CPU."""
    global _place
    before, _place = _place, _checked(folder, options) or _place
    try:
        yield
    finally:
        _place = before


def _checked(folder: Path | None, options: dict[str, Any]) -> _Place | None:
    if folder is None or not (native.alone() and kept.private(folder)):
        return None
    return _Place(folder, tuple(options.items()))


def _where() -> _Place | None:
    return _place or _usual()


@functools.cache
def _usual() -> _Place | None:
    """The user's folder."""
    return _checked(cache.kernels(), OPTIONS)


@functools.cache
def _ahead() -> ThreadPoolExecutor:
    """Who reads and compiles kernels before they are called."""
    return ThreadPoolExecutor(max_workers=2, thread_name_prefix="kernels")


class _Apart:
    """While this is entered, by any number of threads, nothing goes into JAX's own cache."""

    def __init__(self) -> None:
        self._lock, self._inside, self._before = threading.Lock(), 0, 0.0

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._before = jax.config.values[_LEAST_TIME]
                jax.config.update(_LEAST_TIME, float("inf"))
            self._inside += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                jax.config.update(_LEAST_TIME, self._before)


_LEAST_TIME = "jax_persistent_cache_min_compile_time_secs"
_apart = _Apart()
_tracing = threading.Lock()
"""Python traces one function at a time anyway, and faster so: only the compiler runs beside."""


class _Kind(NamedTuple):
    """One executable of a kernel."""

    place: _Place
    static: Any
    tree: Any
    shapes: tuple[Any, ...]

    @classmethod
    def of(cls, place: _Place, static: Any, arrays: Any) -> "_Kind":
        """By the arrays' shapes and types."""
        leaves, tree = native.flatten(arrays)
        types = (leaf.dtype if hasattr(leaf, "dtype") else np.dtype(type(leaf)) for leaf in leaves)
        return cls(place, static, tree, tuple(zip(map(np.shape, leaves), types, strict=True)))


class Kernel:
    """A function compiled for each static first argument and each set of shapes; the other arguments are arrays."""

    def __init__(self, function: Callable[..., Any]) -> None:
        functools.update_wrapper(self, function)
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._function = function
        self._kept: dict[Any, Future[Any]] = {}
        self._lock = threading.Lock()

    @functools.cached_property
    def _inside(self) -> Any:
        """Within other compiled functions."""
        return jax.jit(self._function, static_argnums=0)

    @functools.cached_property
    def _jit(self) -> Any:
        return jax.jit(self._function, static_argnums=0, compiler_options=_known(OPTIONS))

    def lower(self, *args: Any) -> Any:
        """As of `jax.jit`."""
        return self._jit.lower(*args)

    def __reduce__(self) -> str:
        return self._function.__qualname__  # a kernel is known by its module and name

    def __call__(self, *args: Any) -> Any:
        static, arrays = args[0], args[1:]
        if imported() and any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(arrays)):
            return self._inside(*args)
        place = _where()
        if place is None:
            return self._jit(*args)
        kind = _Kind.of(place, static, arrays)
        found = self._find(kind)
        if found is not None:
            try:
                return found(*arrays)
            except (TypeError, ValueError, RuntimeError):  # read, but not what it should be
                self._drop(kind)
        return self._jit(*args)

    def prepare(self, static: Any, *arrays: Any) -> None:
        """Have the kernel read or compiled in the background, where kernels are kept; arrays count by shape alone."""
        place = _where()
        if place is not None:
            _ahead().submit(self._find, _Kind.of(place, static, arrays))

    def _find(self, kind: _Kind) -> Any:
        """The executable, made once and waited for by others; None where it cannot be kept."""
        with self._lock:
            known = self._kept.get(kind)
            if known is None:
                mine = self._kept[kind] = Future()
        if known is not None:
            return known.result()
        found = None
        try:
            file = self._file(kind)
            if file is not None:
                found = kept.read(file)
                if found is None:
                    found = self._compile(kind)
                    kept.write(file, found)
        finally:
            mine.set_result(found)
        return found

    def _file(self, kind: _Kind) -> Path | None:
        try:
            key = kept.key(self._name, kind.static, (str(kind.tree), kind.shapes), dict(kind.place.options))
        except kept.UnkeepableError:
            return None
        return kind.place.folder / f"{self._function.__name__.strip('_')}-{key}{kept.SUFFIX}"

    def _drop(self, kind: _Kind) -> None:
        """Neither use nor keep an executable again."""
        file = self._file(kind)
        if file is not None:
            with suppress(OSError):
                file.unlink()
        nothing: Future[Any] = Future()
        nothing.set_result(None)
        self._kept[kind] = nothing

    def _compile(self, kind: _Kind) -> Any:
        """Compiled for one use, apart from JAX's own cache: what that reads back cannot be written again.

        So the name is new each time, and nothing is put there.
        """

        def once(*args: Any) -> Any:
            return self._function(*args)

        once.__name__ = f"{self._function.__name__}_{secrets.token_hex(4)}"
        arrays = jax.tree.unflatten(kind.tree, [jax.ShapeDtypeStruct(*shape) for shape in kind.shapes])
        with _tracing:
            lowered = jax.jit(once, static_argnums=0, keep_unused=True).lower(kind.static, *arrays)
        with _apart:
            try:
                return lowered.compile(compiler_options=dict(kind.place.options))
            except jax.errors.JaxRuntimeError:  # a compiler that no longer has these options
                return lowered.compile()

    def _by_jax(self) -> list[Any]:
        """What JAX has compiled, as far as it was asked."""
        return [self.__dict__[name] for name in ("_jit", "_inside") if name in self.__dict__]

    def _cache_size(self) -> int:
        return sum(function._cache_size() for function in self._by_jax()) + len(self._kept)

    def clear_cache(self) -> None:
        """Forget what was compiled in this process."""
        for function in self._by_jax():
            function.clear_cache()
        self._kept.clear()


def kernel(function: Callable[..., Any]) -> Kernel:
    """Compile a function whose first argument is static (hashable) and whose others are arrays."""
    return Kernel(function)


def jitted(function: Callable[..., Any], **settings: Any) -> Callable[..., Any]:
    """`jax.jit` for the same bits on any number of cores. What the device takes is looked up at the first call."""

    @functools.cache
    def made() -> Any:
        return jax.jit(function, compiler_options=_known(OPTIONS), **settings)

    @functools.wraps(function)
    def call(*args: Any, **named: Any) -> Any:
        return made()(*args, **named)

    return call
