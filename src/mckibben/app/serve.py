"""`mckibben serve`: a page on which a muscle is seen and touched."""

from __future__ import annotations

from typing import Annotated

import typer

from mckibben.app.console import COMPLETE, command, examples, say

__all__ = ["EPILOG", "serve"]

EPILOG = examples(
    "mckibben serve",
    "mckibben serve festo-dmsp-20",
    "mckibben serve case.toml --port 8800",
    "mckibben serve --host 0.0.0.0",
)


@command
def serve(
    muscle: Annotated[
        str, typer.Argument(metavar="CASE.toml|PRESET", help="a case file, or the name of a preset")
    ] = "paper",
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="an address by which other machines may reach the page, by a token")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="number of the port; 0 for a free one")] = 8765,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="open the page in the browser")] = True,
) -> int:
    """Serve a page on this machine on which a muscle is seen and touched.

    Sliders change the muscle, its pressure and its load; shape, curves, working range and energies follow. It takes
    Starlette and uvicorn: pip install "mckibben\\[web]". Only this machine reaches the page, unless a host is given.
    """
    from mckibben.page.serve import serve as serving

    serving(muscle, host=host, port=port, browser=browser, tell=say)
    return COMPLETE
