"""The command line on broken case files: one message or a result, never a traceback, a hang or an empty success.

Files are a good one with lines dropped, doubled, swapped, cut or damaged, by a seeded generator. The stated bounds,
60 s to check a file and 300 s to run it on a busy machine, are there to notice a hang.
"""

import random
import time

import pytest
from texts import CASE
from typer.testing import CliRunner

import mckibben as mk
from mckibben.app.cli import app

pytestmark = pytest.mark.app

GOOD = CASE.replace("115 mm", "100 mm").replace("points = 21", "points = 3")
JUNK = (
    "\x00",
    "=",
    "[",
    "]]",
    '"',
    "mm",
    "-",
    "1e999",
    "nan",
    "é",
    "{",
    "to",
    "0x",
    ",",
    "\t",
    "\n",
    "#",
    "true",
    "9" * 40,
)
CHECK_BOUND, RUN_BOUND = 60.0, 300.0


def broken(seed: int) -> bytes:
    """A damaged case file."""
    chance = random.Random(seed)
    lines = GOOD.splitlines()
    for _ in range(chance.randint(1, 3)):
        k = chance.randrange(len(lines))
        match chance.randrange(6):
            case 0:
                del lines[k]
            case 1:
                lines.insert(k, lines[k])
            case 2:
                other = chance.randrange(len(lines))
                lines[k], lines[other] = lines[other], lines[k]
            case 3:
                lines[k] = lines[k][: chance.randint(0, len(lines[k]))]
            case 4:
                at = chance.randint(0, len(lines[k]))
                lines[k] = lines[k][:at] + chance.choice(JUNK) + lines[k][at:]
            case _:
                lines[k] = lines[k].replace(chance.choice("0123456789"), chance.choice(("", "-", "00", "e9", ".")))
    data = "\n".join(lines).encode()
    if chance.random() < 0.2:
        at = chance.randrange(len(data))
        data = data[:at] + bytes([chance.randrange(256)]) + data[at + 1 :]
    return data


def said_once(done) -> None:
    """Wrong input: exit code 2, one message, no traceback."""
    assert done.exit_code == 2
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert done.stderr.startswith("mckibben: ")
    assert len(done.stderr.strip().splitlines()) == 1
    assert "Traceback" not in done.output


@pytest.mark.parametrize("seed", range(120))
def test_check(seed, tmp_path):
    case = tmp_path / "case.toml"
    case.write_bytes(broken(seed))
    start = time.monotonic()
    done = CliRunner().invoke(app, ["check", str(case)])
    assert time.monotonic() - start < CHECK_BOUND
    if done.exit_code != 0:
        said_once(done)


@pytest.mark.parametrize("seed", range(40))
def test_run(seed, tmp_path):
    case, out = tmp_path / "case.toml", tmp_path / "out.nc"
    case.write_bytes(broken(seed))
    start = time.monotonic()
    done = CliRunner().invoke(app, ["run", str(case), "-o", str(out), "--quiet", "--tolerance", "1e-2"])
    assert time.monotonic() - start < RUN_BOUND
    if done.exit_code in (0, 3):
        result = mk.load(out)
        assert (set(result.verdict) <= {"stable", "unstable"}) == (done.exit_code == 0)
    else:
        said_once(done)
        assert not out.exists()
