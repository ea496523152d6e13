"""How cost grows: with unknowns, states, muscles in step, workers, and up to 100,000 designs; memory beside it."""

import os
import resource
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import batch
import jax
import numpy as np
import psutil
from curve import LONG, MUSCLE, problem
from timing import once, timed

import mckibben as mk
from mckibben.compiled import folder as cache
from mckibben.discretise.spectral import Line
from mckibben.solver.batch import march
from mckibben.solver.find import find
from mckibben.solver.follow import follow, padded
from mckibben.solver.held import Held, rows_of, targets_of

UNKNOWNS, STATES, TOGETHER = (8, 12, 16, 24, 32, 48, 64, 96), (6, 21, 101, 401), (1, 4, 16, 64)
COLD, DESIGNS = (1_000, 2), ((1_000, 1), (1_000, 2), (10_000, 1), (10_000, 2), (100_000, 2))
"""(designs, workers) of sweeps into a store."""


def following(unknowns: int, states: int) -> dict[str, Any]:
    """One curve of the compiled following."""
    on = problem(Line(unknowns))
    path = [Held.of(length=LONG, pressure=float(pressure)) for pressure in np.linspace(0.0, 1e5, states)]
    first = find(on, path[0])
    own, which = rows_of(path[0].names, on.loads)
    targets = padded(targets_of(path, on.unit, on.loads))
    count, close = np.asarray(states), np.asarray(1e-6)

    def call() -> Any:
        return jax.block_until_ready(follow((on.basis, own), on.p, on.b, first.state, which, targets, count, close))

    assert int(call().good) == states
    return {"unknowns": unknowns, "states": states, **timed(call, 9)}


def together() -> list[dict[str, Any]]:
    """Curves that advance in step, per curve."""
    (path,), rows = batch.captured(batch.designs(64))["march"], []
    basis, on, which, rest, targets, count, limit = path
    for size in TOGETHER:
        some = jax.tree.map(lambda leaf, size=size: leaf[:size], (on, rest, targets))
        times = timed(
            lambda some=some: jax.block_until_ready(march(basis, some[0], which, some[1], some[2], count, limit)), 9
        )
        rows.append({"muscles": size, **{k: v / size if k != "repeats" else v for k, v in times.items()}})
    return rows


def sweeping(designs: int, workers: int) -> dict[str, Any]:
    """A sweep into a store at 1e-4; memory is the most that this process has had so far, and any worker meanwhile."""
    over = {
        "braid.angle": {"from": "33 deg", "to": "41 deg", "points": designs // 50},
        "chamber.thickness": {"from": "0.6 mm", "to": "1.8 mm", "points": 50},
    }
    workers_mb = [0.0]

    def watch(done: int, total: int) -> None:
        for child in psutil.Process().children(recursive=True):
            with suppress(psutil.Error):  # it has ended
                workers_mb.append(child.memory_info().rss / 2**20)

    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "sweep.zarr"
        times, data = once(
            lambda: mk.sweep(
                MUSCLE, batch.TEST, over, tolerance=batch.TOLERANCE, to=store, workers=workers, watch=watch
            )
        )
        complete = float((data["status"].values == 0).mean())
        single = float((data["method"].values == 1).mean())
        size = sum(file.stat().st_size for file in store.rglob("*") if file.is_file())
    client = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {
        "designs": designs, "workers": workers, "designs_per_s": designs / times["median_s"], "complete": complete,
        "single": single, "store_mb": size / 2**20, "client_mb": client, "worker_mb": max(workers_mb), **times,
    }  # fmt: skip


def sweeps() -> list[dict[str, Any]]:
    """From the first on a new machine, whose workers compile, to the largest, which takes minutes."""
    before = os.environ.get("JAX_COMPILATION_CACHE_DIR")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["JAX_COMPILATION_CACHE_DIR"] = folder
        try:
            return [{"cold": not k, **sweeping(*size)} for k, size in enumerate((COLD, *DESIGNS))]
        finally:
            if before is None:
                del os.environ["JAX_COMPILATION_CACHE_DIR"]
            else:
                os.environ["JAX_COMPILATION_CACHE_DIR"] = before


def measure() -> dict[str, Any]:
    """Everything."""
    cache.ready()
    return {
        "unknowns": [following(unknowns, 21) for unknowns in UNKNOWNS],
        "states": [following(24, states) for states in STATES],
        "together": together(),
        "sweeps": sweeps(),
    }


def cluster(sweeps: list[dict[str, Any]], designs: float = 1e8) -> dict[str, float]:
    """What many designs would need, from the largest sweep here: core hours and bytes, nothing else counted."""
    last = sweeps[-1]
    per_core = last["designs_per_s"] / last["workers"]
    return {
        "designs": designs, "core_hours": designs / per_core / 3600.0,
        "store_tb": last["store_mb"] / last["designs"] * designs / 2**20,
        "hours_on_1000_cores": designs / per_core / 3600.0 / 1000.0,
        "mb_per_s_into_the_store_on_1000_cores": 1000.0 * per_core * last["store_mb"] / last["designs"],
    }  # fmt: skip
