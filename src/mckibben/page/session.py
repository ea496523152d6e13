"""One browser's socket: messages in, answers out; the newest look wins, and nobody waits for another's long job."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Mapping
from typing import Any

from mckibben.page.pool import BusyError, Tasks
from mckibben.page.tasks import TaskError

__all__ = ["LONGEST", "RubbishError", "Session", "read"]

LONGEST = 100_000
"""Characters of a message at most; a muscle has some thousand."""
AT_ONCE = 6
"""Tasks of one browser under way at the same time, beside its look."""
LOOK = "look"


class RubbishError(Exception):
    """A message that no page sends."""


def read(text: str) -> tuple[int, str, dict[str, Any]]:
    """The number, the task and what is said of a message. RubbishError for anything else."""
    if len(text) > LONGEST:
        raise RubbishError(f"a message of more than {LONGEST} characters")
    try:
        said = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise RubbishError("a message that is not JSON") from error
    known = isinstance(said, dict) and isinstance(said.get("task"), str) and isinstance(said.get("said"), dict)
    if not known or isinstance(said.get("id"), bool) or not isinstance(said.get("id"), int):
        raise RubbishError("a message without id, task and said")
    return said["id"], said["task"], said["said"]


def _no_number(word: str) -> Any:
    raise ValueError(word)


class Session:
    """What one browser has asked for.

    Args:
        send: sends a text to the browser.
        pools: who does each task, by its name.
    """

    def __init__(self, send: Any, pools: Mapping[str, Tasks]) -> None:
        self._send, self._pools = send, pools
        self._tasks: dict[int, asyncio.Task[None]] = {}
        self._newest: tuple[int, dict[str, Any]] | None = None
        self._looking: asyncio.Task[None] | None = None

    async def take(self, text: str) -> None:
        """Begin what a message asks for. RubbishError for one that no page sends."""
        number, task, said = read(text)
        if task == "cancel":
            self._cancel(said)
        elif task not in self._pools:
            raise RubbishError("a message with an unknown task")
        elif task == LOOK:
            self._newest = number, said
            if self._looking is None or self._looking.done():
                self._looking = asyncio.create_task(self._look())
        elif len(self._tasks) >= AT_ONCE:
            await self._send(_message(number, "busy", json.dumps("so much at once: wait for what is under way")))
        elif number not in self._tasks:
            work = asyncio.create_task(self._do(number, task, said))
            self._tasks[number] = work
            work.add_done_callback(lambda _: self._tasks.pop(number, None))

    def _cancel(self, said: dict[str, Any]) -> None:
        work = self._tasks.get(said["of"]) if isinstance(said.get("of"), int) else None
        if work is not None:
            work.cancel()

    async def _look(self) -> None:
        """Looks one after the other; those that a newer one has overtaken are left out."""
        while self._newest is not None:
            (number, said), self._newest = self._newest, None
            await self._do(number, LOOK, said)

    async def _do(self, number: int, task: str, said: dict[str, Any]) -> None:
        told: asyncio.Queue[str] = asyncio.Queue()
        sending = asyncio.create_task(self._tell(told))
        try:
            answer = await self._pools[task].ask(
                task, said, lambda name, part: told.put_nowait(_message(number, name, part))
            )
            told.put_nowait(_message(number, "done", answer))
        except TaskError as error:
            told.put_nowait(_message(number, "error", json.dumps(str(error))))
        except BusyError as error:
            told.put_nowait(_message(number, "busy", json.dumps(str(error))))
        except asyncio.CancelledError:
            told.put_nowait(_message(number, "cancelled", "null"))
        finally:
            told.put_nowait("")
            with contextlib.suppress(Exception):  # the browser may be gone
                await sending

    async def _tell(self, told: asyncio.Queue[str]) -> None:
        while text := await told.get():
            await self._send(text)

    async def close(self) -> None:
        """End all that is under way."""
        self._newest = None
        works = [*self._tasks.values(), *([] if self._looking is None else [self._looking])]
        for work in works:
            work.cancel()
        await asyncio.gather(*works, return_exceptions=True)


def _message(number: int, part: str, data: str) -> str:
    return f'{{"id":{number},"part":{json.dumps(part)},"data":{data}}}'
