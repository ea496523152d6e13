"""`mckibben serve` as typed: the link, the port, the token, what is missing."""

import http.client
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app

pytestmark = pytest.mark.page


@pytest.fixture
def taken() -> Iterator[int]:
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()
        yield listening.getsockname()[1]


def refused(*words: object) -> str:
    done = CliRunner().invoke(app, ["serve", "--no-browser", *map(str, words)])
    assert (done.exit_code, done.stdout) == (2, ""), done.stderr
    assert done.stderr.count("\n") == 1
    return done.stderr


def test_a_port_that_is_taken_is_one_message(taken: int) -> None:
    assert f"port = {taken}: is taken by another program; give another, such as --port 8800" in refused("--port", taken)


def test_other_wrong_words_are_one_message(tmp_path: Path) -> None:
    assert 'did you mean "paper"' in refused("papre")
    assert "there is no such file" in refused(tmp_path / "none.toml")
    assert "must be from 0 to 65535" in refused("--port", 70000)
    assert "is no address of this machine" in refused("--host", "192.0.2.1")


def test_a_missing_extra_is_one_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    with pytest.raises(mk.SpecError, match=r'the page takes uvicorn.*pip install "mckibben\[web\]"'):
        mk.serve(port=0, browser=False)


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_it_serves_until_it_is_interrupted(host: str) -> None:
    call = [sys.executable, "-c", "from mckibben.app.cli import main; main()", "serve", "--port", "0", "--no-browser"]
    with subprocess.Popen([*call, "--host", host], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env=os.environ | {"PYTHONUNBUFFERED": "1"}) as process:  # fmt: skip
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.fullmatch(r"the page: http://([^/]+):(\d+)/(\?token=\S+)? \(Ctrl-C ends it\)\n", line)
        assert found, line
        name, port, token = found[1], int(found[2]), found[3]
        assert (token is None) == (host == "127.0.0.1")
        there = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        there.request("GET", "/" + (token or ""), headers={"Host": f"{name}:{port}"})
        answer = there.getresponse()
        assert answer.status == (200 if token is None else 303)
        assert answer.getheader("content-security-policy", "").startswith("default-src 'none'")
        assert answer.getheader("server") is None
        there.close()
        there.request("GET", "/", headers={"Host": f"evil.example:{port}"})
        assert there.getresponse().status == 400
        there.close()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=30) == 0
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()
