"""What a page holds while it is served: its processes, its folder, measured files."""

from __future__ import annotations

import asyncio
import contextlib
import os
import tempfile
from collections.abc import AsyncIterator, Callable, Mapping
from typing import Any

from mckibben.page.kept import Kept, WithData
from mckibben.page.looks import Looks
from mckibben.page.pool import Pool, Process, Tasks, Working

__all__ = ["Page"]

START = {"pressure": 1e5, "hold": "force", "value": 0.0, "top": 1e5}
"""What is looked at before somebody asks, so that what it takes is at hand."""


class Page:
    """A page as it is served: the muscle it begins with, its processes, its folder, how many look at it."""

    def __init__(self, start: Mapping[str, Any], kind: Callable[[], Working] | None = None) -> None:
        self.start = dict(start)
        self.folder = ""
        kind = kind or (lambda: Process(lambda: self.folder))
        at_once = max(2, min(4, (os.cpu_count() or 1) // 2))
        self.states, self.curves = (Pool(at_once, 64, 120.0, kind=kind) for _ in range(2))
        self.beside = Pool(2, 16, 600.0, kind=kind)
        self.jobs = Pool(2, 8, 3600.0, ends=True, kind=kind)
        self.kept = Kept()
        self.looks = Looks(self.states, self.curves, self.beside)
        self.tasks: dict[str, Tasks] = {
            "look": self.looks, "open": self.states, "reach": self.beside, "effects": self.jobs, "design": self.jobs,
            "beside": self.looks, "measured": WithData(self.beside, self.kept), "fit": WithData(self.jobs, self.kept),
        }  # fmt: skip
        self.people = 0

    @contextlib.asynccontextmanager
    async def served(self, app: Any) -> AsyncIterator[None]:
        """While the page is served."""
        with tempfile.TemporaryDirectory(prefix="mckibben-page-") as self.folder:
            self.looks.warm(START | {"muscle": self.start})
            try:
                yield
            finally:
                await asyncio.gather(*(pool.stop() for pool in (self.states, self.curves, self.beside, self.jobs)))
