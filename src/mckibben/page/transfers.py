"""Files in and out of a page: case files and measured data, of so many bytes at most; what is downloaded."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

from starlette.background import BackgroundTask
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route

from mckibben.page.held import Page
from mckibben.page.kinds import KINDS
from mckibben.page.pool import BusyError, Pool
from mckibben.page.session import LONGEST
from mckibben.page.tasks import TaskError

__all__ = ["CASE", "DATA", "transfers"]

CASE = 2_000_000
"""Bytes of a case file at most."""
DATA = 10_000_000
"""Bytes of measured data at most."""


def transfers(page: Page) -> list[Route]:
    """Where files are sent to, and fetched from."""
    return [
        Route("/case", _case(page), methods=["POST"]),
        Route("/data", _data(page), methods=["POST"]),
        Route("/file/{kind}", _download(page), methods=["POST"]),
    ]


def _case(page: Page) -> Any:
    async def answer(request: Request) -> Response:
        try:
            body = await _body(request, CASE, "a case file")
        except TaskError as error:
            return _error(413, error)
        name = os.path.basename(request.query_params.get("name", ""))[:80] or "case.toml"
        with tempfile.TemporaryDirectory(dir=page.folder) as folder:
            path = Path(folder) / "case.toml"
            path.write_bytes(body)
            return await _done(page.states, "case", {"path": str(path), "name": name})

    return answer


def _data(page: Page) -> Any:
    async def answer(request: Request) -> Response:
        name = os.path.basename(request.query_params.get("name", ""))[:80] or "data.csv"
        try:
            content = await _body(request, DATA, "measured data")
            mark = page.kept.put(page.folder, name, content, request.query_params.get("sheet", "")[:80])
        except TaskError as error:
            return _error(413 if "too large" in str(error) else 400, error)
        made = await _done(page.beside, "data", page.kept.found(mark))
        told = json.loads(bytes(made.body))
        if made.status_code == 200 and "sheets" not in told:
            return JSONResponse(told | {"data": mark})
        page.kept.drop(mark)  # it is sent again, with its sheet
        return made

    return answer


def _download(page: Page) -> Any:
    async def answer(request: Request) -> Response:
        kind = request.path_params["kind"]
        if kind not in KINDS:
            return _error(404, TaskError("there is no such file"))
        try:
            asked = json.loads(await _body(request, LONGEST, "a muscle"))
        except (TaskError, ValueError, RecursionError):
            return _error(400, TaskError("what is to be written was not understood"))
        folder = tempfile.mkdtemp(dir=page.folder)
        said = {"kind": kind, "asked": asked if isinstance(asked, dict) else {}, "folder": folder}
        made = await _done(page.beside, "file", said)
        if made.status_code != 200:
            shutil.rmtree(folder, ignore_errors=True)
            return made
        found = json.loads(bytes(made.body))
        return FileResponse(
            found["path"], media_type=KINDS[kind], filename=found["name"],
            background=BackgroundTask(shutil.rmtree, folder, ignore_errors=True),
        )  # fmt: skip

    return answer


async def _body(request: Request, most: int, what: str) -> bytes:
    """What was sent, of so many bytes at most. TaskError for more, which is not read."""
    said = request.headers.get("content-length", "0")
    body = bytearray()
    try:
        if not said.isdecimal() or int(said) <= most:
            async for piece in request.stream():
                body += piece
                if len(body) > most:
                    break
            else:
                return bytes(body)
    except ClientDisconnect as error:
        raise TaskError("the rest did not come") from error
    raise TaskError(f"the file is too large: {what} has at most {most / 1e6:g} MB")


async def _done(pool: Pool, task: str, said: dict[str, Any]) -> Response:
    """The answer to a task, or why there is none."""
    try:
        return Response(await pool.ask(task, said, lambda name, part: None), media_type="application/json")
    except TaskError as error:
        return _error(400, error)
    except BusyError as error:
        return _error(503, error)


def _error(status: int, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, status)
