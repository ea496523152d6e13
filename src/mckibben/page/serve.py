"""`serve()`: a page on this machine on which a muscle is seen and touched."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import webbrowser
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben.page.gate import Gate, is_loopback
from mckibben.spec import Muscle, SpecError, presets
from mckibben.spec.text import to_mapping

__all__ = ["PORT", "serve"]

PORT = 8765
"""The port where nothing is said."""


def serve(
    muscle: Muscle | str | PathLike[str] = "paper",
    *,
    host: str = "127.0.0.1",
    port: int = PORT,
    browser: bool = True,
    tell: Callable[[str], None] = print,
) -> None:
    """Serve a page on which a muscle is seen and touched, until Ctrl-C.

    Sliders change the muscle, its pressure and its load; shape, curves, working range and energies follow. Nothing
    leaves the machine: the page needs nothing from outside, and only this machine reaches it unless a host is given.

    Args:
        muscle: a `Muscle`, the name of a preset, or a case file (TOML).
        host: an address of this machine by which others may reach the page too ("0.0.0.0" for all). Then the link holds
            a token, without which the page answers nobody. What goes over the network is not encrypted.
        port: number of the port; 0 for a free one.
        browser: whether to open the page in the browser.
        tell: is given the line with the link.

    Returns:
        Nothing, once it is ended.

    Raises:
        SpecError: for a muscle that is none, a port that is taken or none, a host that is none of this machine's, and
            where Starlette and uvicorn are missing: pip install "mckibben[web]".

    >>> try:
    ...     mk.serve("paper", port=70_000)
    ... except mk.SpecError as error:
    ...     print(error)
    port = 70000: must be from 0 to 65535
    """
    start = {"from": _mapping(muscle)}
    listening = _bound(host, port)
    with contextlib.closing(listening):
        try:
            import uvicorn

            from mckibben.page.held import Page
            from mckibben.page.server import application
        except ImportError as error:
            said = f"the page takes {error.name}, which is not installed"
            raise SpecError("serve", allowed=said, advice='pip install "mckibben[web]"') from error
        number = listening.getsockname()[1]
        gate = Gate.of(host, number)
        config = uvicorn.Config(
            application(gate, Page(start)), log_level="warning", ws="websockets-sansio", ws_max_size=2**18,
            server_header=False, proxy_headers=False, limit_concurrency=256, timeout_graceful_shutdown=1,
        )  # fmt: skip
        link = _link(host, number, gate.token)
        tell(f"the page: {link} (Ctrl-C ends it)")
        if browser:
            webbrowser.open(link)
        with contextlib.suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])


def _mapping(muscle: Muscle | str | PathLike[str]) -> dict[str, Any]:
    """What the page starts from, as a case file says it."""
    if isinstance(muscle, Muscle):
        return to_mapping(muscle)
    if isinstance(muscle, str) and muscle in presets.names():
        return {"preset": muscle}
    if isinstance(muscle, str) and not Path(muscle).suffix:
        presets.get(muscle)  # which says what there is
    from mckibben.files.case import read_case

    return to_mapping(read_case(muscle, test_required=False).muscle)


def _bound(host: str, port: int) -> socket.socket:
    """A socket that listens. SpecError, in one line, where it cannot."""
    if isinstance(port, bool) or not 0 <= port <= 65535:
        raise SpecError("port", port, "must be from 0 to 65535")
    where = "127.0.0.1" if host == "localhost" else host
    listening = socket.socket(socket.AF_INET6 if ":" in where else socket.AF_INET)
    try:
        if os.name == "posix":  # elsewhere it would let two programs have the same port
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((where, port))
        listening.listen(128)
    except OSError as error:
        listening.close()
        raise _unbound(host, port, error) from error
    return listening


def _unbound(host: str, port: int, error: OSError) -> SpecError:
    if error.errno == errno.EADDRINUSE:
        return SpecError("port", port, "is taken by another program", "give another, such as --port 8800, or --port 0")
    if error.errno == errno.EACCES:
        return SpecError("port", port, "is not for everybody to use", "give one above 1023")
    advice = "leave it out for this machine alone, or give 0.0.0.0 for all its addresses"
    return SpecError("host", host, f"is no address of this machine: {error.strerror or error}", advice)


def _link(host: str, port: int, token: str | None) -> str:
    if is_loopback(host):
        return f"http://{'[::1]' if host == '::1' else '127.0.0.1'}:{port}/"
    name = socket.gethostname() if host in ("0.0.0.0", "::") else f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/?token={token}"
