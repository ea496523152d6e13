"""The command line as a user meets it: `mckibben run examples/case_a.toml` in processes of their own."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from timing import once

CASE = Path(__file__).parent.parent / "examples" / "case_a.toml"
CALL = [sys.executable, "-c", "from mckibben.app.cli import main; main()", "run", str(CASE), "--quiet"]


def measure() -> list[dict[str, Any]]:
    """With an empty folder of compiled functions, and again with what the first call left there."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"JAX_COMPILATION_CACHE_DIR": folder}
        for what in ("first time, nothing compiled yet", "second time"):
            times, _ = once(lambda: subprocess.run(CALL, env=environment, check=True))
            rows.append({"name": f"command, {what}", "states": 21, "error": None, **times})
    return rows
