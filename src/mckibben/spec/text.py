"""TOML mapping <-> spec, derived from the declared fields.

A case file has a [muscle] table and a [test] table. Numbers are SI floats or text with a unit. What is written reads
back equal: floats are written exactly. A test goes by its `kind`, a law by its `name`.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import attrs
import tomli_w

from mckibben.spec import presets
from mckibben.spec.contraction import DECLARED as CONTRACTION
from mckibben.spec.contraction import takes_it
from mckibben.spec.custom import CustomLaw
from mckibben.spec.declared import Declared, describe, in_own_words
from mckibben.spec.errors import MISSING, SpecError, nearest
from mckibben.spec.laws import LAWS
from mckibben.spec.loading import TESTS, Step, Test
from mckibben.spec.merge import apply_overrides, merged
from mckibben.spec.muscle import Muscle
from mckibben.spec.path import Path
from mckibben.spec.plausible import as_text

__all__ = [
    "Case",
    "apply_overrides",
    "build",
    "from_mapping",
    "muscle_from_mapping",
    "part_from_plain",
    "plain",
    "test_from_mapping",
    "to_mapping",
    "to_toml",
]


@attrs.frozen
class Case:
    """What a case file says: a muscle and, where there is one, the test to make on it."""

    muscle: Muscle
    test: Test | None = None


def from_mapping(mapping: Any, *, test_required: bool = True) -> Case:
    """The case of a mapping as tomllib gives it. SpecError names the dotted field of whatever is wrong."""
    table = _table(mapping, "case file")
    _known(table, ("muscle", "test"), "")
    if "muscle" not in table:
        raise SpecError("muscle", allowed="is missing", advice="write a [muscle] table")
    if "test" not in table and test_required:
        raise SpecError("test", allowed="is missing", advice='write a [test] table, such as kind = "isometric"')
    muscle = muscle_from_mapping(table["muscle"])
    return Case(muscle, test_from_mapping(table["test"]) if "test" in table else None)


def muscle_from_mapping(mapping: Any) -> Muscle:
    """A muscle from its table; `preset = "paper"` starts from that preset and merges the other keys on top."""
    table = dict(_table(mapping, "muscle", "muscle"))
    _known(table, ("preset", *(item.name for item in describe(Muscle))), "muscle")
    if "preset" in table:
        name = table.pop("preset")
        if not isinstance(name, str):
            raise SpecError("muscle.preset", name, "must be a name", f"choose from {', '.join(presets.names())}")
        table = merged(to_mapping(presets.get(name)), table)
    muscle: Muscle = build(Muscle, table, "muscle", "muscle")
    return muscle


def test_from_mapping(mapping: Any) -> Test:
    """A test from its table, by its `kind`."""
    table = dict(_table(mapping, "test", "test"))
    kind = _name(table, "kind", "test", TESTS)
    test: Test = build(TESTS[kind], table, "test", "test")
    return test


def part_from_plain(item: Declared, value: Any, owner: str) -> Any:
    """A part of a muscle (its law, its fibre) from its table. `owner` is the field that holds the part ("chamber")."""
    if isinstance(value, item.parts) or (value is None and item.default is None):
        return value
    return _value(item, value, owner, "muscle" if owner == "muscle" else f"muscle.{owner}")


test_from_mapping.__test__ = False  # type: ignore[attr-defined]  # not a test for pytest to collect


def _table(value: Any, field: str, file_path: str = "") -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        advice = f"write [{file_path}] with its keys below" if file_path else ""
        raise SpecError(field, value, "must be a table", advice)
    for key in value:
        if not isinstance(key, str):
            raise SpecError(field, key, "must have text as keys")
    return value


def _known(table: Mapping[str, Any], options: tuple[str, ...], prefix: str) -> None:
    for key in table:
        if key not in options:
            dotted = f"{prefix}.{key}" if prefix else str(key)
            advice = nearest(str(key), options)
            raise SpecError(dotted, allowed="unknown key", advice=advice)


def _name(table: dict[str, Any], key: str, field: str, options: Mapping[str, type]) -> str:
    """Take the word that names the class from a table: a `kind` or `name` among `options`."""
    name = table.pop(key, MISSING)
    known = ", ".join(options)
    if name is MISSING:
        raise SpecError(f"{field}.{key}", allowed="is missing", advice=f"choose from {known}")
    if not isinstance(name, str):
        raise SpecError(f"{field}.{key}", name, "must be a name", f"choose from {known}")
    if name not in options:
        raise SpecError(f"{field}.{key}", name, "is unknown", nearest(name, options))
    return name


def build(cls: type, mapping: Any, field: str, file_path: str) -> Any:
    """An object of a spec class from its table. `field` is its name in errors, as `Muscle.replace` takes it."""
    table = _table(mapping, field, file_path)
    declared = {item.name: item for item in describe(cls)}
    if takes_it(cls):
        declared["contraction"] = CONTRACTION
    _known(table, tuple(declared), file_path)
    instead = {"length"} if "contraction" in table else {"contraction"}
    missing = [name for name, item in declared.items() if item.required and name not in {*table, *instead}]
    if missing:
        said = f"is missing: {declared[missing[0]].meaning}"
        raise SpecError(f"{field}.{missing[0]}", allowed=said, advice=f"add it to [{file_path}]")
    values = {name: _value(declared[name], value, field, file_path) for name, value in table.items()}
    try:
        return cls(**values)
    except SpecError as error:
        own: str = cls.__spec_path__  # type: ignore[attr-defined]
        raise error.renamed(field + error.field.removeprefix(own)) from error


def _value(item: Declared, value: Any, field: str, file_path: str) -> Any:
    """A value as the constructor takes it: parts and steps are built here, the rest is read by the field itself."""
    inner = item.name if field == "muscle" else f"{field}.{item.name}"
    if item.kind == "steps":
        if not isinstance(value, (list, tuple)):
            raise SpecError(inner, value, "must be a list of tables", "write [[test.steps]] for each")
        return [build(Step, step, f"{inner}[{i}]", f"{file_path}.{item.name}[{i}]") for i, step in enumerate(value)]
    if item.kind != "part":
        return value
    if value == "none" and item.default is None:
        return None
    if len(item.parts) == 1:
        return build(item.parts[0], value, inner, f"{file_path}.{item.name}")
    table = dict(_table(value, inner, f"{file_path}.{item.name}"))
    name = _name(table, "name", inner, LAWS)
    if name == CustomLaw.name:
        said = "a law of your own is a Python function and cannot be read from a file"
        raise SpecError(inner, allowed=said, advice="build the muscle in Python")
    return build(LAWS[name], table, inner, f"{file_path}.{item.name}")


def to_mapping(value: Case | Muscle | Test, *, allow_custom: bool = False) -> dict[str, Any]:
    """The mapping that reads back as `value`: of a case both tables, of a muscle or a test its own.

    A CustomLaw cannot be written (SpecError) unless `allow_custom`: then its name and constants are recorded.
    """
    if isinstance(value, Case):
        tables = {"muscle": to_mapping(value.muscle, allow_custom=allow_custom)}
        return tables if value.test is None else tables | {"test": to_mapping(value.test)}
    mapping = {} if isinstance(value, Muscle) else {"kind": value.kind}
    return mapping | _written(value, allow_custom)


def to_toml(value: Case | Muscle | Test, *, allow_custom: bool = False) -> str:
    """TOML text of `to_mapping`."""
    return tomli_w.dumps(to_mapping(value, allow_custom=allow_custom))


def plain(value: Any) -> Any:
    """The value of a field as TOML that reads back equal. Of a CustomLaw only names and constants are kept."""
    if value is None:
        return "none"
    if isinstance(value, CustomLaw):
        return _custom(value, allowed=True)
    if isinstance(value, Path):
        return value.to_plain()
    if isinstance(value, StrEnum):
        return str(value)
    if isinstance(value, tuple):
        return [plain(entry) for entry in value]
    if not attrs.has(type(value)):
        return value
    lead = {"name": value.name} if type(value) in LAWS.values() else {}
    return lead | _written(value, allow_custom=True)


def _written(value: Any, allow_custom: bool) -> dict[str, Any]:
    table = {}
    own = in_own_words(value)
    for item in describe(type(value)):
        held = own.get(item.name)
        if held is None or (item.kind == "names" and not held):
            continue
        name = held.called(item.name) if isinstance(held, Path) else item.name
        table[name] = _plain(item, held, allow_custom)
    return table


def _plain(item: Declared, held: Any, allow_custom: bool) -> Any:
    if isinstance(held, CustomLaw):
        return _custom(held, allow_custom)
    if item.kind == "part":
        lead = {"name": held.name} if len(item.parts) > 1 else {}
        return lead | _written(held, allow_custom)
    if item.kind == "steps":
        return [_written(step, allow_custom) for step in held]
    if isinstance(held, Path):
        return held.to_plain()
    if isinstance(held, StrEnum):
        return str(held)
    if isinstance(held, tuple):
        return [entry if isinstance(entry, str) else float(entry) for entry in held]
    return as_text(float(held), item.unit, item.doubt) if item.kind == "quantity" else held


def _custom(law: CustomLaw, allowed: bool) -> dict[str, Any]:
    if not allowed:
        said = "a law of your own is a Python function and cannot be written to a file"
        raise SpecError("chamber.law", allowed=said, advice="choose one of the named laws to keep the muscle in a file")
    function = f"{getattr(law.function, '__module__', '?')}.{getattr(law.function, '__qualname__', '?')}"
    constants = {name: float(number) for name, number in law.constants.items()}
    return {"name": law.name, "function": function, "constants": constants}
