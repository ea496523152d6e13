"""JAX, imported when it is first used: a test whose compiled functions are all kept on the disk does without it.

`from .lazy import Array, jax, jnp` stands for `import jax`, `import jax.numpy as jnp` and `from jax import Array`.
Importing JAX takes longer than most tests, so nothing on their way may use it when a module is imported.
"""

import sys
import threading
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

__all__ = ["Array", "changed_settings", "configure", "imported", "jax", "jnp", "set_up"]

_lock = threading.RLock()
_waiting: list[Callable[[], object]] = []


def imported() -> bool:
    """Whether JAX is there, by whoever's doing: before that no value can be one of JAX's."""
    return "jax" in sys.modules


def set_up(action: Callable[[], object]) -> None:
    """Do something before the package uses JAX for the first time, or now if that was before."""
    with _lock:
        if not _ready:
            _waiting.append(action)
            if imported():  # who imported it may use it before the package does, and means the same arithmetic
                _load("jax")
            return
    action()


def configure(name: str, value: Any) -> None:
    """As `jax.config.update`, as soon as JAX is there."""
    if imported():
        import_module("jax").config.update(name, value)
    else:
        set_up(lambda: import_module("jax").config.update(name, value))


_ready = False
_pristine: dict[str, Any] = {}
"""Settings of JAX as the environment has them."""


def changed_settings() -> dict[str, Any]:
    """Settings that may not be what the environment says: those changed since, or all if others imported JAX."""
    with _lock:  # not while it is being imported
        now = import_module("jax").config.values if imported() else {}
    return {name: value for name, value in now.items() if name not in _pristine or _pristine[name] != value}


def _load(name: str) -> Any:
    """A module of JAX, once everything is set up that waited for it; all of it in 64 bits."""
    global _ready
    with _lock:
        if not _ready:
            first = not imported()
            config = import_module("jax").config
            config.update("jax_enable_x64", True)
            if first:
                _pristine.update(config.values)
            _ready = True
            while _waiting:
                _waiting.pop(0)()
    return import_module(name)


if TYPE_CHECKING:
    import jax
    import jax.numpy as jnp
    from jax import Array
else:

    class _Module:
        """Stands for a module until one of its names is asked for."""

        def __init__(self, name: str) -> None:
            self._name, self._found = name, None

        def __getattr__(self, asked: str) -> Any:
            if asked.startswith("__"):  # what tools look for in any object
                raise AttributeError(asked)
            if self._found is None:
                self._found = _load(self._name)
            return getattr(self._found, asked)

    Array = Any  # shapes and types are checked at run time, not whose array it is
    jax, jnp = _Module("jax"), _Module("jax.numpy")
