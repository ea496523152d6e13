"""Compiled functions: `@kernel` is `jax.jit` with the first argument static, and knows executables kept on the disk.

A kernel is read from the user's folder of compiled functions, or compiled and written to it. Inside `keeping(folder)`,
as the command line has it, kernels are compiled with the least optimisation: a single curve takes some milliseconds
more, and the first one several seconds less. A kernel that a search calls `often` is compiled for speed even there: a
target without a state then takes a third of the time.
"""

import functools
import inspect
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np

from mckibben.compiled import folder as folders
from mckibben.compiled import kept
from mckibben.compiled.describe import UnkeepableError, describe, describe_tree
from mckibben.compiled.executable import Executable, compiled, loaded, tracing
from mckibben.compiled.options import OPTIONS, QUICK, Options, usual
from mckibben.compiled.recent import forget, remember

__all__ = ["QUICK", "Kernel", "keeping", "kernel"]


class _Place(NamedTuple):
    """Where kernels are kept, if anywhere, and how they are compiled."""

    folder: Path | None
    options: tuple[tuple[str, Any], ...]


_FOR_SPEED = tuple(OPTIONS.items())

_place: _Place | None = None


@contextmanager
def keeping(folder: Path | None, options: Options = QUICK) -> Iterator[None]:
    """Keep kernels in a folder, if there is one and nobody else can write to it, and compile them so."""
    global _place
    safe = folder if folder is not None and folders.private(folder) else None
    before, _place = _place, _Place(safe, tuple(options.items()))
    try:
        yield
    finally:
        _place = before


@functools.cache
def _usual() -> _Place:
    """The user's folder."""
    return _Place(folders.ready(), tuple(usual().items()))


@functools.cache
def _ahead() -> ThreadPoolExecutor:
    """Who reads and compiles kernels before they are called."""
    return ThreadPoolExecutor(max_workers=2, thread_name_prefix="kernels")


_SCALARS = {kind: ((), np.dtype(kind)) for kind in (bool, int, float, complex)}


def _form(leaf: Any) -> tuple[tuple[int, ...], Any]:
    """Shape and type, as far as they make a difference to what is compiled."""
    known = _SCALARS.get(type(leaf))
    return known if known is not None else (leaf.shape, leaf.dtype)


class _Kind(NamedTuple):
    """One executable of a kernel."""

    place: _Place
    static: tuple[Any, ...]
    tree: Any
    forms: tuple[Any, ...]


class Kernel:
    """A function compiled for each set of static arguments, shapes and types; its other arguments are pytrees."""

    def __init__(self, function: Callable[..., Any], static: Sequence[int], named: Sequence[str], often: bool) -> None:
        functools.update_wrapper(self, function)
        self._often = often
        order = list(inspect.signature(function).parameters)
        self._function, self._positions = function, frozenset(static)
        self._names = frozenset([*named, *(order[i] for i in static)])
        self._inside: Any = jax.jit(function, static_argnums=tuple(static), static_argnames=tuple(named))
        self._known: dict[_Kind, Executable] = {}
        self._coming: dict[_Kind, Future[Executable]] = {}
        self._lock = threading.Lock()
        self._plain: dict[type, bool] = {}

    def __reduce__(self) -> str:
        return self._function.__qualname__  # a kernel is known by its module and name

    def __call__(self, *args: Any, **named: Any) -> Any:
        static, arrays = self._split(args, named)
        leaves, tree = jax.tree.flatten(arrays)
        if tracing.now or self._traced(leaves):
            return self._inside(*args, **named)
        kind = _Kind(self._where(), static, tree, tuple([_form(leaf) for leaf in leaves]))
        found = self._known.get(kind) or self._find(kind)
        try:
            return found(leaves)
        except (TypeError, ValueError, RuntimeError):
            if not found.ran:  # read, but not what it should be
                return self._anew(kind)(leaves)
            return self._inside(*args, **named)  # such as arrays that lie elsewhere

    def prepare(self, *args: Any, **named: Any) -> None:
        """Have the kernel read or compiled in the background; arrays count by shape alone."""
        static, arrays = self._split(args, named)
        leaves, tree = jax.tree.flatten(arrays)
        kind = _Kind(self._where(), static, tree, tuple(map(_form, leaves)))
        if kind not in self._known:
            _ahead().submit(self._find, kind)

    def lower(self, *args: Any, **named: Any) -> Any:
        """As of `jax.jit`."""
        return self._inside.lower(*args, **named)

    def clear_cache(self) -> None:
        """Forget what was compiled in this process."""
        self._inside.clear_cache()
        forget(self._known)

    def _cache_size(self) -> int:
        return self._inside._cache_size() + len(self._known)

    def _where(self) -> _Place:
        """Where it is kept now, and how it is compiled."""
        place = _place or _usual()
        return place._replace(options=_FOR_SPEED) if self._often else place

    def _split(self, args: tuple[Any, ...], named: dict[str, Any]) -> tuple[tuple[Any, ...], Any]:
        """Static arguments with their positions or names, and the others."""
        if not named and self._positions == {0}:
            return args[:1], (args[1:], {})
        fixed = [(i, one) for i, one in enumerate(args) if i in self._positions]
        words = [(name, named[name]) for name in sorted(named) if name in self._names]
        others = {name: one for name, one in named.items() if name not in self._names}
        return (*fixed, *words), ([one for i, one in enumerate(args) if i not in self._positions], others)

    def _joined(self, static: tuple[Any, ...], arrays: Any) -> Any:
        """The function's results on what `_split` gave."""
        rest, named = arrays
        if self._positions == {0} and isinstance(rest, tuple):
            return self._function(*static, *rest)
        args = list(rest)
        for where, one in static:  # positions come in their order
            if isinstance(where, int):
                args.insert(where, one)
        words = {where: one for where, one in static if isinstance(where, str)}
        return self._function(*args, **words, **named)

    def _traced(self, leaves: list[Any]) -> bool:
        """Whether another transformation is at work on any of them. That depends on their types alone."""
        for kind in {type(leaf) for leaf in leaves}:
            plain = self._plain.get(kind)
            if plain is None:
                plain = self._plain[kind] = not issubclass(kind, jax.core.Tracer)
            if not plain:
                return True
        return False

    def _find(self, kind: _Kind) -> Executable:
        """The executable, made once and waited for by others."""
        with self._lock:
            known, coming = self._known.get(kind), self._coming.get(kind)
            if known is None and coming is None:
                mine = self._coming[kind] = Future()
        if known is not None:
            return known
        if coming is not None:
            return coming.result()
        try:
            found = self._made(kind)
        except BaseException as error:
            mine.set_exception(error)
            raise
        else:
            remember(self._known, kind, found)
            mine.set_result(found)
            return found
        finally:
            with self._lock:
                self._coming.pop(kind, None)

    def _made(self, kind: _Kind) -> Executable:
        file = self._file(kind)
        content = None if file is None else kept.read(file)
        if file is not None and content is not None:
            with suppress(Exception):  # whatever another build of JAX does not like: it is compiled anew
                whose, *portable = content
                if whose == file.name:
                    return loaded(*portable)
        found = self._compile(kind)
        if file is not None:
            with suppress(Exception):  # not every device and program can be serialised
                kept.write(file, (file.name, *found.portable()))
        return found

    def _file(self, kind: _Kind) -> Path | None:
        if kind.place.folder is None:
            return None
        name = self._function.__name__.strip("_")
        try:
            static = describe(kind.static) + describe_tree(kind.tree)
        except UnkeepableError:
            return None
        whole = f"{self._function.__module__}.{self._function.__qualname__}"
        key = kept.key(whole, static, kind.forms, dict(kind.place.options))
        return kind.place.folder / f"{name}-{key}{folders.SUFFIX}"

    def _anew(self, kind: _Kind) -> Executable:
        """Compiled, in place of one that does not run."""
        file = self._file(kind)
        if file is not None:
            with suppress(OSError):
                file.unlink()
        forget(self._known, kind)
        return self._find(kind)

    def _compile(self, kind: _Kind) -> Executable:
        def flat(leaves: list[Any]) -> Any:
            return self._joined(kind.static, kind.tree.unflatten(leaves))

        return compiled(flat, self._function.__name__, kind.forms, dict(kind.place.options))


def kernel(
    function: Callable[..., Any],
    *,
    static_argnums: int | Sequence[int] = 0,
    static_argnames: Sequence[str] = (),
    often: bool = False,
) -> Kernel:
    """Compile a function: its static arguments are hashable, the others are pytrees of arrays and numbers.

    With its first argument static it is used as `@kernel`, otherwise as `@partial(kernel, static_argnums=(0, 1))`. One
    that is called `often` is always compiled for speed.
    """
    static = (static_argnums,) if isinstance(static_argnums, int) else tuple(static_argnums)
    return Kernel(function, static, tuple(static_argnames), often)
