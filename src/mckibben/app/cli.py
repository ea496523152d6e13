"""The command line: `mckibben`. Commands parse, call the package and show; slow imports are inside them."""

from __future__ import annotations

import gc
import sys
from contextlib import suppress
from typing import Annotated

import typer

from mckibben.app import chart as commands_chart
from mckibben.app import data as commands_data
from mckibben.app import datasheet as commands_sheet
from mckibben.app import design as commands_design
from mckibben.app import draw as commands_draw
from mckibben.app import effects as commands_effects
from mckibben.app import export as commands_export
from mckibben.app import fit as commands_fit
from mckibben.app import look as commands_look
from mckibben.app import reach as commands_reach
from mckibben.app import run as commands_run
from mckibben.app import sensitivity as commands_derive
from mckibben.app import serve as commands_serve
from mckibben.app import simulate as commands_simulate
from mckibben.app import sweep as commands_sweep
from mckibben.app import tolerances as commands_tolerances
from mckibben.app import view as commands_view
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
app.command(epilog=commands_tolerances.EPILOG)(commands_tolerances.tolerances)
app.command(epilog=commands_effects.EPILOG)(commands_effects.effects)
app.command(epilog=commands_fit.EPILOG)(commands_fit.fit)
app.command(epilog=commands_design.EPILOG)(commands_design.design)
app.command(epilog=commands_simulate.EPILOG)(commands_simulate.simulate)
app.command(epilog=commands_reach.LIMITS)(commands_reach.limits)
app.command(epilog=commands_reach.WORKING_RANGE)(commands_reach.working_range)
app.command(epilog=commands_reach.FORCE_MAP)(commands_reach.force_map)
app.command(epilog=commands_chart.EPILOG)(commands_chart.chart)
app.command(epilog=commands_export.EPILOG)(commands_export.export)
app.command(epilog=commands_look.CHECK)(commands_look.check)
app.command(epilog=commands_look.PRESETS)(commands_look.presets)
app.add_typer(commands_data.data, name="data")
app.command(epilog=commands_sheet.EPILOG)(commands_sheet.datasheet)
app.command(epilog=commands_draw.PLOT)(commands_draw.plot)
app.command(epilog=commands_view.EPILOG)(commands_view.view)
app.command(epilog=commands_serve.EPILOG)(commands_serve.serve)
app.command(epilog=commands_draw.REPRODUCE)(commands_draw.reproduce)
app.command(epilog=commands_look.INFO)(commands_look.info)


def _show_version(asked: bool) -> bool:
    if asked:
        from importlib.metadata import version

        typer.echo(f"mckibben {version('mckibben')}")
        raise typer.Exit
    return asked  # typer takes what a callback returns as the option's value


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="show the version and stop")
    ] = False,
) -> None:
    """Mechanics of McKibben muscles: force, length, shape, fibre tension and stability of a braided tube."""


def main() -> None:
    """The `mckibben` command."""
    # Collect garbage less often: most objects belong to modules and stay, and to look through them takes a tenth more.
    gc.set_threshold(100_000, 20, 20)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError):  # a stream that was replaced, as in tests, may lack this method
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]  # a letter that the terminal lacks becomes "?"
    try:
        app()
    finally:
        gc.freeze()  # leave out the collection at exit, which takes half a second
