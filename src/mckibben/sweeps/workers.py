"""Chunks of a sweep on many processes and machines, by Dask.

Only a few chunks are under way at a time, so that memory does not grow with the sweep. Workers that die are replaced
and their chunks solved again; a chunk whose workers keep dying is tried once more with nothing else under way, because
it may have been in bad company, and then given up.
"""

from __future__ import annotations

import asyncio
import logging
import os
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import count
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from mckibben.processes import main_left_out
from mckibben.spec import SpecError
from mckibben.sweeps.outcome import Columns, Status, empty, refuse
from mckibben.sweeps.plan import Plan, versions
from mckibben.sweeps.trouble import SweepError
from mckibben.sweeps.worker import THREADS, work

if TYPE_CHECKING:
    from distributed import Client, Future

__all__ = ["ANY_PORT", "cores", "spread"]

DIED = "its worker process died every time it was solved (it may have run out of memory)"
ANY_PORT = "127.0.0.1:0"
"""Where a cluster of our own answers over HTTP: by default all of them want one port, on every network."""
DEATHS = 1
"""How often the worker of a chunk may die, on a cluster of our own, before the chunk is set apart."""


def cores() -> int:
    """Processor cores that this process may use."""
    from dask.system import CPU_COUNT

    return int(CPU_COUNT)


def spread(
    plan: Plan, missing: list[int], keep: Callable[[int, Columns], None], workers: int | None, scheduler: str | None
) -> None:
    """Solve the missing chunks on the workers of a scheduler, else of this machine; `keep` is called here with each.

    SweepError for a scheduler that does not answer or is lost; whatever `keep` raises ends the work too.
    """
    with _client(workers, scheduler) as client:
        _flow(client, plan, missing, keep)


@contextmanager
def _client(workers: int | None, scheduler: str | None) -> Iterator[Client]:
    import dask
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        if scheduler is not None:
            _reach(scheduler)
            yield stack.enter_context(Client(scheduler, set_as_default=False))
            return
        stack.enter_context(main_left_out())
        stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": DEATHS}))
        try:
            cluster = LocalCluster(
                n_workers=workers or cores(), threads_per_worker=1, processes=True, dashboard_address=ANY_PORT,
                scheduler_kwargs={"dashboard": False}, silence_logs=logging.CRITICAL, env=_environment(),
            )  # fmt: skip
        except (OSError, RuntimeError) as error:
            raise SweepError(f"the worker processes could not be started: {_line(error)}") from error
        stack.enter_context(cluster)
        yield stack.enter_context(Client(cluster, set_as_default=False))


def _reach(scheduler: str) -> None:
    """Try the address first: a Client that finds no scheduler goes on logging errors after it has failed."""
    from distributed.comm.core import connect

    async def attempt() -> None:
        await (await connect(scheduler)).close()

    try:
        asyncio.run(attempt())
    except (ValueError, TypeError) as error:
        said = "is no address of a scheduler"
        raise SpecError("scheduler", scheduler, said, "such as tcp://host:8786") from error
    except OSError as error:
        raise SweepError(f"no scheduler answers at {scheduler}: {_line(error)}") from error


def _environment() -> dict[str, str]:
    """What workers find in their environment: one thread each, and what was said of compiled functions."""
    said = ("MCKIBBEN_CACHE", "MCKIBBEN_COMPILE", "JAX_COMPILATION_CACHE_DIR")
    kept = {name: os.environ[name] for name in said if name in os.environ}
    return {name: os.environ.get(name, value) for name, value in (THREADS | kept).items()}


def _flow(client: Client, plan: Plan, missing: list[int], keep: Callable[[int, Columns], None]) -> None:
    """Send chunks and take in what comes back, in any order."""
    import cloudpickle
    from distributed import KilledWorker, as_completed

    base = cloudpickle.dumps((plan.muscle, plan.test))
    settings = (_environment(), versions())
    name, tries, coming = uuid4().hex[:8], count(), as_completed(loop=client.loop)
    under_way: dict[Future[Columns], int] = {}
    waiting, apart = deque(missing), deque[int]()

    def send(index: int) -> None:
        piece = plan.piece(index)
        rest = (piece.fields, piece.rows, piece.steps, piece.tolerance)
        # a new key for each try: a scheduler answers a key that it knows with what came of it before
        future = client.submit(work, base, rest, *settings, key=f"sweep-{name}-{index}-{next(tries)}", pure=False)
        under_way[future] = index
        coming.add(future)

    try:
        while waiting or under_way or apart:
            room = 2 * max(1, sum(client.nthreads().values())) - len(under_way)
            for _ in range(min(room, len(waiting))):
                send(waiting.popleft())
            alone = not under_way
            if alone:
                send(apart.popleft())
            future = next(coming)
            index = under_way.pop(future)
            if future.status == "finished":
                keep(index, future.result())
                continue
            if future.status != "error":
                raise SweepError(_lost(client))
            error = future.exception()
            if isinstance(error, SweepError):
                raise error
            if not isinstance(error, KilledWorker):
                keep(index, _given_up(plan, index, _line(error)))
            elif alone:
                keep(index, _given_up(plan, index, DIED))
            else:
                apart.append(index)
    except OSError as error:
        raise SweepError(_lost(client)) from error


def _given_up(plan: Plan, index: int, reason: str) -> Columns:
    columns = empty(plan.size(index), plan.steps)
    for k in range(plan.size(index)):
        refuse(columns, k, Status.FAILED, reason)
    return columns


def _lost(client: Client) -> str:
    address = client.scheduler.address if client.scheduler is not None else "its address"
    return f"lost the scheduler at {address}; what is finished is kept, and the same sweep goes on from there"


def _line(error: Any) -> str:
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
