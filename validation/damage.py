"""Saved results and sweeps with a byte flipped, cut short, zeroed or lost: whether one loads with other content.

    python validation/damage.py [--copies 300] [--seed 1]

The figures go into validation/README.md.
"""

import argparse
import collections
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from textwrap import fill
from typing import Any

import environment  # noqa: F401  # first: it sets threads
import numpy as np
from sections import put
from summary import table

import mckibben as mk

KINDS = ("a byte changed", "cut short", "a block of zeros", "a file lost")
HEAD = ["what", "damage", "copies", "refused", "loads with the same content", "loads with other content", "crash"]


def damaged(data: bytes, kind: str, rng: np.random.Generator) -> bytes:
    """A copy of a file's bytes with one place damaged; the same bytes where zeros hit zeros."""
    at = int(rng.integers(len(data)))
    if kind == "cut short":
        return data[:at]
    if kind == "a byte changed":
        return data[:at] + bytes([data[at] ^ int(rng.integers(1, 256))]) + data[at + 1 :]
    end = min(len(data), at + int(rng.integers(1, 4097)))
    return data[:at] + bytes(end - at) + data[end:]


def outcome(load: Callable[[], Any], same: Callable[[Any], bool]) -> str:
    """What comes of loading a damaged copy, as a column of the table."""
    try:
        found = load()
    except mk.SpecError:
        return HEAD[3]
    except Exception:
        return HEAD[6]
    return HEAD[4] if same(found) else HEAD[5]


def results(folder: Path, copies: int, rng: np.random.Generator) -> tuple[list[list[Any]], str]:
    """Damage to a result, and how long it takes to save and load one."""
    curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar"))
    path, copy = folder / "whole.nc", folder / "copy.nc"
    saving, loading = timed(lambda: mk.save(curve, path, force=True)), timed(lambda: mk.load(path))
    whole, counted = path.read_bytes(), collections.Counter[tuple[str, str]]()
    for turn in range(copies):
        kind = KINDS[turn % 3]
        copy.write_bytes(damaged(whole, kind, rng))
        counted[kind, outcome(lambda: mk.load(copy), lambda found: bool(found == curve))] += 1
    times = f"a result of {len(curve)} states ({len(whole) / 1e3:.0f} kB) {1e3 * saving:.0f} and {1e3 * loading:.0f} ms"
    return rows("result (.nc)", counted), times


def sweeps(folder: Path, copies: int, rng: np.random.Generator) -> tuple[list[list[Any]], str]:
    """Damage to a store, and how long it takes to load one."""
    over = {"braid.angle": ["36 deg", "37 deg", "38 deg"], "braid.fibres": [40, 56]}
    test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
    path, copy = folder / "whole.zarr", folder / "copy.zarr"
    data = mk.sweep(mk.presets.paper(), test, over, to=path, workers=0, chunk=2).load()
    loading = timed(lambda: mk.load(path).load())
    files = sorted(file.relative_to(path) for file in path.rglob("*") if file.is_file())
    sizes = np.array([(path / file).stat().st_size for file in files], float)
    counted = collections.Counter[tuple[str, str]]()
    for turn in range(copies):
        kind = KINDS[turn % 4]
        shutil.copytree(path, copy)
        # Half of the files at random, half by their bytes, most of which are in the description.
        file = copy / files[rng.choice(len(files), p=sizes / sizes.sum() if turn % 8 < 4 else None)]
        if kind == KINDS[3]:
            file.unlink()
        else:
            file.write_bytes(damaged(file.read_bytes(), kind, rng))
        counted[kind, outcome(lambda: mk.load(copy).load(), lambda found: honest(found, data))] += 1
        shutil.rmtree(copy)
    bytes_in_all = f"{sizes.sum() / 1e3:.0f} kB in {len(files)} files"
    return rows(
        "sweep (.zarr)", counted
    ), f"a sweep of {data.status.size} designs ({bytes_in_all}) {1e3 * loading:.0f} ms"


def honest(found: Any, data: Any) -> bool:
    """Whether a sweep is as it was, but for designs that are said to be pending and hold nothing."""
    pending = found.status == -1
    return all(
        bool(((found[name] == data[name]) | (found[name].isnull() & data[name].isnull()) | pending).all())
        for name in data.variables
        if name not in data.coords
    ) and bool(found.force.where(pending).isnull().all() and found.attrs == data.attrs)


def rows(what: str, counted: collections.Counter[tuple[str, str]]) -> list[list[Any]]:
    lines = []
    for kind in dict.fromkeys(kind for kind in KINDS if any(kind == one for one, _ in counted)):
        numbers = [counted[kind, column] for column in HEAD[3:]]
        lines.append([what, kind, sum(numbers), *numbers])
    return lines


def timed(call: Callable[[], Any]) -> float:
    """Seconds of the fastest of five calls."""
    found = []
    for _ in range(5):
        start = time.perf_counter()
        call()
        found.append(time.perf_counter() - start)
    return min(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--copies", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    with tempfile.TemporaryDirectory() as folder:
        of_results, times = results(Path(folder), asked.copies, rng)
        of_sweeps, more = sweeps(Path(folder), asked.copies, rng)
    said = f"""Written by `python validation/damage.py --copies {asked.copies} --seed {asked.seed}`. One place of one
file is damaged in each copy. The same content: zeros where there were zeros, or designs called pending that hold
nothing. To save and to load {times}; to load {more}."""
    put("## Damaged files", ["", fill(said, 120), *table(HEAD, [*of_results, *of_sweeps])])
    print(*("  ".join(map(str, row)) for row in (HEAD, *of_results, *of_sweeps)), said, sep="\n")


if __name__ == "__main__":
    main()
