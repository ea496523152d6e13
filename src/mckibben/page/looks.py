"""Looks that follow the mouse: on processes that have at hand what they need; what is new is prepared by others."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from typing import Any

from mckibben.page.pool import Pool

__all__ = ["Looks"]

Tell = Callable[[str, str], None]


class Looks:
    """Looks at muscles, so that nobody waits for another's new kind of muscle.

    Functions are compiled anew for each kind of muscle: another law, fibres that stretch. That takes up to a minute
    once; a process beside does it, and those that follow the mouse read what it made. State and curves are sought at
    the same time.

    Args:
        states: processes that seek states.
        curves: processes that seek curves.
        beside: processes that do what takes longer.
    """

    def __init__(self, states: Pool, curves: Pool, beside: Pool) -> None:
        self._pools = {"look": states, "curves": curves}
        self._beside = beside
        self._prepared: dict[str, asyncio.Future[None]] = {}
        self._first: dict[str, Any] = {}
        self._warming: asyncio.Task[Any] | None = None
        self._all: asyncio.Task[Any] | None = None

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        """The curves of a look as JSON, as of `Pool.ask`; the state is told as soon as it is known."""
        if self._warming is not None and not self._warming.done():
            tell("preparing", "null")
            await asyncio.wait([self._warming])
        state = asyncio.ensure_future(self._one("look", said, tell))
        curves = asyncio.ensure_future(self._one("curves", said, tell))
        try:
            tell("state", await state)
            return await curves
        finally:  # the other one is of no use where one failed
            for one in (state, curves):
                one.cancel()
            await asyncio.gather(state, curves, return_exceptions=True)

    async def _one(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        answer = await self._pools[task].ask(task, dict(said) | {"first": False}, tell)
        if not answer.startswith('{"prepare":'):
            return answer
        kind, anew = json.loads(answer)["prepare"], dict(said) | {"first": True}
        if kind not in self._prepared:
            tell("preparing", "null")
            return await self._prepare(kind, task, anew, tell)
        if not self._prepared[kind].done():
            tell("preparing", "null")
        await asyncio.wait([self._prepared[kind]])
        return await self._pools[task].ask(task, anew, tell)

    async def _prepare(self, kind: str, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        self._prepared[kind] = asyncio.get_running_loop().create_future()
        try:
            return await self._beside.ask(task, said, tell)
        finally:
            self._prepared[kind].set_result(None)

    def warm(self, said: Mapping[str, Any]) -> None:
        """Begin to have at hand what a look needs, before somebody looks; looks wait for it."""
        self._first = dict(said) | {"first": True}
        self._warming = asyncio.create_task(self._warm(1))

    def warm_all(self) -> None:
        """Have it at hand in every process: more than one browser looks."""
        if self._all is None:
            self._all = asyncio.create_task(self._warm_all())

    async def _warm_all(self) -> None:
        if self._warming is not None:
            await asyncio.wait([self._warming])
            await self._warm(max(pool.count for pool in self._pools.values()))

    async def _warm(self, times: int) -> None:
        several = [
            one for one in self._pools.items() for _ in range(times)
        ]  # at once, or one process would do them all
        asked = [pool.ask(task, self._first, lambda name, part: None) for task, pool in several]
        await asyncio.gather(*asked, return_exceptions=True)
