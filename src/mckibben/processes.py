"""New processes that do not run the user's script once more."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["main_left_out"]


@contextmanager
def main_left_out() -> Iterator[None]:
    """Processes that start meanwhile do not run the script that is running, as they else do to find what it defines.

    They need nothing from it where functions travel whole (cloudpickle), and a script without the usual guard,
    `if __name__ == "__main__":`, would start everything again and again.
    """
    main = sys.modules["__main__"]
    hidden: dict[str, Any] = {name: main.__dict__[name] for name in ("__file__", "__spec__") if name in main.__dict__}
    main.__dict__.pop("__file__", None)
    main.__dict__["__spec__"] = None
    try:
        yield
    finally:
        main.__dict__.update(hidden)
