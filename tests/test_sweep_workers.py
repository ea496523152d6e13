"""Sweeps on worker processes that live, die and are killed: the numbers are always those of a quiet run."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import numpy as np
import psutil
import pytest
import xarray as xr
from distributed import Client, LocalCluster

import mckibben as mk
from mckibben.sweeps.worker import THREADS
from mckibben.sweeps.workers import ANY_PORT

pytestmark = pytest.mark.sweeps

MUSCLE = mk.presets.paper()
TEST = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
OVER = {"braid.angle": {"from": "34 deg", "to": "38 deg", "points": 9}}

ENVIRONMENT = THREADS | {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0"}


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """One worker, replaced when it dies; what it was at is set apart at the first death."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(
            n_workers=1, threads_per_worker=1, dashboard_address=ANY_PORT, silence_logs=50, env=ENVIRONMENT
        ) as made,
    ):
        yield made


@pytest.fixture(scope="module")
def quiet() -> xr.Dataset:
    """The sweep in this process."""
    return mk.sweep(MUSCLE, TEST, OVER, workers=0, chunk=2)


def same(data: xr.Dataset, expected: xr.Dataset) -> None:
    """Equal bit for bit."""
    for name, variable in expected.variables.items():
        if variable.dtype.kind in "fi":
            assert data[name].values.tobytes() == variable.values.tobytes(), name
        else:
            np.testing.assert_array_equal(data[name].values, variable.values)


def test_workers_do_not_change_bits_even_when_they_are_killed(cluster: LocalCluster, quiet: xr.Dataset) -> None:
    told: list[tuple[int, int]] = []

    def watch(done: int, total: int) -> None:
        told.append((done, total))
        if len(told) == 2:  # the first chunk has come in: more are under way
            os.kill(next(iter(cluster.workers.values())).process.pid, signal.SIGKILL)

    data = mk.sweep(MUSCLE, TEST, OVER, scheduler=cluster.scheduler_address, chunk=2, watch=watch)
    same(data, quiet)
    assert told[0] == (0, 9)
    assert told[-1] == (9, 9)
    assert len(told) == 6


def test_a_chunk_that_kills_its_workers_is_given_up_alone(
    cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[str] = []
    submit = Client.submit

    def noted(client: Client, *args: Any, key: str, **kwargs: Any) -> Any:
        sent.append(key)
        return submit(client, *args, key=key, **kwargs)

    monkeypatch.setattr(Client, "submit", noted)

    def deadly(l1: object, l2: object, l3: object, c: object) -> None:
        import os
        import signal

        os.kill(os.getpid(), signal.SIGKILL)

    sound = MUSCLE.chamber.law
    laws = [sound, mk.CustomLaw(function=deadly), sound]
    beyond = mk.Isometric(length="250 mm", pressure="0 to 1 bar", points=3)  # quick
    data = mk.sweep(MUSCLE, beyond, {"chamber.law": laws}, scheduler=cluster.scheduler_address, chunk=1)
    assert data.status.values.tolist() == [1, 3, 1]
    assert data.reason.values.tolist()[1].startswith("its worker process died every time it was solved")
    assert data.verdict.values.tolist() == [[3] * 3, [-1] * 3, [3] * 3]
    # each try is a task of its own: a scheduler answers a key that it knows with what came of it before
    assert len(sent) == len(set(sent)) > len(laws)


def test_a_lost_scheduler_is_said() -> None:
    call = [
        sys.executable,
        "-m",
        "distributed.cli.dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
    ]
    scheduler = subprocess.Popen(call, stderr=subprocess.PIPE, text=True)
    assert scheduler.stderr is not None
    address = next(word for line in scheduler.stderr for word in line.split() if word.startswith("tcp://"))
    drain = threading.Thread(target=scheduler.stderr.read)
    drain.start()
    killer = threading.Timer(2.0, scheduler.kill)
    killer.start()
    try:
        # it has no workers, so the sweep waits until it is lost
        with (
            dask.config.set({"distributed.comm.timeouts.connect": "1s"}),
            pytest.raises(mk.SweepError, match=f"lost the scheduler at {address}; what is finished is kept"),
        ):
            mk.sweep(MUSCLE, TEST, OVER, scheduler=address, chunk=2)
    finally:
        killer.join()
        scheduler.wait()
        drain.join()
        scheduler.stderr.close()


def test_no_scheduler() -> None:
    with (
        dask.config.set({"distributed.comm.timeouts.connect": "200ms"}),
        pytest.raises(mk.SweepError, match=r"no scheduler answers at tcp://127\.0\.0\.1:9"),
    ):
        mk.sweep(MUSCLE, TEST, OVER, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(mk.SpecError, match="is no address of a scheduler"):
        mk.sweep(MUSCLE, TEST, OVER, scheduler="head")
    with pytest.raises(mk.SpecError, match="either workers or scheduler"):
        mk.sweep(MUSCLE, TEST, OVER, scheduler="tcp://127.0.0.1:9", workers=1)


SCRIPT = """
import sys
import mckibben as mk

print("started", flush=True)  # once, although nothing guards the script
test = mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3)
over = {"braid.angle": {"from": "34 deg", "to": "38 deg", "points": 9}}
mk.sweep(mk.presets.paper(), test, over, to=sys.argv[1], workers=2, chunk=1)
"""


def content(store: Path) -> dict[str, bytes]:
    files = (file for file in store.rglob("*") if file.is_file() and file.name != "zarr.json")
    return {file.relative_to(store).as_posix(): file.read_bytes() for file in files if not file.name.startswith(".")}


def test_a_sweep_that_is_killed_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    store, script = tmp_path / "out.zarr", tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    call, environment = [sys.executable, str(script), str(store)], os.environ | ENVIRONMENT
    client = subprocess.Popen(call, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        while client.poll() is None and not list((store / "status").glob("c.*")):
            time.sleep(0.001)
        workers = psutil.Process(client.pid).children(recursive=True)
        assert len(workers) >= 2
    finally:
        client.kill()
        shown, _ = client.communicate()
    assert client.returncode == -signal.SIGKILL  # it was not done yet
    assert shown == "started\n"
    kept = {file.name: file.read_bytes() for file in (store / "status").glob("c.*")}
    assert 0 < len(kept) < 9
    _, alive = psutil.wait_procs(workers, timeout=20)
    assert not alive

    told: list[tuple[int, int]] = []
    options = {"workers": 0, "chunk": 1}
    mk.sweep(MUSCLE, TEST, OVER, to=store, watch=lambda *said: told.append(said), **options)
    assert told[0] == (len(kept), 9)
    mk.sweep(MUSCLE, TEST, OVER, to=tmp_path / "whole.zarr", **options)
    assert content(store) == content(tmp_path / "whole.zarr")
