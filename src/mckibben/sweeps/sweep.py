"""`sweep()`: one test on many muscles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from os import PathLike
from typing import Any

import jax
import xarray as xr

from mckibben.solver.bench import sizes_for
from mckibben.spec import Muscle, SpecError, Test
from mckibben.sweeps.chunk import solve_piece
from mckibben.sweeps.dataset import Memory
from mckibben.sweeps.outcome import Columns
from mckibben.sweeps.plan import Plan, plan
from mckibben.sweeps.store import Store
from mckibben.sweeps.workers import spread

__all__ = ["sweep"]

IN_MEMORY = 8_000_000_000
"""Most bytes of results that are kept without a store."""


def sweep(
    muscle: Muscle,
    test: Test,
    over: Mapping[str, Any] | None = None,
    *,
    designs: Any = None,
    tolerance: float = 1e-6,
    to: str | PathLike[str] | None = None,
    force: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk: int | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Run a test on many muscles: a full grid over some fields, or a table of designs.

    Args:
        muscle: what all designs have in common.
        test: the test that all are put to. Its fields may vary too ("test.length").
        over: field -> list of values, in SI or with units, or {"from": ..., "to": ..., "points": ...}. All
            combinations are run. A field is named as in `Muscle.replace`: "braid.angle", "chamber.law.c1".
        designs: instead of `over`, one design per row: a CSV file or a DataFrame whose column heads are fields, with
            the unit of their numbers in brackets ("braid.angle [deg]").
        tolerance: relative error aimed at in force and length, as for `run`.
        to: a Zarr store ("out.zarr") that results go to as they come. A store that holds part of the same sweep is
            gone on with; one that holds another sweep is refused.
        force: delete another sweep that is in the store.
        workers: processes on this machine; by default as many as there are cores if there is more than one chunk,
            and none where JAX finds a GPU. 0 for this process.
        scheduler: address of a Dask scheduler that is running already ("tcp://host:8786"), in place of `workers`.
        chunk: designs solved at a time, 512 by default.
        watch: called with (designs done, designs in all).

    Returns:
        A Dataset with a dimension for each field of `over` (or `design` for a table) and `step`; coordinates are in SI.
        `status` says how far each design came and `reason` why it is not complete. It is read from the store, if there
        is one, when used.

    Raises:
        SpecError: for an unknown field, a value out of range or too many designs (more than 10^8, or without a store
            more than 8 GB of results), before anything is solved. Values that are wrong only together do not end the
            sweep: the `status` of that design is "wrong input".
        SweepError: where a full disk or a lost scheduler ends the sweep. What is finished is in the store, and the same
            call goes on from there; so it does after Ctrl-C or a crash.

    >>> test = mk.Isometric(length="115 mm", pressure="1 bar")
    >>> data = mk.sweep(mk.presets.paper(), test, {"braid.angle": ["36 deg", "37 deg"]}, tolerance=1e-4)
    >>> data.force.isel(step=-1).values.round(2)  # N
    array([ 87.63, 101.22])
    """
    sizes_for("spectral", tolerance)
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 0):
        raise SpecError("workers", workers, "must be a whole number, at least 0")
    if workers is not None and scheduler is not None:
        raise SpecError("workers", workers, "is for this machine only", "give either workers or scheduler")
    wanted = plan(muscle, test, over, designs, tolerance=tolerance, chunk=chunk)
    if to is None and wanted.bytes > IN_MEMORY:
        said = f"{wanted.said}: too much to keep in memory"
        raise SpecError("sweep", allowed=said, advice='give a store, to="out.zarr"')
    keeper = Memory(wanted) if to is None else Store.of(to, wanted, force)
    _finish(wanted, keeper, workers, scheduler, watch or (lambda done, total: None))
    return keeper.dataset()


def _finish(
    wanted: Plan, keeper: Memory | Store, workers: int | None, scheduler: str | None, watch: Callable[[int, int], None]
) -> None:
    """Solve what is missing and keep it."""
    missing, total = keeper.missing, len(wanted)
    done = total - sum(wanted.size(index) for index in missing)

    def keep(index: int, columns: Columns) -> None:
        nonlocal done
        keeper.put(index, columns)
        done += wanted.size(index)
        watch(done, total)

    watch(done, total)
    if not missing:
        return
    alone = len(missing) == 1 or jax.default_backend() != "cpu"  # one process feeds a GPU; more would fight for it
    if scheduler is None and (workers == 0 or (workers is None and alone)):
        for index in missing:
            keep(index, solve_piece(wanted.piece(index), partial(_within, watch, done, total)))
    else:
        spread(wanted, missing, keep, workers, scheduler)


def _within(watch: Callable[[int, int], None], before: int, total: int, done: int) -> None:
    """Progress of one chunk as progress of the sweep."""
    watch(before + done, total)
