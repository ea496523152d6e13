"""What runs in a working process: tasks read line by line from the page, parts and answers written back.

A line in is a JSON object with `task` and `said`. Lines out begin with a letter: p for a part of an answer (its name, a
space, JSON), d for the whole, e for an error of whoever asked, f for a fault of the program.
"""

from __future__ import annotations

import gc
import json
import os
import queue
import sys
import threading
import traceback
from typing import IO

from mckibben.page.tasks import TaskError, perform

__all__ = ["main", "serve"]

REST = 1.0
"""Seconds without a task after which there is time to tidy up."""


def serve(line: str, out: IO[str]) -> None:
    """Do the task of one line."""

    def write(text: str) -> None:
        out.write(text + "\n")
        out.flush()

    try:
        asked = json.loads(line)
        write("d" + perform(asked["task"], asked["said"], lambda name, part: write(f"p{name} {part}")))
    except TaskError as error:
        write("e" + json.dumps(str(error)))
    except Exception:
        traceback.print_exc()  # to the terminal of whoever runs the page, not to who looks at it
        write("f")


def main() -> None:
    """Serve until the page is gone, which ends a task that is under way."""
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    out = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)  # whatever a library prints must not get between the answers
    lines: queue.Queue[str] = queue.Queue()

    def read() -> None:
        for line in sys.stdin:
            lines.put(line)
        os._exit(0)

    sys.stdin.reconfigure(encoding="utf-8")  # type: ignore[union-attr]
    threading.Thread(target=read, daemon=True).start()
    gc.set_threshold(100_000, 20, 20)  # beside many objects that live long a whole collection takes a tenth of a second
    while True:
        try:
            line = lines.get(timeout=REST)
        except queue.Empty:
            gc.collect()
            gc.freeze()  # what a kind of muscle left behind, its traces above all, is not looked through again
            line = lines.get()
        serve(line, out)


if __name__ == "__main__":
    main()
