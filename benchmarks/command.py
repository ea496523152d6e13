"""The command line as a user meets it: `mckibben run examples/case_a.toml` in processes of their own.

The times after the first are the middle of several: what the machine does beside it shows in a second of work.
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
CALL = [sys.executable, "-c", "from mckibben.app.cli import main; main()", "run", str(CASE), "--quiet"]


def measure() -> list[dict[str, Any]]:
    """With an empty folder of compiled functions, and again with what the first call left there."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"JAX_COMPILATION_CACHE_DIR": folder}
        saving = ["--output", str(Path(folder) / "out.nc"), "--force"]
        for what, more, repeats in (
            ("first time, nothing compiled yet", [], 1),
            ("second time", [], 5),
            ("second time, with a file", saving, 5),
        ):
            call = partial(subprocess.run, [*CALL, *more], env=environment, check=True)
            times = summary([once(call)[0] for _ in range(repeats)])
            rows.append({"name": f"command, {what}", "states": 21, "error": None, **times})
    return rows
