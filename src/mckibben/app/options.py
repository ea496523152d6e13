"""Options that several commands share, each said once."""

from typing import Annotated

import typer

__all__ = ["AsJson", "Force", "Overrides", "Quiet", "Tolerance"]

Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help='change a value of the case, such as braid.angle="36 deg"'),
]
Force = Annotated[bool, typer.Option("--force", help="replace the output file if it exists")]
Tolerance = Annotated[float, typer.Option(help="relative error aimed at, from 1e-10 to 1e-2")]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON object, in SI units, and nothing else")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="print nothing but errors")]
