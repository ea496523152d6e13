"""`Array` in annotations: shapes and types are checked at run time, not whose array it is; NumPy's serve as well."""

from typing import Any, TypeAlias

__all__ = ["Array"]

Array: TypeAlias = Any
"""An array of NumPy's or of JAX's, or a tracer."""
