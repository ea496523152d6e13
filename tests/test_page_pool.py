"""Working processes of the page: they answer, wait in line, are ended, and one that dies is replaced."""

import asyncio
import json
import os
import signal
from collections.abc import Callable, Coroutine, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from pages import PAPER, look

from mckibben.page.looks import Looks
from mckibben.page.pool import BusyError, Pool, Process, Tell
from mckibben.page.session import Session
from mckibben.page.tasks import TaskError

pytestmark = pytest.mark.page


def silent(name: str, part: str) -> None:
    pass


class Slow:
    """Does nothing until it is told to."""

    started = 0

    def __init__(self) -> None:
        self.free = asyncio.Event()
        self.stopped = False

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        Slow.started += 1
        await self.free.wait()
        return json.dumps(task)

    async def stop(self) -> None:
        self.stopped = True


def run(work: Callable[[], Coroutine[Any, Any, None]]) -> None:
    asyncio.run(work())


def test_a_process_does_tasks_and_is_replaced_when_it_dies() -> None:
    async def work() -> None:
        process = Process()
        told = json.loads(await process.ask("open", PAPER, silent))
        assert told["name"] == "paper"
        with pytest.raises(TaskError, match='did you mean "paper"'):
            await process.ask("open", {"from": {"preset": "papre"}}, silent)
        with pytest.raises(TaskError, match="something went wrong inside"):
            await process.ask("case", {}, silent)
        assert process._process is not None
        os.kill(process._process.pid, signal.SIGKILL)
        with pytest.raises(TaskError, match="try again"):
            await process.ask("open", PAPER, silent)
        assert json.loads(await process.ask("open", PAPER, silent))["name"] == "paper"
        await process.stop()
        await process.stop()

    run(work)


def test_a_flood_is_told_that_it_is_busy() -> None:
    async def work() -> None:
        workers: list[Slow] = []

        def new() -> Slow:
            workers.append(Slow())
            return workers[-1]

        pool = Pool(2, 3, 60.0, kind=new)
        asked = [asyncio.create_task(pool.ask(str(k), {}, silent)) for k in range(8)]
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert len(workers) == 2
        for worker in workers:
            worker.free.set()
        found = await asyncio.gather(*asked, return_exceptions=True)
        assert [one for one in found if isinstance(one, str)] == [f'"{k}"' for k in range(5)]
        assert sum(isinstance(one, BusyError) for one in found) == 3

    run(work)


def test_what_takes_too_long_is_ended() -> None:
    async def work() -> None:
        pool = Pool(1, 3, 0.01, kind=Slow)
        with pytest.raises(TaskError, match="given up after"):
            await pool.ask("x", {}, silent)
        assert pool._all[0].stopped  # type: ignore[attr-defined]

    run(work)


@pytest.mark.parametrize("ends", [True, False])
def test_a_task_that_nobody_waits_for(ends: bool) -> None:
    async def work() -> None:
        pool = Pool(1, 3, 60.0, ends=ends, kind=Slow)
        task = asyncio.create_task(pool.ask("x", {}, silent))
        for _ in range(5):
            await asyncio.sleep(0)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        worker: Any = pool._all[0]
        assert worker.stopped == ends  # a long one is ended, a short one goes on
        if not ends:
            worker.free.set()
            assert await pool.ask("y", {}, silent) == '"y"'
        await pool.stop()

    run(work)


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="the system does not tell the environment")
def test_temporary_files_of_a_process_lie_in_the_folder_of_the_page(tmp_path: Path) -> None:
    async def work() -> None:
        process = Process(lambda: str(tmp_path))
        await process.ask("open", PAPER, silent)
        assert process._process is not None
        environment = Path(f"/proc/{process._process.pid}/environ").read_bytes().split(b"\0")
        assert f"TMPDIR={tmp_path}".encode() in environment
        await process.stop()

    run(work)


class Kinds:
    """Looks as a process does them, whose functions are at hand once they were used."""

    seen: list[tuple[str, bool]]

    def __init__(self, name: str, log: list[tuple[str, bool]]) -> None:
        self.name, self.log, self.known = name, log, set[str]()

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        await asyncio.sleep(0)
        kind = f"{task} {said['muscle']}"
        self.log.append((self.name, said["first"]))
        if kind not in self.known and not said["first"]:
            return json.dumps({"prepare": kind}, separators=(",", ":"))
        self.known.add(kind)
        return '{"levels":[]}'

    async def stop(self) -> None:
        return None


def test_a_new_kind_of_muscle_is_prepared_beside() -> None:
    async def work() -> None:
        log: list[tuple[str, bool]] = []
        parts: list[str] = []
        states, curves, beside = (Pool(1, 9, 60.0, kind=partial(Kinds, name, log)) for name in ("s", "c", "beside"))
        looks = Looks(states, curves, beside)
        for _ in range(3):
            await looks.ask("look", {"muscle": "new"}, lambda name, part: parts.append(name))
        for name in ("s", "c"):
            assert [first for who, first in log if who == name] == [False, False, True, False]
        assert [first for who, first in log if who == "beside"] == [True, True]
        assert parts == ["preparing", "preparing", "state", "state", "state"]

    run(work)


def test_every_process_is_warm_once_several_people_look() -> None:
    async def work() -> None:
        log: list[tuple[str, bool]] = []
        made: list[Kinds] = []

        def new() -> Kinds:
            made.append(Kinds("p", log))
            return made[-1]

        states, curves, beside = (Pool(2, 9, 60.0, kind=new) for _ in range(3))
        looks = Looks(states, curves, beside)
        looks.warm({"muscle": "first"})
        for _ in range(9):
            await asyncio.sleep(0)
        assert [sorted(one.known) for one in made] == [["look first"], ["curves first"]]
        looks.warm_all()
        looks.warm_all()
        assert looks._all is not None
        await looks._all
        assert len(made) == 4
        assert all(one.known for one in made)

    run(work)


def test_a_session_ends_what_it_began() -> None:
    async def work() -> None:
        said: list[str] = []

        async def send(text: str) -> None:
            said.append(text)

        pool = Pool(1, 9, 60.0, ends=True, kind=Slow)
        session = Session(send, {"look": pool, "job": pool})
        await session.take(json.dumps({"id": 1, "task": "job", "said": {}}))
        for _ in range(5):
            await asyncio.sleep(0)
        await session.take(json.dumps({"id": 2, "task": "cancel", "said": {"of": 1}}))
        for _ in range(9):
            await asyncio.sleep(0)
        assert json.loads(said[-1]) == {"id": 1, "part": "cancelled", "data": None}
        for number in range(3, 10):
            await session.take(json.dumps({"id": number, "task": "job", "said": {}}))
        assert json.loads(said[-1])["part"] == "busy"
        await session.take(json.dumps({"id": 7, "task": "look", "said": look()}))
        await session.close()
        assert not session._tasks

    run(work)
