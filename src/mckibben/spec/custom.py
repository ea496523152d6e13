"""A law of the chamber of the user's own: a function and its named constants."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar

from mckibben.spec.declared import Declared, Reads, declare
from mckibben.spec.errors import SpecError
from mckibben.spec.fields import spec
from mckibben.units import Number, UnitError, to_si

__all__ = ["Constants", "CustomLaw"]


class Constants(Mapping[str, Number]):
    """Named SI numbers that cannot change and compare by value, as a spec must."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Number]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: str) -> Number:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        return repr(self._items)


def _read_constants(value: Any, field: str, declared: Declared) -> Constants:
    if not isinstance(value, Mapping):
        raise SpecError(field, value, "must be a mapping from name to number", 'write constants={"a": 1.0}')
    read = {}
    for key, item in value.items():
        if not isinstance(key, str):
            raise SpecError(field, key, "must have text as names")
        try:
            # The unit of a user's own constant is not known here, so only bare SI numbers make sense.
            read[key] = to_si(item, "1")
        except UnitError as error:
            raise SpecError(f"{field}.{key}", item, str(error), "constants of a custom law are SI numbers") from error
    return Constants(read)


def _read_function(value: Any, field: str, declared: Declared) -> Any:
    if callable(value):
        return value
    raise SpecError(field, value, "must be a function of (l1, l2, l3, constants)", "it gives the energy density in Pa")


@spec("chamber.law")
class CustomLaw:
    """A law of the user's own: function(l1, l2, l3, constants) -> energy density [Pa], written with jax.numpy.

    Among the stretches with l1 l2 l3 = 1, the energy must be least, and zero, at l1 = l2 = l3 = 1. A muscle with such a
    law can be solved, varied and differentiated, but not written to a case file. docs/adding_a_law.md has an example
    that is solved, and says how a law becomes part of the package.

    Args:
        function: function of (l1, l2, l3, constants) that gives the energy per unit reference volume [Pa], where
            constants is a dict. JAX differentiates it twice: use jax.numpy in place of numpy, and no `if` on stretches.
        constants: named numbers in SI units, without text. They are what sweeps and sensitivities can vary; numbers
            written into the function are not.

    Raises:
        SpecError: if the function cannot be called, or a constant is not a bare number.

    >>> def neo_hookean(l1, l2, l3, constants):
    ...     return constants["c1"] * (l1**2 + l2**2 + l3**2 - 3.0)
    >>> law = mk.CustomLaw(neo_hookean, constants={"c1": 8.5e3})
    >>> law.function(1.0, 1.0, 1.0, law.constants)
    0.0
    """

    name: ClassVar[str] = "custom"
    function: Callable[..., Any] = declare(
        Declared(kind="function", read=_read_function, meaning="energy density [Pa] of (l1, l2, l3, constants)")
    )
    constants: Reads[Constants] = declare(
        Declared(kind="constants", read=_read_constants, meaning="named SI numbers handed to the function", default={})
    )
