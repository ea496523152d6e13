"""Options that several commands share, each said once."""

from collections.abc import Sequence
from typing import Annotated

import typer

__all__ = ["AsJson", "Columns", "Force", "Held", "Overrides", "Quiet", "Tolerance", "Units", "pairs"]

Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help='change a value of the case, such as braid.angle="36 deg"'),
]
Force = Annotated[bool, typer.Option("--force", help="replace the output file if it exists")]
Tolerance = Annotated[float, typer.Option(help="relative error aimed at, from 1e-10 to 1e-2")]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON object, in SI units, and nothing else")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="print nothing but errors")]
Columns = Annotated[
    list[str] | None,
    typer.Option("--column", metavar="NAME=HEAD", help='which column holds a quantity, such as force="Load cell"'),
]
Units = Annotated[
    list[str] | None, typer.Option("--unit", metavar="NAME=UNIT", help="the unit of a quantity, such as force=kg")
]
Held = Annotated[
    list[str] | None,
    typer.Option("--held", metavar="NAME=VALUE", help='a quantity that the file does not say: pressure="3 bar"'),
]


def pairs(option: str, given: Sequence[str] | None, example: str = 'force="Load cell"') -> dict[str, str]:
    """What an option that is repeated says, by name; SpecError for what is no NAME=VALUE."""
    found = {}
    for text in given or ():
        name, equals, value = text.partition("=")
        if not (name.strip() and equals and value.strip()):
            from mckibben.spec.errors import SpecError

            raise SpecError(option, text, "must be NAME=VALUE", f"such as {example}")
        found[name.strip()] = value.strip()
    return found
