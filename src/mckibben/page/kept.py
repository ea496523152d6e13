"""Measured files that browsers have sent: kept in the page's folder, so many at most, each by a secret name."""

from __future__ import annotations

import secrets
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from mckibben.page.pool import Tasks
from mckibben.page.tasks import TaskError

__all__ = ["ENDINGS", "Kept", "WithData"]

MOST = 32
"""Files that are kept; the oldest goes."""
ENDINGS = (".csv", ".tsv", ".txt", ".xlsx")


class Kept:
    """Measured files by the names that browsers were given for them."""

    def __init__(self) -> None:
        self._files: dict[str, tuple[Path, str, str]] = {}

    def put(self, folder: str, name: str, content: bytes, sheet: str = "") -> str:
        """Keep a file that a user calls `name`; what it goes by from now on. TaskError for another kind of file.

        `sheet` is that of a workbook; empty where it has but one.
        """
        ending = Path(name).suffix.lower()
        if ending not in ENDINGS:
            raise TaskError(f"{name}: must end in {', '.join(ENDINGS)}; save another workbook as XLSX or CSV")
        while len(self._files) >= MOST:
            self.drop(next(iter(self._files)))
        mark = secrets.token_urlsafe(12)
        path = Path(folder) / f"measured-{mark}{ending}"
        path.write_bytes(content)
        self._files[mark] = path, name, sheet
        return mark

    def drop(self, mark: str) -> None:
        """Forget a file."""
        path = self._files.pop(mark)[0]
        path.unlink(missing_ok=True)

    def found(self, mark: Any) -> dict[str, str]:
        """The path of a file, what its user calls it, and its sheet. TaskError where it is gone."""
        if not isinstance(mark, str) or mark not in self._files:
            raise TaskError("the measured data are no longer here: drop the file again")
        path, name, sheet = self._files[mark]
        return {"path": str(path), "name": name, "sheet": sheet}


class WithData:
    """Tasks on measured data, which browsers name by what they were given for them."""

    def __init__(self, pool: Tasks, kept: Kept) -> None:
        self._pool, self._kept = pool, kept

    async def ask(self, task: str, said: Mapping[str, Any], tell: Callable[[str, str], None]) -> str:
        """As of the pool."""
        return await self._pool.ask(task, dict(said) | self._kept.found(said.get("data")), tell)
