"""The fields that a sweep varies and the values they take, read from what the user gave."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from os import PathLike, fspath
from typing import Any

import attrs
import numpy as np

from mckibben.spec import Muscle, Path, PathMode, SpecError, Test
from mckibben.spec.declared import Declared
from mckibben.spec.plausible import trusted
from mckibben.spec.text import plain
from mckibben.spec.vary import declared_at, full_name, read
from mckibben.units import is_traced

__all__ = ["Varied", "from_lists", "from_table"]

_HEAD = re.compile(r"\s*([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?\s*")
_RANGE = {"from", "to", "points"}
MOST = 10_000_000
"""Most values of one field."""


@attrs.frozen
class Varied:
    """One field and its values, read and checked: SI floats, whole numbers, words, paths or parts."""

    field: str
    values: tuple[Any, ...]
    unit: str  #: SI unit, "" where the values are no numbers
    meaning: str
    measured_from: str = ""  #: of an angle: "parallels", "axis", or the field that says which

    @property
    def plain(self) -> list[Any]:
        """The values as exact TOML values."""
        return [plain(value) for value in self.values]

    @property
    def coordinate(self) -> np.ndarray:
        """The values as a coordinate: SI numbers where all of them are, else text."""
        shown = [_shown(value) for value in self.values]
        if all(isinstance(value, int) for value in shown):
            return np.array(shown, np.int64)
        if all(isinstance(value, (int, float)) for value in shown):
            return np.array(shown, np.float64)
        return np.array([value if isinstance(value, str) else repr(value) for value in shown])

    @property
    def about(self) -> dict[str, str]:
        """Attributes of the coordinate."""
        number = self.coordinate.dtype.kind in "if"
        measured = {"measured_from": self.measured_from} if self.measured_from else {}
        return {"long_name": self.meaning} | ({"units": self.unit or "1"} if number else {}) | measured


def _shown(value: Any) -> Any:
    if isinstance(value, Path):
        return float(value.waypoints[0]) if value.mode == PathMode.CONSTANT else str(value)
    if isinstance(value, (int, float)):
        return value
    return "none" if value is None else str(value)


def from_lists(muscle: Muscle, test: Test, over: Mapping[str, Any]) -> tuple[Varied, ...]:
    """Fields with a list of values each. SpecError for an unknown field, no list, or a value that cannot be.

    A list is any sequence or array, of numbers in SI, texts with a unit or quantities, or a table that says
    `{"from": "30 deg", "to": "50 deg", "points": 21}`.
    """
    if not isinstance(over, Mapping) or not over:
        raise SpecError("over", over, "must name at least one field", 'such as {"braid.angle": ["30 deg", "36 deg"]}')
    return _checked(muscle, [_varied(muscle, test, str(name), values) for name, values in over.items()])


def _varied(muscle: Muscle, test: Test, name: str, given: Any) -> Varied:
    declared = declared_at(muscle, test, name)
    if isinstance(given, Mapping) and set(given) & _RANGE and declared.kind != "part":
        between = _range(name, declared, given)
        with trusted():  # its ends were read
            return _of(name, declared, between, f"over.{name}")
    if hasattr(given, "magnitude") and np.ndim(given.magnitude) == 1:
        given = [item * given.units for item in given.magnitude]
    if isinstance(given, (str, bytes, Mapping)) or not hasattr(given, "__iter__"):
        raise SpecError(f"over.{name}", given, "must be a list of values", "also where it is only one")
    return _of(name, declared, list(given), f"over.{name}")


def _of(name: str, declared: Declared, given: list[Any], where: str) -> Varied:
    if not given:
        raise SpecError(where, allowed="must hold at least one value")
    values = tuple(_read(name, declared, item, f"{where}[{k}]") for k, item in enumerate(given))
    unit = declared.unit if declared.kind in ("quantity", "path", "held") else ""
    return Varied(full_name(name), values, unit, declared.meaning)


def _read(name: str, declared: Declared, item: Any, where: str) -> Any:
    if is_traced(item):  # a JAX number; one that is being differentiated cannot be swept over, and JAX says so
        item = np.asarray(item).item()
    elif isinstance(item, np.generic):
        item = item.item()
    try:
        return read(name, declared, item)
    except SpecError as error:
        raise error.renamed(f"{where} ({error.field})" if error.field != full_name(name) else where) from error


def _range(name: str, declared: Declared, given: Mapping[str, Any]) -> list[Any]:
    points = given.get("points")
    if isinstance(points, int) and points > MOST:
        raise SpecError(f"over.{name}.points", points, f"must be at most {MOST:,}")
    if set(given) != _RANGE or not isinstance(points, int) or isinstance(points, bool) or points < 2:
        said = "must give from, to and points (a whole number, at least 2)"
        raise SpecError(f"over.{name}", dict(given), said, 'such as { from = "30 deg", to = "50 deg", points = 21 }')
    if declared.kind not in ("quantity", "count", "path", "held"):
        raise SpecError(f"over.{name}", dict(given), "is no number, so it has no range", "list the values")
    ends = (_shown(_read(name, declared, given[end], f"over.{name}.{end}")) for end in ("from", "to"))
    first, last = (float(end) if not isinstance(end, str) else np.nan for end in ends)
    if np.isnan(first + last):
        raise SpecError(f"over.{name}", dict(given), "must go from one number to another")
    values: list[float] = np.linspace(first, last, points).tolist()
    return values


def _checked(muscle: Muscle, found: list[Varied]) -> tuple[Varied, ...]:
    """The fields, none of them twice, and an angle with what it is measured from."""
    names = [varied.field for varied in found]
    for name in names:
        if names.count(name) > 1:
            raise SpecError(name, allowed="is given twice")
    if "braid.angle" not in names:
        return tuple(found)
    says = [name for name in ("braid.angle_from", "braid") if name in names]
    measured = says[0] if says else str(muscle.braid.measured_from)
    meaning = "braid angle theta0, measured from the " + (f"one that {measured} says" if says else measured)
    angle = found[names.index("braid.angle")]
    found[names.index("braid.angle")] = attrs.evolve(angle, meaning=meaning, measured_from=measured)
    return tuple(found)


def from_table(muscle: Muscle, test: Test, designs: Any) -> tuple[Varied, ...]:
    """One design per row of a CSV file (its path) or a table with named columns (pandas.DataFrame, mapping of columns).

    A column's head is a field, with the unit of its numbers in brackets: "braid.angle [deg]". Numbers without are SI.
    SpecError names the column and row (the first is 1) of whatever is wrong.
    """
    columns = _csv(designs) if isinstance(designs, (str, PathLike)) else _columns(designs)
    found = []
    for head, given in columns:
        match = _HEAD.fullmatch(" ".join(head.split()))  # single spaces: many take it a time without end
        if match is None:
            raise SpecError("designs", head, "is no head of a column", 'such as "braid.angle [deg]"')
        name, unit = match.group(1), match.group(2)
        declared = declared_at(muscle, test, name)
        items = [_with_unit(item, unit) for item in given]
        values = tuple(_read(name, declared, item, f"{name} in row {k + 1}") for k, item in enumerate(items))
        kind = declared.unit if declared.kind in ("quantity", "path", "held") else ""
        found.append(Varied(full_name(name), values, kind, declared.meaning))
    if not found or not found[0].values:
        raise SpecError("designs", allowed="holds no designs", advice="give one row for each, below the heads")
    return _checked(muscle, found)


def _with_unit(item: Any, unit: str | None) -> Any:
    if isinstance(item, np.generic):
        item = item.item()
    if not unit or unit == "1" or isinstance(item, bool):
        return item
    if isinstance(item, str) and item[-1:].isdigit():  # "0 to 2" below the head "test.pressure [bar]"
        return f"{item} {unit}"
    return f"{item!r} {unit}" if isinstance(item, (int, float)) and item == item else item


def _columns(designs: Any) -> Iterator[tuple[str, list[Any]]]:
    if not hasattr(designs, "keys") or not hasattr(designs, "__getitem__"):
        raise SpecError("designs", designs, "must be a CSV file or a table with named columns, such as a DataFrame")
    lengths = {str(head): len(designs[head]) for head in designs.keys()}  # noqa: SIM118  # a DataFrame too
    if len(set(lengths.values())) > 1:
        raise SpecError("designs", lengths, "must have columns of one length")
    for head in designs.keys():  # noqa: SIM118
        column = designs[head]
        if getattr(column, "ndim", 1) != 1:
            raise SpecError("designs", str(head), "is the head of two columns")
        yield str(head), list(column)


def _csv(path: str | PathLike[str]) -> list[tuple[str, list[Any]]]:
    name = fspath(path)
    try:
        with open(path, encoding="utf-8-sig", newline="") as stream:
            lines = [line for line in stream if not line.lstrip().startswith("#")]
        separator = ";" if ";" in next(filter(str.strip, lines), "") else ","  # spreadsheets where "," is decimal
        rows = [row for row in csv.reader(lines, delimiter=separator) if any(cell.strip() for cell in row)]
    except FileNotFoundError as error:
        raise SpecError(name, allowed="there is no such file") from error
    except OSError as error:
        raise SpecError(name, allowed=f"cannot be read: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error, ValueError) as error:
        raise SpecError(name, allowed="is no CSV table", advice="save it as CSV in UTF-8, with commas") from error
    if not rows:
        raise SpecError(name, allowed="is empty", advice='the first line names the fields: "braid.angle [deg],ends"')
    for k, row in enumerate(rows[1:]):
        if len(row) != len(rows[0]):
            raise SpecError(name, allowed=f"row {k + 1} has {len(row)} cells, the heads are {len(rows[0])}")
    return [(head, [_cell(row[k]) for row in rows[1:]]) for k, head in enumerate(rows[0])]


def _cell(text: str) -> Any:
    """A cell's text, as a number where it is one."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text.strip()
