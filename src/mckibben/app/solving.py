"""What every command that solves needs: compiled functions, a progress bar, and no warnings (the result has them)."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from mckibben.compiled import folder
from mckibben.watching import Watch, progress, unseen

__all__ = ["solving"]


@contextmanager
def solving(what: str, hidden: bool = False, unit: str = "") -> Iterator[Watch]:
    """Solve inside and tell the given function how far it is; nothing shows with `hidden`, or without a terminal."""
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")  # the compiler's own remarks; errors still raise
    from mckibben.compiled.kernel import keeping

    with unseen() if hidden else progress(what, unit=unit) as watch, keeping(folder.ready()):
        from mckibben.experiments.run import MuscleWarning

        warnings.simplefilter("ignore", MuscleWarning)
        yield watch
