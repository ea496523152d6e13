"""Reading a sweep file (TOML): a case with a table that says what varies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import attrs

from mckibben.files.case import dotted, read_mapping
from mckibben.spec.errors import SpecError, nearest
from mckibben.spec.text import Case, apply_overrides, from_mapping

__all__ = ["SweepCase", "read_sweep"]

_KEYS = ("over", "designs", "chunk")
_EXAMPLE = 'such as over = { "braid.angle" = ["30 deg", "36 deg"] }'


@attrs.frozen
class SweepCase:
    """What a sweep file says: the base case, and what `sweep` takes; `over` and `designs` are None without [sweep]."""

    case: Case
    over: dict[str, Any] | None = None
    designs: Path | None = None
    chunk: int | None = None


def read_sweep(path: str | PathLike[str], overrides: Iterable[str] = (), *, required: bool = True) -> SweepCase:
    """The sweep in the file at `path`, with "dotted.name=value" overrides of the base put in first.

    The table of designs is looked for beside the file. Without `required` any case will do. Raises SpecError, in one
    line, for a file that cannot be read or is not TOML, and for whatever is wrong in it; the values of the fields are
    for `sweep` to read.
    """
    mapping = read_mapping(path)
    if "free" in mapping:
        what = "design" if "objective" in mapping else "fit"
        raise SpecError(str(path), allowed=f"describes a {what}", advice=f"give it to mckibben {what}")
    if "sweep" not in mapping:
        if required:
            raise SpecError("sweep", allowed="is missing", advice=f"write a [sweep] table, {_EXAMPLE}")
        return SweepCase(from_mapping(apply_overrides(mapping, overrides), test_required=False))
    table = mapping.pop("sweep")
    case = from_mapping(apply_overrides(mapping, overrides))
    if not isinstance(table, Mapping):
        raise SpecError("sweep", table, "must be a table", "write [sweep] with its keys below")
    for key in table:
        if key not in _KEYS:
            raise SpecError(f"sweep.{key}", allowed="unknown key", advice=nearest(key, _KEYS))
    over, designs = table.get("over"), table.get("designs")
    if (over is None) == (designs is None):
        raise SpecError("sweep", allowed="must give either over or designs", advice=_EXAMPLE)
    if designs is not None and not isinstance(designs, str):
        raise SpecError("sweep.designs", designs, "must be the name of a CSV file")
    if over is not None and not isinstance(over, Mapping):
        raise SpecError("sweep.over", over, "must be a table", _EXAMPLE)
    listed = None if over is None else dict(dotted(over, "from"))
    return SweepCase(case, listed, None if designs is None else Path(path).parent / designs, table.get("chunk"))
