"""The command line as a user meets it: `mckibben run examples/case_a.toml` in processes of their own.

Every time is the middle of five, taken in turns: what the machine does beside it shows in a second of work. They are
compared with `python -c "import jax"` in the same run, which no process that uses JAX can do without.
"""

import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from timing import once, summary

CASE = Path(__file__).parent.parent / "examples" / "case_a.toml"
REPEATS = 5
IMPORT = [sys.executable, "-c", "import jax"]
CALL = [sys.executable, "-c", "from mckibben.app.cli import main; main()", "run", str(CASE), "--quiet"]


def measure() -> list[dict[str, Any]]:
    """With an empty folder of compiled functions each time, and again with what the first call left there."""
    calls: dict[str, list[dict[str, Any]]] = {}
    for _ in range(REPEATS):
        with tempfile.TemporaryDirectory() as folder:
            environment = os.environ | {"MCKIBBEN_CACHE": str(Path(folder) / "kernels")}
            saving = ["--output", str(Path(folder) / "out.nc"), "--force"]
            for what, call in (
                ("import jax", IMPORT),
                ("command, first time, nothing compiled yet", CALL),
                ("command, second time", CALL),
                ("command, second time, with a file", [*CALL, *saving]),
            ):
                taken, _answer = once(partial(subprocess.run, call, env=environment, check=True))
                calls.setdefault(what, []).append(taken)
    rows = {what: summary(taken) for what, taken in calls.items()}
    unit = rows["import jax"]["median_s"]
    return [
        {
            "name": f"{what}, {times['median_s'] / unit:.1f} times import jax" if what.startswith("command") else what,
            "states": 21 if what.startswith("command") else 1,
            "error": None,
            **times,
        }
        for what, times in rows.items()
    ]
