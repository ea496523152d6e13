"""A map as a Python module that needs NumPy alone: the evaluator as it is here, with the numbers."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import resources

import numpy as np

from mckibben.potential.evaluate import Table
from mckibben.potential.rubbing import LEAST, Rubs

__all__ = ["script"]

_HEAD = '''"""{notes}

Functions of length [m] and gauge pressure [Pa], numbers or arrays: force, volume, stiffness, volume_by_length,
volume_by_pressure, inside and radius; `values` gives all at once. It needs NumPy alone.
"""
'''
_CALLS = '''

def values(length, pressure):
    """Force [N], volume [m^3], stiffness [N/m], dV/dh [m^2], dV/dP [m^3/Pa], potential [J] and inside, all at once."""
    return in_blocks(TABLE, length, pressure)


def force(length, pressure, slack=False):
    """Force [N]; with `slack` not below zero, as behind a tendon, which does not push."""
    found = values(length, pressure).force
    return np.maximum(found, 0.0) if slack else found


def volume(length, pressure):
    """Volume [m^3] inside the braid."""
    return values(length, pressure).volume


def stiffness(length, pressure):
    """dF/dh [N/m] at constant pressure."""
    return values(length, pressure).stiffness


def volume_by_length(length, pressure):
    """dV/dh [m^2] at constant pressure, which is -dF/dP."""
    return values(length, pressure).volume_by_length


def volume_by_pressure(length, pressure):
    """dV/dP [m^3/Pa] at constant length."""
    return values(length, pressure).volume_by_pressure


def inside(length, pressure):
    """Whether points lie in the range of the map."""
    return values(length, pressure).inside


def radius(length, pressure):
    """Largest radius [m] along the muscle."""
    h, P = np.broadcast_arrays(np.asarray(length, float), np.asarray(pressure, float))
    return largest_radius(TABLE, h.ravel(), P.ravel()).reshape(h.shape)
'''
_RUBS = '''

FRICTION = {friction}


def friction(length, pressure):
    """Friction [N] of crossings that all slip, half of what lies between the branches."""
    h, P = np.broadcast_arrays(np.asarray(length, float), np.asarray(pressure, float))
    y, (n, m) = across(TABLE, P.ravel()), FRICTION.shape
    held = np.clip(h.ravel(), edge(TABLE.low, y)[0], edge(TABLE.high, y)[0])
    X, Y = chebyshev((held - TABLE.length[0]) / TABLE.length[1], n), chebyshev(y, m)
    return np.maximum((X * (FRICTION @ Y)).sum(0), {least!r}).reshape(h.shape)


def branches(length, pressure):
    """The forces [N] between which friction leaves the muscle: as it shortens, and as it lengthens."""
    middle, half = force(length, pressure), friction(length, pressure)
    return middle - half, middle + half
'''
"""What is added for a muscle with friction at its crossings."""


def script(table: Table, notes: Iterable[str], rubs: Rubs | None = None) -> str:
    """The module's text, of a muscle with friction (`rubs`) with that too."""
    source = resources.files("mckibben.potential").joinpath("evaluate.py").read_text(encoding="utf-8")
    body = source[source.index("from typing import") :]  # what it says of itself stands in the head
    said = "\n".join(notes).replace("\\", "/").replace('"""', "'''")
    rubbed = "" if rubs is None else _RUBS.format(friction=_number(rubs.friction), least=LEAST)
    return _HEAD.format(notes=said) + "\n" + body + f"\n\nTABLE = {_numbers(table)}\n" + _CALLS + rubbed


def _numbers(table: Table) -> str:
    parts = (f"    {name}={_number(value)},\n" for name, value in zip(Table._fields, table, strict=True))
    return f"Table(\n{''.join(parts)})"


def _number(value: object) -> str:
    array = np.asarray(value, float)  # repr of a float has all its digits
    return repr(array.item()) if array.ndim == 0 else f"np.array({array.tolist()!r})"
