"""Changing a case's mapping before it is read: keys merged over a preset, `--set` overrides.

Values are still plain TOML here and are not checked; `spec/text.py` does that afterwards.
"""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from mckibben.spec.change import changed_name, left_behind, still_assumed
from mckibben.spec.errors import SpecError

__all__ = ["apply_overrides", "check_depth", "merged", "too_deep"]

DEEPEST = 12
"""Tables and lists within each other in a case or sweep file: twice what any needs, and little enough to recurse."""
_SHALLOWER = f"at most {DEEPEST} are read"


def merged(base: Mapping[Any, Any], over: Mapping[Any, Any]) -> dict[Any, Any]:
    """The table of a muscle with the keys of `over` on top of those of `base`; what was overridden is not assumed.

    A law of another name replaces the law, stiffnesses (B1, B2, B3) a fibre's E and nu, diameters a chamber's
    thickness, a hardness a rubber's E, and the other way round: the keys of two kinds of law, fibre or chamber do not
    mix.
    """
    touched: list[str] = []
    result = _merged(base, over, "", touched)
    if "assumed" not in over:
        result["assumed"] = list(still_assumed(base.get("assumed", ()), touched))
    if touched and "name" not in over and base.get("name"):
        result["name"] = changed_name(base["name"])
    return result


def _merged(base: Mapping[Any, Any], over: Mapping[Any, Any], prefix: str, touched: list[str]) -> dict[Any, Any]:
    result = dict(base)
    for key in left_behind(over, prefix):
        result.pop(key, None)
    if "angle_from" in over and "angle" not in over:
        raise SpecError("braid.angle_from", over["angle_from"], "is given without an angle", "give the angle with it")
    for key, value in over.items():
        path = f"{prefix}{key}"
        inner = base.get(key)
        other_law = path == "chamber.law" and isinstance(value, Mapping) and "name" in value
        if other_law and isinstance(inner, Mapping) and value["name"] != inner.get("name"):
            inner = None
        if isinstance(inner, Mapping) and isinstance(value, Mapping):
            result[key] = _merged(inner, value, f"{path}.", touched)
        else:
            result[key] = value
            touched.append(path)
    return result


def check_depth(mapping: Any, name: str) -> None:
    """SpecError for tables and lists that lie so deep within each other that reading them would exhaust the stack."""
    level, depth = [mapping], 0
    while level:
        if depth > DEEPEST:
            raise too_deep(name)
        inner = [list(item.values()) if isinstance(item, Mapping) else item for item in level]
        level = [value for items in inner for value in items if isinstance(value, (Mapping, list))]
        depth += 1


def too_deep(name: str) -> SpecError:
    return SpecError(name, allowed="has too many tables or lists within each other", advice=_SHALLOWER)


def apply_overrides(
    mapping: Mapping[Any, Any], overrides: Iterable[str], tables: tuple[str, ...] = ("muscle", "test")
) -> dict[Any, Any]:
    """A case mapping with "dotted.name=value" texts put in: "braid.angle=36 deg", "test.pressure=0 to 2 bar".

    Names begin with one of `tables` ("muscle.", "test."); without any they are the muscle's. A value that is a TOML
    value (56, 0.4, true, [1, 2]) is taken as such, anything else as text. SpecError for a text without "=" or a name
    inside a value.
    """
    if not isinstance(mapping, Mapping):
        raise SpecError("case file", mapping, "must be a table")
    check_depth(mapping, "case file")
    result = copy.deepcopy(dict(mapping))
    for text in overrides:
        name, equals, value = str(text).partition("=")
        keys = [key.strip() for key in name.split(".")]
        if not equals or not all(keys):
            raise SpecError("override", text, "must be name=value", 'write it like "braid.angle=36 deg"')
        if len(keys) > DEEPEST:
            raise SpecError("override", text, f"names a table within {len(keys) - 1} others", _SHALLOWER)
        if keys[0] not in tables:
            keys = ["muscle", *keys]
        if len(keys) == 1:
            raise SpecError("override", text, f"must name a field of the {keys[0]}", 'such as "braid.angle=36 deg"')
        _put(result, keys, _toml_value(value.strip()), ".".join(keys))
    return result


def _toml_value(text: str) -> Any:
    try:
        read = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError):
        return text
    return read["value"] if len(read) == 1 else text  # a line break would have let in more keys


def _put(table: Any, keys: list[str], value: Any, name: str) -> None:
    key: Any = keys[0]
    if isinstance(table, list):
        if not key.isdecimal() or len(key) > 6 or int(key) >= len(table):
            advice = f"entries are 0 to {len(table) - 1}"
            raise SpecError(name, allowed=f'"{key}" is no entry of the list', advice=advice)
        key = int(key)
    elif not isinstance(table, dict):
        raise SpecError(name, allowed=f'there is no "{key}" inside a value', advice="override the value as a whole")
    if len(keys) == 1:
        other = {"length": "contraction", "contraction": "length"}.get(key)
        if name.startswith("test.") and isinstance(table, dict) and other in table:
            del table[other]  # one is given in place of the other
        table[key] = value
        return
    if isinstance(table, dict):
        table.setdefault(key, {})
    _put(table[key], keys[1:], value, name)
