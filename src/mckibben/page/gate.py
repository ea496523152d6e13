"""Who may talk to a page: fixed lists of hosts and origins, a token where others can reach it; headers of every answer.

A list that is fixed when the page starts stops names that are made to point here later (DNS rebinding), which comparing
the two headers with each other does not.
"""

from __future__ import annotations

import secrets
import socket
from collections.abc import Awaitable, Callable, Iterable
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

import attrs

__all__ = ["Gate", "is_loopback"]

App = Callable[[Any, Any, Any], Awaitable[None]]
COOKIE = "mckibben-token"
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
ANY = ("0.0.0.0", "::", "")
"""Hosts that mean all addresses of a machine."""


def is_loopback(host: str) -> bool:
    """Whether a host is this machine alone."""
    return host in ("127.0.0.1", "localhost", "::1")


def _names(host: str) -> Iterable[str]:
    if is_loopback(host):
        return LOOPBACK
    if host not in ANY:
        return [f"[{host}]" if ":" in host else host]
    own = [socket.gethostname(), socket.getfqdn()]
    try:
        found = [str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None)]
    except OSError:
        found = []
    return [*LOOPBACK, *own, *(f"[{name}]" if ":" in name else name for name in found)]


@attrs.frozen
class Gate:
    """What a page answers to.

    Args:
        hosts: allowed values of the header Host.
        token: a secret that every request must know; None where nobody else reaches the page.
    """

    hosts: frozenset[str]
    token: str | None = None

    @classmethod
    def of(cls, host: str, port: int) -> Gate:
        """The gate of a page on a host and port; with a new token unless only this machine reaches it."""
        ends = (f":{port}", "") if port == 80 else (f":{port}",)
        hosts = frozenset(name.lower() + end for name in _names(host) for end in ends)
        return cls(hosts, None if is_loopback(host) else secrets.token_urlsafe(24))

    def wrapped(self, app: App) -> App:
        """The application behind the gate."""

        async def through(scope: Any, receive: Any, send: Any) -> None:
            if scope["type"] not in ("http", "websocket"):
                await app(scope, receive, send)
                return
            refused = self._refused(scope)
            if refused is None:
                await app(scope, receive, self._with_headers(send))
            elif scope["type"] == "websocket":
                await receive()
                await send({"type": "websocket.close", "code": 1008, "reason": refused[1]})
            else:
                await _answer(self._with_headers(send), *refused)

        return through

    def _refused(self, scope: Any) -> tuple[int, str, dict[str, str]] | None:
        """Status, message and headers for who may not pass."""
        heads = _heads(scope)
        hosts = heads.get("host", [])
        if len(hosts) != 1 or hosts[0].lower() not in self.hosts:
            return 400, "This page does not go by that name: use the link that was printed.", {}
        origins = heads.get("origin", [])
        reads = scope["type"] == "http" and scope["method"] in ("GET", "HEAD")
        own = {f"http://{host}" for host in self.hosts}
        if len(origins) > 1 or (origins and origins[0].lower() not in own) or not (origins or reads):
            return 403, "Another page asked: only this page itself may.", {}
        return None if self.token is None else self._unknown(scope, heads, self.token)

    def _unknown(self, scope: Any, heads: dict[str, list[str]], token: str) -> tuple[int, str, dict[str, str]] | None:
        """What to tell who does not show the token; one who brings it with the link keeps it as a cookie."""
        if _same(_cookie(heads), token):
            return None
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if scope["type"] == "http" and scope["path"] == "/" and _same(given, token):
            kept = f"{COOKIE}={token}; Path=/; HttpOnly; SameSite=Strict"
            return 303, "", {"location": "/", "set-cookie": kept}
        return 401, "This page needs the whole link that was printed where it was started, with its token.", {}

    def _with_headers(self, send: Any) -> Any:
        """`send`, with the headers of every answer: nothing from outside, and inside of no other page."""
        sockets = " ".join(sorted(f"ws://{host}" for host in self.hosts if "[" not in host))  # a policy knows no IPv6
        policy = (
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
            f"connect-src 'self' {sockets}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        more = {
            "content-security-policy": policy, "x-content-type-options": "nosniff", "referrer-policy": "no-referrer",
            "cross-origin-opener-policy": "same-origin", "cross-origin-resource-policy": "same-origin",
            "cache-control": "no-store",
        }  # fmt: skip

        async def sending(message: Any) -> None:
            if message["type"] == "http.response.start":
                heads = [(name.encode(), value.encode()) for name, value in more.items()]
                message = message | {"headers": [*message.get("headers", []), *heads]}
            await send(message)

        return sending


def _heads(scope: Any) -> dict[str, list[str]]:
    heads: dict[str, list[str]] = {}
    for name, value in scope["headers"]:
        heads.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
    return heads


def _cookie(heads: dict[str, list[str]]) -> str:
    try:
        cookies = SimpleCookie("; ".join(heads.get("cookie", [])))
    except CookieError:
        return ""
    return cookies[COOKIE].value if COOKIE in cookies else ""


def _same(given: str, token: str) -> bool:
    return secrets.compare_digest(given.encode(), token.encode())


async def _answer(send: Any, status: int, said: str, heads: dict[str, str]) -> None:
    plain = {"content-type": "text/plain; charset=utf-8"} | heads
    raw = [(name.encode(), value.encode()) for name, value in plain.items()]
    await send({"type": "http.response.start", "status": status, "headers": raw})
    await send({"type": "http.response.body", "body": said.encode()})
