"""Reading a fit file (TOML): a muscle, measured data, and what `fit` takes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from mckibben.data.branches import LOADING, UNKNOWN, UNLOADING
from mckibben.data.read import read_data
from mckibben.data.values import Data
from mckibben.files.case import dotted, read_mapping
from mckibben.spec import Muscle
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.merge import apply_overrides
from mckibben.spec.text import from_mapping

__all__ = ["FitCase", "read_fit"]

_TABLES = ("muscle", "data", "free", "priors", "offsets", "weights", "options")
_EXAMPLES = {
    "data": 'such as file = "bench.csv"', "free": 'such as "braid.angle" = "30 deg to 40 deg"',
    "muscle": 'such as preset = "paper"',
}  # fmt: skip
"""Tables that must be there, and a line of each."""
_WORDS = (str, "text")
_TEXTS = (list, "a list of texts")
_NAMED = (Mapping, "a table")
_FLAG = (bool, "true or false")
_WHOLE = (int, "a whole number")
_NUMBER = (float, "a number")
_SIZE = (float, "a number or text with a unit")
_DATA = {
    "file": (_WORDS, _TEXTS), "columns": (_NAMED,), "units": (_NAMED,), "held": (_NAMED,), "reverse": (_WORDS, _TEXTS),
    "absolute": (_FLAG,), "atmosphere": (_WORDS, _SIZE), "tests": (_WORDS,), "sheet": (_WORDS, _WHOLE),
    "header": (_WHOLE,), "decimal": (_WORDS,), "only": (_WORDS, _TEXTS), "branch": (_WORDS,), "points": (_WHOLE,),
    "set": (_NAMED,),
}  # fmt: skip
"""Keys of [data]: those of `read_data`, which points are used, and what of the muscle is another for these."""
_CHOICE = ("only", "branch", "points")
_OPTIONS = {
    "loss": (_WORDS,), "force_error": (_WORDS, _SIZE), "starts": (_WHOLE,), "level": (_NUMBER,), "profiles": (_FLAG,),
    "tolerance": (_NUMBER,),
}  # fmt: skip
_RANGES = {"starts": (1, 1000), "tolerance": (1e-10, 1e-2)}


@attrs.frozen
class FitCase:
    """What a fit file says: the muscle, the points that are used, and the other arguments of `fit`."""

    muscle: Muscle | tuple[Muscle, ...]  #: one for all data, or one for each of them
    data: Data | tuple[Data, ...]
    free: dict[str, Any]
    options: dict[str, Any]  #: priors, offsets, weights, loss, ... where the file gives them


def read_fit(path: str | PathLike[str], overrides: Iterable[str] = ()) -> FitCase:
    """The fit in the file at `path`, whose data are one table or several ([[data]]).

    Overrides "dotted.name=value" are put in first: "options.starts=1".

    Names are the muscle's unless they begin with another table's. Files of data are looked for beside the file.
    SpecError, in one line, for a file that cannot be read or is not TOML, and for whatever is wrong in it or in the
    data; ranges, priors and the like are for `fit` to read.
    """
    mapping = apply_overrides(read_mapping(path), overrides, _TABLES)
    for name in mapping:
        if name not in _TABLES:
            raise SpecError(str(name), allowed="unknown key", advice=nearest(str(name), _TABLES))
    for name, line in _EXAMPLES.items():
        if name not in mapping:
            raise SpecError(name, allowed="is missing", advice=f"write a [{name}] table, {line}")
    for name, table in mapping.items():
        if not (isinstance(table, Mapping) or (name == "data" and _is_tables(table))):
            raise SpecError(name, table, "must be a table", f"write [{name}] with its keys below")
    muscle = from_mapping({"muscle": mapping["muscle"]}, test_required=False).muscle
    named = {name: dict(dotted(mapping[name])) for name in ("free", "priors", "offsets") if name in mapping}
    options = {**named, **_checked("options", mapping.get("options", {}), _OPTIONS)}
    for name, (low, high) in _RANGES.items():
        if not low <= options.get(name, low) <= high:
            raise SpecError(f"options.{name}", options[name], f"must be from {low:g} to {high:g}")
    if "weights" in mapping:
        options["weights"] = {str(test): _weight(str(test), value) for test, value in mapping["weights"].items()}
    free = options.pop("free")
    folder, given = Path(path).parent, mapping["data"]
    if isinstance(given, Mapping):
        return FitCase(*_measured("data", given, muscle, folder), free, options)
    found = [_measured(f"data[{k}]", table, muscle, folder) for k, table in enumerate(given)]
    muscles, data = zip(*found, strict=True)
    return FitCase(muscle if all(one == muscle for one in muscles) else muscles, data, free, options)


def _is_tables(given: Any) -> bool:
    return isinstance(given, list) and bool(given) and all(isinstance(one, Mapping) for one in given)


def _measured(name: str, given: Mapping[str, Any], muscle: Muscle, folder: Path) -> tuple[Muscle, Data]:
    """The muscle of one [data] table, with what `set` changes, and its points."""
    table = _checked(name, given, _DATA)
    for field, value in dotted(table.pop("set", {})):
        muscle = muscle.replace(field, value)
    try:
        return muscle, _data(table, folder)
    except SpecError as error:
        raise error.renamed(error.field.replace("data", name, 1)) from error


def _checked(name: str, table: Mapping[str, Any], known: Mapping[str, tuple[tuple[type, str], ...]]) -> dict[str, Any]:
    """The keys of a table; SpecError for one that is unknown, or of another kind than it takes."""
    for key, value in table.items():
        if key not in known:
            raise SpecError(f"{name}.{key}", allowed="unknown key", advice=nearest(str(key), known))
        if not any(_is(value, kind) for kind, _ in known[key]):
            raise SpecError(f"{name}.{key}", value, "must be " + " or ".join(said for _, said in known[key]))
    return dict(table)


def _is(value: Any, kind: type) -> bool:
    if isinstance(value, bool) or kind is bool:
        return isinstance(value, bool) and kind is bool
    if kind is list:
        return isinstance(value, list) and bool(value) and all(isinstance(one, str) for one in value)
    return isinstance(value, (int, float) if kind is float else kind)


def _weight(test: str, value: Any) -> float:
    if not _is(value, float):
        raise SpecError(f"weights.{test}", value, "must be a number", "1 is the weight of every other test")
    return float(value)


def _data(table: dict[str, Any], folder: Path) -> Data:
    """The points that are used: of the tests and the branch asked for, fewer where they are many."""
    if "file" not in table:
        raise SpecError("data.file", allowed="is missing", advice='such as file = "bench.csv"')
    file = table.pop("file")
    chosen = {name: table.pop(name, None) for name in _CHOICE}
    data = read_data(folder / file if isinstance(file, str) else [folder / one for one in file], **table)
    if chosen["only"] is not None:
        names = [chosen["only"]] if isinstance(chosen["only"], str) else chosen["only"]
        for name in names:
            if name not in data.tests:
                raise SpecError("data.only", name, "is no test of these data", nearest(name, data.tests))
        data = data.where(np.isin(data.which, [data.tests.index(name) for name in names]))
    if chosen["branch"] is not None:
        branches = (LOADING, UNLOADING, UNKNOWN)
        if chosen["branch"] not in branches:
            advice = nearest(chosen["branch"], branches)
            raise SpecError("data.branch", chosen["branch"], "must be one of " + ", ".join(branches), advice)
        there = ", ".join(dict.fromkeys(data.branches.tolist()))
        data = data.branch(chosen["branch"])
        if not len(data):
            raise SpecError("data.branch", chosen["branch"], "has no points", f"there are: {there}")
    if chosen["points"] is not None:
        try:
            data = data.decimated(chosen["points"])
        except SpecError as error:
            raise error.renamed("data.points") from error
    return data
