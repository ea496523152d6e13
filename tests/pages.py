"""The page as tests drive it: an application whose tasks are done in this process, and messages on its socket."""

import asyncio
import json
from collections.abc import Mapping
from typing import Any

from starlette.testclient import TestClient

from mckibben.page.gate import Gate
from mckibben.page.held import Page
from mckibben.page.pool import Tell
from mckibben.page.server import application
from mckibben.page.tasks import perform

HOST = "127.0.0.1:8765"
OWN = {"host": HOST, "origin": f"http://{HOST}"}
PAPER: dict[str, Any] = {"from": {"preset": "paper"}, "changes": {}}


class Here:
    """Does tasks in a thread of this process, so that nothing is compiled twice."""

    async def ask(self, task: str, said: Mapping[str, Any], tell: Tell) -> str:
        loop = asyncio.get_running_loop()

        def told(name: str, part: str) -> None:
            loop.call_soon_threadsafe(tell, name, part)

        return await asyncio.to_thread(perform, task, said, told)

    async def stop(self) -> None:
        return None


def client() -> TestClient:
    """A browser before a page; use it as a context."""
    app = application(Gate.of("127.0.0.1", 8765), Page(PAPER, Here))
    return TestClient(app, base_url=f"http://{HOST}", headers=OWN)


def look(muscle: Mapping[str, Any] = PAPER, **more: Any) -> dict[str, Any]:
    """What a browser asks to see: the free muscle at 1 bar where nothing else is said."""
    return {"muscle": muscle, "pressure": 1e5, "hold": "force", "value": 0.0, "top": 1e5} | more


def answered(socket: Any, task: str, said: Mapping[str, Any], number: int = 1) -> dict[str, Any]:
    """The parts of an answer by their names, of which the last is done, error, busy or cancelled."""
    socket.send_text(json.dumps({"id": number, "task": task, "said": said}))
    parts: dict[str, Any] = {}
    while not {"done", "error", "busy", "cancelled"} & parts.keys():
        message = socket.receive_json()
        assert message["id"] == number
        parts[message["part"]] = message["data"]
    return parts
