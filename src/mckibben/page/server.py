"""The page as a web application: its files, its socket, what is sent in and out. It takes Starlette."""

from __future__ import annotations

import contextlib
import json
from importlib.resources import files
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from mckibben.page.catalogue import told
from mckibben.page.gate import Gate
from mckibben.page.held import Page
from mckibben.page.session import RubbishError, Session
from mckibben.page.transfers import transfers

__all__ = ["application"]

PEOPLE = 64
"""Browsers at once."""
FILES = {
    "/": ("index.html", "text/html; charset=utf-8"), "/page.js": ("page.js", "text/javascript; charset=utf-8"),
    "/page.css": ("page.css", "text/css; charset=utf-8"), "/icon.svg": ("icon.svg", "image/svg+xml"),
    "/NOTICE.txt": ("NOTICE.txt", "text/plain; charset=utf-8"),
}  # fmt: skip
"""All that is read from the disk for a browser, beside what was written for it to download."""


def application(gate: Gate, page: Page) -> Any:
    """The page behind its gate, as an ASGI application."""
    routes = [
        *(Route(path, _file(*about)) for path, about in FILES.items()),
        Route("/start", _start(page)),
        *transfers(page),
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
        if page.people > 1:
            page.looks.warm_all()
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
