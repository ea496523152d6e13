"""What surrounds long work: compiled functions kept, a progress bar, and warnings that the result carries anyway."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from mckibben import cache
from mckibben.app.console import Watch, progress

__all__ = ["solving"]


@contextmanager
def solving(what: str, hidden: bool = False, unit: str = "") -> Iterator[Watch]:
    """Solve inside and tell the given function how far it is; nothing shows with `hidden`, or without a terminal."""
    from mckibben.kernel import keeping

    with progress(what, hidden, unit) as watch, cache.kept(), keeping(cache.kernels()):
        from mckibben.experiment import MuscleWarning  # after the cache is set, before anything is compiled

        warnings.simplefilter("ignore", MuscleWarning)
        yield watch
