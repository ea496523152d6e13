"""What runs on a worker process. Imports nothing heavy: the environment is set before JAX is there."""

from __future__ import annotations

import os
import pickle
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from mckibben.sweeps.plan import Piece, versions
from mckibben.sweeps.trouble import SweepError

if TYPE_CHECKING:
    from mckibben.sweeps.outcome import Columns

__all__ = ["THREADS", "work"]

THREADS = {
    "PJRT_NPROC": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "TF_CPP_MIN_LOG_LEVEL": "3",
}
"""One thread for each worker: there are as many workers as cores. XLA_FLAGS would do it too, but with other flags XLA
compiles other code, whose numbers differ in their last bits from those of a process without."""


@lru_cache(maxsize=4)
def _base(pickled: bytes) -> Any:
    """The muscle and test of a sweep, the same objects for all of its chunks.

    A law of the user's own is a function, and would be compiled again if it came anew with every chunk.
    """
    return pickle.loads(pickled)


def work(base: bytes, rest: tuple[Any, ...], environment: Mapping[str, str], made_by: Mapping[str, str]) -> Columns:
    """Solve one chunk: `base` is the pickled (muscle, test), `rest` the other fields of its `Piece`.

    SweepError on a machine where other versions are installed: it would mix other numbers into the sweep.
    """
    for name, value in environment.items():
        os.environ.setdefault(name, value)
    other = {name: number for name, number in versions().items() if made_by[name] != number}
    if other:
        here = ", ".join(f"{name} {number} (not {made_by[name]})" for name, number in other.items())
        raise SweepError(f"a worker has {here}: install the same versions everywhere")
    from mckibben.sweeps.chunk import solve_piece

    return solve_piece(Piece(*_base(base), *rest))
