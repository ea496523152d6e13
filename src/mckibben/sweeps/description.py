"""The description of a store: everything but the results. Written, read, and known to be as written.

Digests (SHA-256) of its files are an attribute of the store, beside the digest of the attributes and arrays themselves.
"""

from __future__ import annotations

import json
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import zarr

from mckibben import disk
from mckibben.spec.errors import SpecError
from mckibben.sweeps.chunkfiles import digest
from mckibben.sweeps.dataset import about, coordinates
from mckibben.sweeps.outcome import DESIGN, STATES, Kept
from mckibben.sweeps.plan import Plan

__all__ = ["DIGESTS", "check_same", "damage", "describe", "mend", "sweep_in"]

DIGESTS = "sha256"
"""The attribute."""
_ROOT = "zarr.json"
_KEYS: dict[str, Any] = {"name": "default", "separator": "."}
"""Chunk files lie side by side in the folder of their array: force/c.3.0."""


def describe(path: Path, plan: Plan, date: str = "") -> None:
    """A store without results: the arrays, what each field is in each design, and the attributes."""
    count, steps = len(plan), plan.steps
    fields = " ".join(varied.field for varied in plan.varied)  # this is how xarray knows them for coordinates
    said = about(plan) | {"coordinates": fields} | ({"date": date} if date else {})
    group = zarr.create_group(path, zarr_format=3, attributes=said)
    for name, (dim, values, attributes) in coordinates(plan).items():
        kind = "str" if values.dtype.kind in "UO" else str(values.dtype)
        chunks = (min(max(plan.chunk, 2**14), max(len(values), 1)),)
        made = _made(group, name, Kept(kind, attributes), values.shape, chunks, (dim,))
        made[:] = values.astype(object) if kind == "str" else values
    for name, kept in STATES.items():
        _made(group, name, kept, (count, steps), (plan.chunk, steps), ("design", "step"))
    for name, kept in DESIGN.items():
        _made(group, name, kept, (count,), (plan.chunk,), ("design",))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        zarr.consolidate_metadata(path, zarr_format=3)
    document = json.loads((path / _ROOT).read_bytes())
    document["attributes"][DIGESTS] = _digests(path, document)
    (path / _ROOT).write_text(json.dumps(document, indent=2), encoding="utf-8")


def _made(
    group: zarr.Group, name: str, kept: Kept, shape: tuple[int, ...], chunks: tuple[int, ...], dims: tuple[str, ...]
) -> Any:
    """One array. Its chunks are not compressed: the last digits of numbers do not shrink, and writing is simple."""
    return group.create_array(
        name, shape=shape, chunks=chunks, dtype=kept.dtype, fill_value=kept.fill, dimension_names=dims,
        attributes=kept.attributes, chunk_key_encoding=_KEYS, compressors=None,
    )  # fmt: skip


def _digests(path: Path, document: dict[str, Any]) -> dict[str, str]:
    """Digests of the files of a store without results, and of what the first of them says beside this."""
    files = sorted(file for file in path.rglob("*") if file.is_file() and file != path / _ROOT)
    found = {file.relative_to(path).as_posix(): digest(file.read_bytes()) for file in files}
    return {_ROOT: _own(document), **found}


def _own(document: dict[str, Any]) -> str:
    attributes = {key: value for key, value in document["attributes"].items() if key != DIGESTS}
    return digest(json.dumps(document | {"attributes": attributes}, sort_keys=True).encode())


def damage(path: Path, document: dict[str, Any]) -> list[str]:
    """The files of the description that are not as written; none for a store from before there were digests."""
    noted = document["attributes"].get(DIGESTS, {})
    if not isinstance(noted, dict):
        return [_ROOT]
    wrong = [_ROOT] if noted and noted.get(_ROOT) != _own(document) else []
    for name, wanted in noted.items():
        if name != _ROOT:
            try:
                found = digest((path / name).read_bytes())
            except (OSError, ValueError):
                found = ""
            wrong += [name] if found != wanted else []
    return wrong


def mend(path: Path, plan: Plan, date: str) -> None:
    """Write the description of a store again, over the damaged one; the results stay. OSError."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "store"
        describe(made, plan, date)
        files = sorted(file.relative_to(made) for file in made.rglob("*") if file.is_file())
        for name in [*(file for file in files if str(file) != _ROOT), Path(_ROOT)]:  # the digests last
            (path / name).parent.mkdir(exist_ok=True)
            disk.replace(path / name, (made / name).read_bytes(), alone=True)


def sweep_in(path: Path, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the sweep in a store depends on, and all that its description says.

    SpecError, in one line, where there is no description of a sweep that can be read.
    """
    try:
        document = json.loads((path / _ROOT).read_bytes())
        held: dict[str, Any] = json.loads(document["attributes"]["sweep"])
        if not isinstance(held, dict):
            raise TypeError("is no table")
    except OSError as error:
        raise SpecError(name, allowed=f"cannot be read: {error.strerror or error}") from error
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise SpecError(name, allowed="is no store of a sweep of mckibben, or its zarr.json is damaged") from error
    return held, document


def check_same(name: str, there: dict[str, Any], here: dict[str, Any]) -> None:
    """SpecError that says what differs, unless the sweep in a store is the one that is asked for."""
    here = json.loads(json.dumps(here))  # as it reads back
    if there == here:
        return
    then, now = dict(_leaves(there)), dict(_leaves(here))
    differing = [key for key in {**now, **then} if then.get(key) != now.get(key)]
    key = differing[0] if differing else "its form"
    said = f"holds another sweep: {key} is {_brief(then.get(key))} there and {_brief(now.get(key))} here"
    more = f" ({len(differing)} differences)" if len(differing) > 1 else ""
    raise SpecError(name, allowed=said + more, advice="give another name, or --force to delete it (force=True)")


def _leaves(value: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, f"{prefix}.{key}" if prefix else key)
    else:
        yield prefix, value


def _brief(value: Any) -> str:
    text = "not given" if value is None else json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
