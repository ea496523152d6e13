"""Working processes of a page: so many at once, so many tasks that wait, and an end to those that take too long."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from mckibben.page.tasks import TaskError

__all__ = ["BusyError", "Pool", "Process", "Tasks", "Working"]

LINE = 2**26
"""Bytes of an answer at most."""
Tell = Callable[[str, str], None]


class BusyError(Exception):
    """Too many tasks wait already."""


@runtime_checkable
class Working(Protocol):
    """What does tasks one after the other."""

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        """Do a task: the answer as JSON, its parts told as they come. TaskError where it could not be done."""
        ...

    async def stop(self) -> None:
        """End it, and what it does."""
        ...


@runtime_checkable
class Tasks(Protocol):
    """Where tasks can be handed in."""

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        """As of `Working`; BusyError where too many wait."""
        ...


class Process:
    """A process that does tasks. Its temporary files lie in a folder, which is asked for when it starts."""

    def __init__(self, folder: Callable[[], str] = lambda: "") -> None:
        self._folder = folder
        self._process: asyncio.subprocess.Process | None = None

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        """Do a task. TaskError for one that could not be done, also where the process ends."""
        process = self._process or await self._started()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps({"task": task, "said": said}).encode() + b"\n")
            await process.stdin.drain()
            while line := (await process.stdout.readline()).decode():
                kind, text = line[0], line[1:].rstrip("\n")
                if kind == "d":
                    return text
                if kind == "e":
                    raise TaskError(json.loads(text))
                if kind == "f":
                    raise TaskError("something went wrong inside; the terminal of the page says what")
                tell(*text.split(" ", 1))
        except (OSError, ValueError) as error:
            raise TaskError("the answer was lost; try again") from error
        await self.stop()
        raise TaskError("what was at work ended unexpectedly; try again")

    async def _started(self) -> asyncio.subprocess.Process:
        source = str(Path(__file__).parents[2])
        paths = [source, *filter(None, [os.environ.get("PYTHONPATH")])]
        own = {"PYTHONPATH": os.pathsep.join(paths)}
        if place := self._folder():
            own |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), place)
        self._process = await asyncio.create_subprocess_exec(
            sys.executable, "-P", "-m", "mckibben.page.worker", stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            limit=LINE, env=os.environ | own, start_new_session=True,
        )  # fmt: skip
        return self._process

    async def stop(self) -> None:
        """End the process at once; the next task starts another."""
        process, self._process = self._process, None
        if process is None:
            return
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        if process.stdin is not None:
            process.stdin.close()
        await process.wait()


class Pool:
    """Tasks on some processes.

    Args:
        count: processes at most, each started when it is needed.
        waiting: tasks that may wait; BusyError for more.
        limit: seconds after which a task is ended.
        ends: whether a task that nobody waits for any longer is ended with its process. Short ones are not.
        kind: what does the tasks.
    """

    def __init__(
        self, count: int, waiting: int, limit: float, ends: bool = False, kind: Callable[[], Working] = Process
    ) -> None:
        self.count = count
        self._room = asyncio.Semaphore(count)
        self._most, self._waiting, self._limit, self._ends, self._kind = waiting, 0, limit, ends, kind
        self._free: list[Working] = []
        self._all: list[Working] = []
        self._left: set[asyncio.Task[str]] = set()

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        """Do a task when a process is free: its answer as JSON. TaskError or BusyError where it was not done."""
        if self._ends:
            return await self._done(task, said, tell)
        work = asyncio.ensure_future(self._done(task, said, tell))
        self._left.add(work)
        work.add_done_callback(self._over)
        return await asyncio.shield(work)

    def _over(self, work: asyncio.Task[str]) -> None:
        self._left.discard(work)
        if not work.cancelled():
            work.exception()  # nobody may be left to hear of it

    async def _done(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        if self._room.locked() and self._waiting >= self._most:
            raise BusyError("too many people are at work: try again in a moment")
        self._waiting += 1
        try:
            await self._room.acquire()
        finally:
            self._waiting -= 1
        try:
            worker = self._free.pop() if self._free else self._new()
            try:
                return await self._within(worker, task, said, tell)
            finally:
                self._free.append(worker)
        finally:
            self._room.release()

    async def _within(self, worker: Working, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        try:
            async with asyncio.timeout(self._limit):
                return await worker.ask(task, said, tell)
        except TimeoutError as error:
            await worker.stop()
            raise TaskError(f"given up after {self._limit:.0f} s") from error
        except asyncio.CancelledError:
            await worker.stop()
            raise

    def _new(self) -> Working:
        worker = self._kind()
        self._all.append(worker)
        return worker

    async def stop(self) -> None:
        """End all processes, and what they do."""
        for work in list(self._left):
            work.cancel()
        await asyncio.gather(*self._left, return_exceptions=True)
        for worker in self._all:
            await worker.stop()
