"""Spec objects as JAX pytrees: their numbers are leaves, everything else is static.

So `jax.grad(lambda m: mk.response(m, test)["force"][-1])(muscle)` gives a muscle whose numbers are the derivatives. The
leaves of muscles and tests come in the order of `spec.numbers`; a rig has those of its signals too. Nothing is read or
checked when a tree is put together again, because JAX puts its own placeholders where numbers belong.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import attrs
import jax

from mckibben import spec
from mckibben.spec.custom import Constants

__all__ = ["made", "register"]

CHILDREN = (
    "quantity",
    "count",
    "quantities",
    "part",
    "path",
    "held",
    "steps",
    "constants",
    "signal",
    "value",
    "values",
)
"""Kinds of declared fields that hold numbers, directly or further down."""

Key = jax.tree_util.GetAttrKey


def made(cls: type, values: dict[str, Any]) -> Any:
    """An object of a spec class without its converters and checks."""
    new: Any = object.__new__(cls)
    for name, value in values.items():
        object.__setattr__(new, name, value)
    return new


def _leaf(value: Any, count: bool) -> Any:
    """A count as a float, since derivatives by integers are refused."""
    return float(value) if count and isinstance(value, int) else value


def _whole(value: Any, count: bool) -> Any:
    return int(value) if count and type(value) is float and value.is_integer() else value


def _register(cls: type) -> None:
    declared = {item.name: item for item in spec.describe(cls)}
    names = [field.name for field in attrs.fields(cls)]
    inner = [name for name in names if name in declared and _is_child(declared[name])]
    rest = [name for name in names if name not in inner]
    counts = [declared[name].kind == "count" for name in inner]

    def children(value: Any) -> list[Any]:
        return [_leaf(getattr(value, name), count) for name, count in zip(inner, counts, strict=True)]

    def aux(value: Any) -> tuple[Any, ...]:
        return tuple(getattr(value, name) for name in rest)

    def build(static: tuple[Any, ...], leaves: Any) -> Any:
        numbers = [_whole(leaf, count) for leaf, count in zip(leaves, counts, strict=True)]
        return made(cls, dict(zip(rest, static, strict=True)) | dict(zip(inner, numbers, strict=True)))

    def keyed(value: Any) -> tuple[list[tuple[Any, Any]], tuple[Any, ...]]:
        return [(Key(name), child) for name, child in zip(inner, children(value), strict=True)], aux(value)

    _add(cls, keyed, build, lambda value: (children(value), aux(value)))


def _is_child(declared: Any) -> bool:
    return declared.kind in CHILDREN and not declared.static


def _add(cls: type, keyed: Callable[..., Any], build: Callable[..., Any], flat: Callable[..., Any]) -> None:
    jax.tree_util.register_pytree_with_keys(cls, keyed, build, flat)


def _register_path() -> None:
    def keyed(path: spec.Path) -> Any:
        numbers = [(jax.tree_util.SequenceKey(k), number) for k, number in enumerate(path.waypoints)]
        return numbers, (path.mode, path.unit)

    def build(static: Any, leaves: Any) -> Any:
        mode, unit = static
        return made(spec.Path, {"waypoints": tuple(leaves), "mode": mode, "unit": unit})

    _add(spec.Path, keyed, build, lambda path: (path.waypoints, (path.mode, path.unit)))


def _register_constants() -> None:
    def keyed(constants: Constants) -> Any:
        return [(jax.tree_util.DictKey(name), constants[name]) for name in sorted(constants)], tuple(sorted(constants))

    def flat(constants: Constants) -> Any:
        return [constants[name] for name in sorted(constants)], tuple(sorted(constants))

    _add(Constants, keyed, lambda names, leaves: Constants(dict(zip(names, leaves, strict=True))), flat)


@cache
def register() -> None:
    """Make every spec class a pytree; once, before JAX is given any of their objects."""
    for cls in spec.spec_classes():
        _register(cls)
    _register_path()
    _register_constants()
