"""TOML mapping <-> rig: tables for its parts, those of several kinds by their `kind`."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import attrs
import tomli_w

from mckibben.spec.air import AIRS, Supply, Valve
from mckibben.spec.controls import CONTROLS, Controller
from mckibben.spec.declared import describe
from mckibben.spec.errors import MISSING, SpecError, nearest
from mckibben.spec.loads import LOADS, Viscosity
from mckibben.spec.muscle import Muscle
from mckibben.spec.rig import Rig
from mckibben.spec.signals import SIGNALS
from mckibben.spec.text import muscle_from_mapping, to_mapping

__all__ = ["rig_from_mapping", "rig_to_mapping", "rig_to_toml"]

_KINDS: dict[str, dict[str, type]] = {
    "load": LOADS, "air": AIRS, "command": SIGNALS | CONTROLS, "antagonist_command": SIGNALS | CONTROLS,
    "push": SIGNALS, "torque": SIGNALS, "duty": SIGNALS, "target": SIGNALS,
}  # fmt: skip
"""Parts that are one of several classes, which `kind` tells."""
_PARTS: dict[str, type] = {
    "supply": Supply, "valve": Valve, "antagonist_valve": Valve, "viscosity": Viscosity, "muscle": Muscle,
    "antagonist": Muscle,
}  # fmt: skip


def rig_from_mapping(mapping: Mapping[str, Any]) -> Rig:
    """The rig of a mapping as tomllib gives it. SpecError names the field of whatever is wrong."""
    if "muscle" not in mapping:
        raise SpecError("muscle", allowed="is missing", advice="write a [muscle] table")
    if "load" not in mapping:
        raise SpecError("load", allowed="is missing", advice='write [load] with kind = "fixed", "load" or "pulley"')
    made: Rig = _build(Rig, mapping, "rig")
    return made


def _build(cls: type, mapping: Mapping[str, Any], field: str) -> Any:
    known = tuple(item.name for item in describe(cls))
    values: dict[str, Any] = {}
    for name, value in mapping.items():
        dotted = str(name) if cls is Rig else f"{field}.{name}"
        if name not in known:
            raise SpecError(dotted, allowed="unknown key", advice=nearest(str(name), known))
        values[name] = _part(name, value, dotted)
    for item in describe(cls):
        if item.required and item.name not in values:
            raise SpecError(
                f"{field}.{item.name}", allowed=f"is missing: {item.meaning}", advice=f"add it to [{field}]"
            )
    try:
        return cls(**values)
    except SpecError as error:
        own: str = cls.__spec_path__  # type: ignore[attr-defined]
        if cls is Rig or not error.field.startswith(own):
            raise
        raise error.renamed(field + error.field.removeprefix(own)) from error


def _part(name: str, value: Any, field: str) -> Any:
    """A value as the constructor takes it: tables are built here."""
    if not isinstance(value, Mapping):
        if name in _PARTS or name in ("load", "air"):
            raise SpecError(field, value, "must be a table", f"write [{field}] with its keys below")
        return value
    if name in ("muscle", "antagonist"):
        try:
            return muscle_from_mapping(value)
        except SpecError as error:
            raise error.renamed(f"{name}.{error.field}" if name == "antagonist" else error.field) from error
    if name in _PARTS:
        return _build(_PARTS[name], value, field)
    if name not in _KINDS:
        raise SpecError(field, value, "must be a value, not a table")
    rest = dict(value)
    kind = rest.pop("kind", MISSING)
    options = _KINDS[name]
    if kind is MISSING:
        raise SpecError(f"{field}.kind", allowed="is missing", advice=f"choose from {', '.join(options)}")
    if kind not in options:
        raise SpecError(f"{field}.kind", kind, "is unknown", nearest(str(kind), options))
    if options[kind] is Controller:
        said = "is a Python function, which no file holds"
        raise SpecError(f"{field}.kind", kind, said, "build the rig in Python, or use a pid")
    return _build(options[kind], rest, field)


def rig_to_mapping(rig: Rig, *, allow_function: bool = False) -> dict[str, Any]:
    """The mapping that reads back as the rig; of a controller, with `allow_function`, only its name is kept."""
    return _written(rig, allow_function)


def rig_to_toml(rig: Rig, *, allow_function: bool = False) -> str:
    """TOML text of `rig_to_mapping`."""
    return tomli_w.dumps(rig_to_mapping(rig, allow_function=allow_function))


def _written(value: Any, allow_function: bool) -> dict[str, Any]:
    table: dict[str, Any] = {"kind": value.kind} if hasattr(type(value), "kind") else {}
    for item in describe(type(value)):
        held = getattr(value, item.name)
        if held is None or not item.mentioned(held):
            continue
        table[item.name] = _plain(held, allow_function)
    return table


def _plain(held: Any, allow_function: bool) -> Any:
    if isinstance(held, Muscle):
        return to_mapping(held, allow_custom=allow_function)
    if attrs.has(type(held)):
        return _written(held, allow_function)
    if isinstance(held, StrEnum):
        return str(held)
    if isinstance(held, tuple):
        return list(held)
    if callable(held):
        if not allow_function:
            said = "is a Python function, which no file holds"
            raise SpecError("controller.function", allowed=said, advice="use a pid to keep the rig in a file")
        return f"{getattr(held, '__module__', '?')}.{getattr(held, '__qualname__', '?')}"
    return held
