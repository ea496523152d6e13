"""Linear algebra on one thread: the matrices are small, and threads that wait for each other cost more than they do.

On two cores, beside other work, the eigenvalues of 192 unknowns took a hundred times as long on two threads as on one.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

__all__ = ["one_thread"]

_LIBRARIES = ("numpy", "scipy.linalg")
"""Each may bring a library of its own; SciPy's is loaded only where it is needed."""


@contextmanager
def one_thread() -> Iterator[None]:
    """One thread for BLAS and LAPACK meanwhile, as called from this thread; also as a decorator."""
    loaded = tuple(name in sys.modules for name in _LIBRARIES)
    with _controller(loaded).limit(limits=1, user_api="blas"):
        yield


@cache
def _controller(loaded: tuple[bool, ...]) -> ThreadpoolController:
    """What knows the libraries that are loaded."""
    return ThreadpoolController()
