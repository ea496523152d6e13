"""From what a sleeve is sold by to the radius of its fibres' centre lines."""

from __future__ import annotations

from typing import Any

from mckibben.spec.declared import Declared
from mckibben.spec.fields import read_quantity
from mckibben.units import Number

__all__ = ["centre_radius"]


def _diameter(name: str, low: float, high: float) -> Declared:
    return Declared(
        kind="quantity", read=read_quantity, name=name, unit="m", display="mm", meaning=name.replace("_", " "), low=0.0,
        low_open=True, size=(low, high), doubt=(0.05, 1e3),
    )  # fmt: skip


_INNER, _FIBRE = _diameter("inner_diameter", 1e-6, 100.0), _diameter("fibre_diameter", 1e-7, 0.1)


def centre_radius(inner_diameter: Any, fibre_diameter: Any) -> Number:
    """The radius R0 of a sleeve's fibres' centre lines, from its inner diameter and the diameter of its fibres.

    Two layers of fibre cross. Where a fibre is the inner one its centre line lies d/2 outside of the inner surface,
    where it is the outer one 3 d/2; it changes sides from crossing to crossing, so that on average R0 = D/2 + d. This
    takes fibres that are round and touch where they cross; of flat strands d is the thickness.

    Args:
        inner_diameter: inner diameter D of the sleeve in the state that is the braid's own [m].
        fibre_diameter: diameter d of a fibre, or thickness of a strand [m].

    Returns:
        The radius [m], for `Braid(radius=...)`.

    Raises:
        SpecError: for a value out of range.

    >>> round(mk.centre_radius(inner_diameter="10 mm", fibre_diameter="0.25 mm"), 6)  # m
    0.00525
    """
    D = read_quantity(inner_diameter, "centre_radius.inner_diameter", _INNER)
    return D / 2.0 + read_quantity(fibre_diameter, "centre_radius.fibre_diameter", _FIBRE)
