"""Reading a case file (TOML) that may have a table of tolerances."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any

import attrs

from mckibben.files.case import dotted, read_mapping
from mckibben.spec.errors import SpecError
from mckibben.spec.text import Case, apply_overrides, from_mapping

__all__ = ["ToleranceCase", "read_tolerances"]


@attrs.frozen
class ToleranceCase:
    """What such a file says: the case, and the tolerances by the names of the numbers."""

    case: Case
    vary: dict[str, Any]


def read_tolerances(path: str | PathLike[str], overrides: Iterable[str] = ()) -> ToleranceCase:
    """The case in the file at `path`, with "dotted.name=value" overrides put in first, and its [tolerances].

    SpecError, in one line, for a file that cannot be read or is not TOML, and for whatever is wrong in it; the
    tolerances are for `tolerances` to read.
    """
    mapping = read_mapping(path)
    table = mapping.pop("tolerances", {})
    if not isinstance(table, Mapping):
        raise SpecError("tolerances", table, "must be a table", 'write [tolerances], and "braid.angle" = "1 deg" below')
    return ToleranceCase(from_mapping(apply_overrides(mapping, overrides)), dict(dotted(table)))
