"""The command line: `mckibben`. Each command parses, calls the package and shows; heavy imports are inside commands."""

from __future__ import annotations

import gc
import sys
from contextlib import suppress
from typing import Annotated

import typer

from mckibben.app import commands_derive, commands_draw, commands_look, commands_run, commands_sweep
from mckibben.app.console import examples

__all__ = ["app", "main"]

app = typer.Typer(
    name="mckibben",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=examples(
        "mckibben presets paper --toml > case.toml",
        "mckibben check case.toml",
        "mckibben run case.toml -o out.nc",
        "mckibben plot out.nc -o force.png",
    )
    + "\n\nExit codes: 0 complete, 2 wrong input, 3 part of the test has no admissible equilibrium, "
    "4 a sweep was cut short.",
)
app.command(epilog=commands_run.EPILOG)(commands_run.run)
app.command(epilog=commands_sweep.EPILOG)(commands_sweep.sweep)
app.command(epilog=commands_derive.SENSITIVITY)(commands_derive.sensitivity)
app.command(epilog=commands_look.CHECK)(commands_look.check)
app.command(epilog=commands_look.PRESETS)(commands_look.presets)
app.command(epilog=commands_draw.PLOT)(commands_draw.plot)
app.command(epilog=commands_draw.REPRODUCE)(commands_draw.reproduce)
app.command(epilog=commands_look.INFO)(commands_look.info)


def _show_version(asked: bool) -> bool:
    if asked:
        from importlib.metadata import version

        typer.echo(f"mckibben {version('mckibben')}")
        raise typer.Exit
    return asked  # what a callback gives back becomes the option's value


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="show the version and stop")
    ] = False,
) -> None:
    """Mechanics of McKibben muscles: force, length, shape, fibre tension and stability of a braided tube."""


def main() -> None:
    """The `mckibben` command."""
    gc.set_threshold(100_000, 20, 20)  # what imports make stays: to look through it again and again takes a tenth more
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError):  # a stream that someone replaced
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]  # rather signs as "?" than a failure
    try:
        app()
    finally:
        gc.freeze()  # nor does the end look through everything once more, which takes half a second
