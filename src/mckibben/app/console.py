"""What every command shares: where text goes, errors as one line and an exit code, and tables of states.

Results go to stdout; errors, notes about the run and progress to stderr.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ParamSpec

import typer

if TYPE_CHECKING:
    from rich.console import Console, JustifyMethod

    from mckibben.spec.errors import SpecError

__all__ = [
    "COMPLETE",
    "INCOMPLETE",
    "INPUT",
    "INTERRUPTED",
    "STOPPED",
    "command",
    "complain",
    "examples",
    "say",
    "show_json",
    "table",
]

COMPLETE = 0
"""Exit code: everything asked for was found."""
INPUT = 2
"""Exit code for wrong input, the same as for wrong options. 1 is what Python gives for an error in the program."""
INCOMPLETE = 3
"""Exit code: part of what was asked for has no admissible equilibrium or was not reached."""
STOPPED = 4
"""Exit code: something outside, such as a full disk, ended the work."""
INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it: 128 plus the number of the signal."""

P = ParamSpec("P")


def examples(*lines: str) -> str:
    """The end of a command's help: examples, one on each line."""
    return "\n\n".join(["[bold]Examples[/bold]", *(f"[cyan]{line}[/cyan]" for line in lines)])


def _console(stderr: bool = False) -> Console:
    from rich.console import Console

    return Console(stderr=stderr, highlight=False, markup=False, emoji=False)


def say(*things: Any, style: str | None = None, whole: bool = False) -> None:
    """Text or tables for the user, on stdout; a line of text is never broken, nor with `whole` one of a table."""
    console = _console()
    if whole:  # rather wider than the terminal than digits cut off
        from rich.measure import Measurement

        wide = console.options.update(width=1000)
        console.width = max(console.width, *(Measurement.get(console, wide, thing).maximum for thing in things))
    console.print(*things, style=style, soft_wrap=all(isinstance(thing, str) for thing in things))


def complain(message: str, style: str | None = "red") -> None:
    """One line on stderr."""
    _console(stderr=True).print(f"mckibben: {message}", style=style, soft_wrap=True)


def show_json(value: dict[str, Any]) -> None:
    """Print one JSON object on stdout. It must hold None in place of NaN and infinity, which JSON does not know."""
    typer.echo(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _error(error: SpecError) -> dict[str, Any]:
    """Wrong input for JSON: the parts of the error, and the whole of it as one line."""
    from mckibben.spec.errors import MISSING

    value = None if error.value is MISSING else error.value
    plain = value if isinstance(value, (str, int, bool, type(None))) else str(value)
    parts = {"field": error.field, "value": plain, "allowed": error.allowed, "advice": error.advice}
    return {"message": str(error)} | parts


def command(function: Callable[P, int | None]) -> Callable[P, None]:
    """Decorator of every command: turns errors into one line on stderr and an exit code, such as 2 for wrong input."""

    @functools.wraps(function)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> None:
        from mckibben.spec.errors import SpecError
        from mckibben.sweeps.trouble import SweepError

        try:
            code = function(*args, **kwargs)
        except SpecError as error:
            complain(str(error))
            if kwargs.get("as_json"):
                show_json({"error": _error(error)})
            raise typer.Exit(INPUT) from error
        except SweepError as error:
            complain(str(error))
            raise typer.Exit(STOPPED) from error
        except KeyboardInterrupt as error:
            complain("interrupted")
            raise typer.Exit(INTERRUPTED) from error
        raise typer.Exit(code or COMPLETE)

    paragraphs = (function.__doc__ or "").split("\n\n")  # the help keeps the line breaks inside them
    wrapped.__doc__ = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    return wrapped


def table(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    title: str = "",
    right: Sequence[int] = (),
    whole: Sequence[int] = (0,),
    most: int = 0,
    narrow: bool = False,
) -> Any:
    """A table of text. Columns by number: those in `right` are numbers, those in `whole` are never broken into lines.

    With `most`, rows in the middle are left out. `narrow` puts columns close together.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    made = Table(title=Text(title, style="bold") if title else None, title_justify="left", box=box.SIMPLE_HEAD)
    if narrow:
        made.padding, made.pad_edge, made.show_edge = (0, 1, 0, 0), False, False
    made.show_header = any(columns)
    for index, name in enumerate(columns):
        justify: JustifyMethod = "right" if index in right else "left"
        made.add_column(Text(name), justify=justify, overflow="fold", no_wrap=index in (*right, *whole))
    cut = most if 0 < most < len(rows) else len(rows)
    head = rows[: (cut + 1) // 2] if cut < len(rows) else rows
    for row in head:
        made.add_row(*(Text(cell) for cell in row))
    if cut < len(rows):
        made.add_row(Text("..."), *(Text("") for _ in columns[1:]))
        for row in rows[len(rows) - cut // 2 :]:
            made.add_row(*(Text(cell) for cell in row))
    return made
