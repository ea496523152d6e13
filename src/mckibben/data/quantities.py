"""What a bench measures, each quantity declared once: unit, meaning, and the words that heads of columns use."""

from __future__ import annotations

import attrs

__all__ = ["ABSOLUTE", "DERIVED", "GAUGE", "KINDS", "LABELS", "OTHER", "QUANTITIES", "Quantity", "remedy"]


@attrs.frozen
class Quantity:
    """One quantity of a bench.

    `words` are looked for in a head, all of one text in any order; `letters` are heads as a whole. `example` is how the
    unit is told where a file says none.
    """

    unit: str
    meaning: str
    words: tuple[str, ...]
    letters: tuple[str, ...] = ()
    example: str = ""


QUANTITIES = {
    "pressure": Quantity("Pa", "pressure", ("pressure", "druck", "pression"), ("p",), "bar"),
    "force": Quantity(
        "N", "force, positive where the muscle pulls its fittings together",
        ("force", "load", "tension", "pull", "mass", "weight", "kraft"), ("f",), "N",
    ),
    "rest_length": Quantity(
        "m", "length as made",
        ("rest length", "initial length", "original length", "nominal length"), ("l0", "h0"), "mm",
    ),
    "free_length": Quantity("m", "length without force at the pressure", ("free length",), (), "mm"),
    "length": Quantity("m", "length between the fittings", ("length", "laenge", "länge", "longueur"), ("l", "h"), "mm"),
    "contraction": Quantity("1", "contraction 1 - h/H0", ("contraction", "kontraktion"), (), "%"),
    "extension": Quantity("m", "extension from the free length", ("extension", "elongation"), (), "mm"),
}  # fmt: skip
"""The numbers of a dataset. Of two whose words are in a head, the earlier is meant: "rest length" is no "length"."""

KINDS = ("length", "contraction", "extension")
"""What may be measured of the shape; a dataset has one of them."""
LABELS = {
    "test": ("test", "specimen", "sample", "experiment", "trial", "run", "muscle"),
    "branch": ("branch", "direction"),
}
"""Columns of text, and their words."""

OTHER = frozenset(
    ("temperature", "error", "std", "sd", "deviation", "uncertainty", "rate", "speed", "velocity", "time", "supply",
     "valve", "setpoint", "target", "strain", "energy", "zeit", "number", "nr", "id")
)  # fmt: skip
"""Words of a head that say that the column holds something else: "force error", "supply pressure"."""
DERIVED = frozenset(("derived", "calculated", "computed"))
"""Words of a column that was not measured, and is left out where one that was is there."""
ABSOLUTE, GAUGE = frozenset(("absolute", "abs", "absolut")), frozenset(("gauge", "gage", "relative", "rel"))


def remedy(option: str, key: str, value: str) -> str:
    """What to say in a call, and on the command line: `columns={"force": "Load"} (--column force="Load")`."""
    switch = {"columns": "column", "units": "unit"}.get(option, option)
    return f'{option}={{"{key}": "{value}"}} (--{switch} {key}="{value}")'
