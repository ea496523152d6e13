"""A contraction in place of a length: `contraction="10 %"` is a length of 0.9 H0, whatever muscle the test is made on.

A test keeps it as the path of its length with the unit "1"; `Test.as_steps` turns it into lengths, once H0 is known.
"""

from __future__ import annotations

import functools
from typing import Any, TypeVar

import attrs

from mckibben.spec.declared import Declared
from mckibben.spec.errors import SpecError
from mckibben.spec.path import Path
from mckibben.units import Number, UnitError, is_traced

__all__ = ["DECLARED", "lengths", "takes_contraction", "takes_it"]

T = TypeVar("T")


def _read(value: Any, field: str, declared: Declared) -> Path:
    try:
        path = Path.parse(value, "1")
    except UnitError as error:
        raise SpecError(field, value, str(error), 'write it like "10 %" or 0.1') from error
    for waypoint in path.waypoints:
        if not is_traced(waypoint) and not waypoint < 1.0:
            raise SpecError(field, value, "must be below 1 (100 %)", 'write it like "10 %" or 0.1')
    return path


DECLARED = Declared(
    kind="path", read=_read, name="contraction", unit="1", meaning="contraction 1 - h/H0, in place of a length"
)
"""What is known of the contraction that a test may be given."""


def lengths(path: Path, H0: Number) -> Path:
    """A path of contractions as one of lengths [m]."""
    return attrs.evolve(path, waypoints=tuple((1.0 - value) * H0 for value in path.waypoints), unit="m")


def takes_it(owner: Any) -> bool:
    """Whether a test can be given a contraction in place of its length."""
    return bool(getattr(type(owner) if not isinstance(owner, type) else owner, "__takes_contraction__", False))


def takes_contraction(cls: type[T]) -> type[T]:
    """Class decorator: `contraction` may be given in place of `length`."""
    plain: Any = cls.__init__

    @functools.wraps(plain)
    def init(self: Any, *args: Any, contraction: Any = None, **given: Any) -> None:
        if contraction is not None:
            own: str = cls.__spec_path__  # type: ignore[attr-defined]
            if given.get("length") is not None:
                raise SpecError(f"{own}.contraction", contraction, "is given beside a length", "give one of them")
            given["length"] = _read(contraction, f"{own}.contraction", DECLARED)
        plain(self, *args, **given)

    cls.__init__ = init  # type: ignore[method-assign]
    cls.__takes_contraction__ = True  # type: ignore[attr-defined]
    return cls
