"""Who may talk to the page: hosts, origins, the token, and the headers of every answer."""

import asyncio
from typing import Any

import pytest

from mckibben.page.gate import Gate, is_loopback

pytestmark = pytest.mark.page

HOME = b"127.0.0.1:8765"


async def inner(scope: Any, receive: Any, send: Any) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"in"})


def asked(gate: Gate, *heads: tuple[bytes, bytes], **more: Any) -> tuple[int, dict[str, str], str]:
    """Status, headers and text of the answer to a request."""
    scope = {"type": "http", "method": "GET", "path": "/", "query_string": b"", "headers": list(heads)} | more
    said: list[Any] = []

    async def send(message: Any) -> None:
        said.append(message)

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    asyncio.run(gate.wrapped(inner)(scope, receive, send))
    if said[0]["type"] == "websocket.close":
        return said[0]["code"], {}, said[0]["reason"]
    found = {name.decode(): value.decode() for name, value in said[0].get("headers", [])}
    return said[0].get("status", 200), found, said[1].get("body", b"").decode()


LOCAL = Gate.of("127.0.0.1", 8765)


@pytest.mark.parametrize("host", ["127.0.0.1:8765", "localhost:8765", "LOCALHOST:8765", "[::1]:8765"])
def test_its_own_names_are_answered(host: str) -> None:
    assert asked(LOCAL, (b"host", host.encode()))[0] == 200


@pytest.mark.parametrize("host", ["evil.example:8765", "127.0.0.1", "127.0.0.1:80", "localhost:8765.evil.example", ""])
def test_other_names_are_refused(host: str) -> None:
    status, _, said = asked(LOCAL, (b"host", host.encode()))
    assert status == 400
    assert "link that was printed" in said


def test_a_missing_or_doubled_host_is_refused() -> None:
    assert asked(LOCAL)[0] == 400
    assert asked(LOCAL, (b"host", HOME), (b"host", HOME))[0] == 400


@pytest.mark.parametrize(
    "origin", [b"http://evil.example", b"null", b"https://127.0.0.1:8765", b"http://127.0.0.1:9999"]
)
def test_a_foreign_origin_is_refused(origin: bytes) -> None:
    assert asked(LOCAL, (b"host", HOME), (b"origin", origin), method="POST")[0] == 403
    code, _, _ = asked(LOCAL, (b"host", HOME), (b"origin", origin), type="websocket")
    assert code == 1008


def test_what_changes_something_must_say_where_it_comes_from() -> None:
    assert asked(LOCAL, (b"host", HOME), method="POST")[0] == 403
    assert asked(LOCAL, (b"host", HOME), type="websocket")[0] == 1008
    assert asked(LOCAL, (b"host", HOME), (b"origin", b"http://" + HOME), method="POST")[0] == 200


def test_a_rebound_name_is_refused_though_both_headers_agree() -> None:
    evil = b"evil.example:8765"
    assert asked(LOCAL, (b"host", evil), (b"origin", b"http://" + evil), type="websocket")[0] == 1008


def test_every_answer_has_a_strict_policy() -> None:
    for host in (HOME, b"evil.example"):
        _, heads, _ = asked(LOCAL, (b"host", host))
        policy = heads["content-security-policy"]
        assert policy.startswith("default-src 'none'; script-src 'self'; style-src 'self';")
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert heads["x-content-type-options"] == "nosniff"
        assert heads["referrer-policy"] == "no-referrer"


def test_a_page_for_others_needs_its_token() -> None:
    gate = Gate.of("lab.example", 8765)
    host = (b"host", b"lab.example:8765")
    assert gate.token is not None
    assert LOCAL.token is None
    for query in (b"", b"token=", b"token=wrong", b"token=%ff"):
        status, _, said = asked(gate, host, query_string=query)
        assert status == 401
        assert "token" in said
    status, heads, _ = asked(gate, host, query_string=f"token={gate.token}".encode())
    assert (status, heads["location"]) == (303, "/")
    kept = heads["set-cookie"]
    assert "HttpOnly" in kept
    assert "SameSite=Strict" in kept
    cookie = (b"cookie", kept.partition(";")[0].encode())
    assert asked(gate, host, cookie)[0] == 200
    origin = (b"origin", b"http://lab.example:8765")
    assert asked(gate, host, origin, type="websocket")[0] == 1008
    assert asked(gate, host, origin, cookie, type="websocket")[0] == 200
    assert asked(gate, host, (b"cookie", b"mckibben-token=wrong; \xff=1"))[0] == 401
    assert Gate.of("lab.example", 8765).token != gate.token


def test_only_this_machine_is_loopback() -> None:
    assert [is_loopback(host) for host in ("127.0.0.1", "localhost", "::1", "0.0.0.0", "lab.example", "")] == [
        True, True, True, False, False, False,
    ]  # fmt: skip
