"""A real browser before a real page: Chromium, driven by Playwright, and what it was told and asked for."""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

CHROMIUM = next((path for path in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if path), None)
FLAGS = (
    "--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
    "--disable-quic",
)  # fmt: skip
PATIENCE = 120.0
"""Seconds for what may have to be compiled first."""


@contextmanager
def served(*words: str) -> Iterator[str]:
    """A page in a process of its own: its address."""
    call = [sys.executable, "-c", "from mckibben.app.cli import main; main()", "serve", "--port", "0", "--no-browser"]
    with subprocess.Popen([*call, *words], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            found = re.search(r"http://\S+", process.stdout.readline())
            assert found
            yield found[0]
        finally:
            process.terminate()


class Watched:
    """A tab, with all that its console said and all that it asked for."""

    def __init__(self, context: Any, address: str) -> None:
        self.tab = context.new_page()
        self.address = address
        self.complaints: list[str] = []
        self.foreign: list[str] = []
        self.tab.on("console", self._said)
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", self._asked)
        self.tab.on("websocket", lambda socket: self._other(socket.url.replace("ws://", "http://")))

    def _said(self, message: Any) -> None:
        if message.type in ("error", "warning") and "GPU stall" not in message.text:  # drawn without a graphics card
            self.complaints.append(message.text)

    def _asked(self, request: Any) -> None:
        self._other(request.url)

    def _other(self, url: str) -> None:
        if not url.startswith((self.address, "blob:", "data:")):
            self.foreign.append(url)

    def open(self, fragment: str = "") -> Any:
        """The page, with its first picture."""
        self.tab.goto(self.address + fragment)
        self.until("performance.getEntriesByName('input to picture').length > 0")
        return self.tab

    def until(self, expression: str, patience: float = PATIENCE) -> Any:
        """Wait until an expression is true; the page's policy lets Playwright's own waiting do no such thing."""
        end = time.monotonic() + patience
        while not (found := self.tab.evaluate(expression)):
            assert time.monotonic() < end, f"{expression}; {self.tab.inner_text('main')[:2000]}"
            time.sleep(0.05)
        return found

    def settled(self) -> None:
        """Wait until what was changed last is seen."""
        self.until("document.body.dataset.busy !== 'true'")

    def quiet(self) -> None:
        """Nothing was complained of, and nothing asked for elsewhere."""
        assert self.complaints == []
        assert self.foreign == []


def axe(tab: Any, part: str = "") -> list[str]:
    """What the accessibility checker finds serious, on all of the page or in one part of it, a selector."""
    tab.evaluate((Path(__file__).parent.parent / "page" / "axe.min.js").read_text(encoding="utf-8"))
    root = f"document.querySelector('{part}')" if part else "document"
    found = tab.evaluate(f"axe.run({root}, {{resultTypes: ['violations']}})")
    return [
        f"{one['id']}: {one['help']}: {node['html'][:120]}"
        for one in found["violations"]
        if one["impact"] in ("serious", "critical")
        for node in one["nodes"]
    ]


def environment_is_ready() -> str:
    """Why there is no browser here; empty where there is one."""
    if CHROMIUM is None:
        return "there is no Chromium here (Debian: apt-get install chromium)"
    return "" if os.name == "posix" else "the page is driven on Linux and macOS"


def typed(seen: Watched, label: str, text: str) -> None:
    """A value typed into a field."""
    field = seen.tab.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Enter")
    seen.settled()


def number(seen: Watched, name: str) -> str:
    """A number of the state as it is shown."""
    text: str = seen.tab.evaluate(f"[...document.querySelectorAll('dt')].find(x => x.textContent === '{name}')"
                                  ".nextSibling.textContent")  # fmt: skip
    return text.replace("\u2212", "-")
