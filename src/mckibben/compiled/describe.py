"""Text that stands for a value in every process, so that what was compiled for it can be found again."""

import collections
import enum
import sys
from typing import Any

import attrs
import jax
import numpy as np

__all__ = ["UnkeepableError", "describe", "describe_tree"]

_PACKAGE = __name__.partition(".")[0]
_CONTAINERS = (tuple, list, dict, type(None), collections.OrderedDict, collections.defaultdict)


class UnkeepableError(ValueError):
    """A value that no text identifies in another process, such as a user's function."""


def describe(value: Any) -> str:
    """The text for a static argument; UnkeepableError where there is none."""
    kind = type(value)
    if value is None or kind in (bool, int, float, complex, str, bytes):
        return repr(value)
    if kind in (tuple, list):
        return f"{kind.__name__}({', '.join(map(describe, value))})"
    if kind is dict:
        return f"dict({', '.join(f'{describe(key)}: {describe(part)}' for key, part in value.items())})"
    if isinstance(value, np.dtype):
        return f"dtype({value.descr if value.names else value.str})"
    if isinstance(value, np.generic) and not value.dtype.hasobject:
        return f"{value.dtype.str}({value.tobytes().hex()})"
    if isinstance(value, type) and value in _CONTAINERS:
        return _name(value)
    if _ours(kind):
        if isinstance(value, enum.Enum):
            return f"{_name(kind)}.{value.name}"
        if attrs.has(kind):
            parts = ", ".join(f"{field.name}={describe(getattr(value, field.name))}" for field in attrs.fields(kind))
            return f"{_name(kind)}({parts})"
        if isinstance(value, tuple):  # with names
            return f"{_name(kind)}({', '.join(map(describe, value))})"
    if _ours(value):
        return _name(value)
    raise UnkeepableError(f"{value!r} means nothing to another process")


def describe_tree(tree: "jax.tree_util.PyTreeDef") -> str:
    """The text for the structure of a pytree; UnkeepableError where a user's classes or values are part of it."""
    data = tree.node_data()
    if data is None:
        return "*"
    kind, static = data
    if kind not in _CONTAINERS and not _ours(kind):
        raise UnkeepableError(f"{kind!r} means nothing to another process")
    return f"{_name(kind)}[{describe(static)}]({', '.join(map(describe_tree, tree.children()))})"


def _name(value: Any) -> str:
    return f"{value.__module__}.{value.__qualname__}"


def _ours(value: Any) -> bool:
    """Whether it is a function or class of this package, whose source is part of every key."""
    module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", None)
    if not (isinstance(module, str) and isinstance(name, str) and module.partition(".")[0] == _PACKAGE):
        return False
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return found is value
