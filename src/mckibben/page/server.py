"""The page as a web application: its files, its socket, uploads and downloads. It takes Starlette."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import AsyncIterator, Callable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from mckibben.page.catalogue import told
from mckibben.page.gate import Gate
from mckibben.page.kinds import KINDS
from mckibben.page.looks import Looks
from mckibben.page.pool import BusyError, Pool, Process, Tasks, Working
from mckibben.page.session import LONGEST, RubbishError, Session
from mckibben.page.tasks import TaskError

__all__ = ["Page", "application"]

CASE = 2_000_000
"""Bytes of a case file at most."""
START = {"pressure": 1e5, "hold": "force", "value": 0.0, "top": 1e5}
"""What is looked at before somebody asks, so that what it takes is at hand."""
PEOPLE = 64
"""Browsers at once."""
FILES = {
    "/": ("index.html", "text/html; charset=utf-8"), "/page.js": ("page.js", "text/javascript; charset=utf-8"),
    "/page.css": ("page.css", "text/css; charset=utf-8"), "/icon.svg": ("icon.svg", "image/svg+xml"),
    "/NOTICE.txt": ("NOTICE.txt", "text/plain; charset=utf-8"),
}  # fmt: skip
"""All that is read from the disk for a browser, beside what was written for it to download."""


class Page:
    """What a page holds while it is served: its processes, its folder, how many look at it."""

    def __init__(self, start: Mapping[str, Any], kind: Callable[[], Working] = Process) -> None:
        self.start = dict(start)
        at_once = max(2, min(4, (os.cpu_count() or 1) // 2))
        self.states, self.curves = (Pool(at_once, 64, 120.0, kind=kind) for _ in range(2))
        self.beside = Pool(2, 16, 600.0, kind=kind)
        self.looks = Looks(self.states, self.curves, self.beside)
        self.tasks: dict[str, Tasks] = {"look": self.looks, "open": self.states, "reach": self.beside}
        self.people = 0
        self.folder = ""

    @contextlib.asynccontextmanager
    async def served(self, app: Any) -> AsyncIterator[None]:
        """While the page is served."""
        with tempfile.TemporaryDirectory(prefix="mckibben-page-") as self.folder:
            self.looks.warm(START | {"muscle": self.start})
            try:
                yield
            finally:
                await asyncio.gather(*(pool.stop() for pool in (self.states, self.curves, self.beside)))


def application(gate: Gate, page: Page) -> Any:
    """The page behind its gate, as an ASGI application."""
    routes = [
        *(Route(path, _file(*about)) for path, about in FILES.items()),
        Route("/start", _start(page)),
        Route("/case", _case(page), methods=["POST"]),
        Route("/file/{kind}", _download(page), methods=["POST"]),
        WebSocketRoute("/socket", _socket(page)),
    ]
    return gate.wrapped(Starlette(routes=routes, lifespan=page.served))


def _file(name: str, media: str) -> Any:
    content = (files("mckibben.page") / "assets" / name).read_bytes()

    async def answer(request: Request) -> Response:
        return Response(content, media_type=media)

    return answer


def _start(page: Page) -> Any:
    async def answer(request: Request) -> Response:
        return JSONResponse({"presets": told(), "start": page.start})

    return answer


def _socket(page: Page) -> Any:
    async def talk(socket: WebSocket) -> None:
        await socket.accept()
        if page.people >= PEOPLE:
            await _refused(socket, 1013, "busy", "too many people look at this page: try again later")
            return
        page.people += 1
        session = Session(socket.send_text, page.tasks)
        try:
            while True:
                await session.take(await _text(socket))
        except WebSocketDisconnect:
            pass
        except RubbishError as error:
            await _refused(socket, 1008, "rubbish", f"{error}: this is no page of ours")
        finally:
            page.people -= 1
            await session.close()

    return talk


async def _text(socket: WebSocket) -> str:
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code") or 1005)
    if not isinstance(message.get("text"), str):
        raise RubbishError("a message that is not text")
    text: str = message["text"]
    return text


async def _refused(socket: WebSocket, code: int, part: str, said: str) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        await socket.send_text(json.dumps({"id": None, "part": part, "data": said}))
        await socket.close(code)


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
