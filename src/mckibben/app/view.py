"""`mckibben view`: a saved result in three dimensions (window, picture, animation, shape), or a motion as animation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from mckibben.app.console import command, examples, say

__all__ = ["EPILOG", "view"]

EPILOG = examples(
    "mckibben view out.nc",
    "mckibben view out.nc -o picture.png --cut --ghost",
    "mckibben view out.nc -o picture.png --state 0 --colour density_fibres --size 1600x900",
    "mckibben view out.nc -o filling.gif",
    "mckibben view out.nc -o outside.stl",
    "mckibben view motion.nc -o lift.gif --speed 0.2",
)


@command
def view(
    file: Annotated[Path, typer.Argument(metavar="FILE.nc", help="what mckibben run or simulate saved by -o FILE.nc")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help=".png: a picture; .gif or .mp4: all states one after the other; .vtp (ParaView, in m), .glb (the web, "
            "in m) or .stl (CAD, the outer shape in mm): the shape; a window where left out",
        ),
    ] = None,
    state: Annotated[
        int | None, typer.Option(help=r"number of the state, from 0; from the end -1, -2 \[default: the last reached]")
    ] = None,
    colour: Annotated[
        str, typer.Option(metavar="NAME", help="variable along the muscle that colours it, such as theta; or none")
    ] = "fibre_tension",
    cut: Annotated[bool, typer.Option("--cut", help="cut braid and chamber open")] = False,
    translucent: Annotated[bool, typer.Option("--translucent", help="a chamber that one can see through")] = False,
    ghost: Annotated[bool, typer.Option("--ghost", help="show the muscle as made, faintly")] = False,
    axis: Annotated[str, typer.Option(help="the muscle lies (horizontal) or stands (vertical)")] = "horizontal",
    tilt: Annotated[float, typer.Option(help="angle by which the far end leaves the viewer, in degrees")] = 18.0,
    turn: Annotated[float, typer.Option(help="angle by which the muscle is turned about its axis, in degrees")] = 0.0,
    zoom: Annotated[float, typer.Option(help="how many times larger than fits the window, around the middle")] = 1.0,
    size: Annotated[
        str | None, typer.Option(metavar="WIDTHxHEIGHT", help=r"pixels \[default: 1200x600; standing 700x1000]")
    ] = None,
    fps: Annotated[
        float | None, typer.Option(help=r"frames a second of an animation \[default: 5, of a motion 20]")
    ] = None,
    speed: Annotated[
        float | None, typer.Option(help=r"how fast a motion is shown, 0.1 ten times slower \[default: 1, real time]")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="replace the file if it exists")] = False,
) -> None:
    """Show a saved result in three dimensions, without solving anything again; or a saved motion, as a .gif or .mp4.

    It takes PyVista, pip install "mckibben\\[view]"; .glb and .stl do not. Without a display, pictures and animations
    also take EGL or OSMesa (Debian: libegl1 and libgl1-mesa-dri, or libosmesa6), and an .mp4 takes imageio-ffmpeg.
    """
    from mckibben import disk
    from mckibben.files import store
    from mckibben.film import animate
    from mckibben.view import appearance, moving, render, scene, shapefile, stage

    kinds = {".png": "a picture"} | moving.ENDINGS | shapefile.ENDINGS
    ending = None if output is None else store.suffix_of(output, kinds)
    if output is not None:
        disk.check_target(output, force)
    result: Any = store.load(file)
    in_motion = _in_motion(result, file, ending in moving.ENDINGS)
    drawing: dict[str, Any] = {
        "colour": colour, "cut": cut, "translucent": translucent, "ghost": ghost, "axis": axis, "tilt": tilt,
        "turn": turn, "zoom": zoom, "size": _pixels(size),
    }  # fmt: skip
    if speed is not None and ending not in moving.ENDINGS:
        raise _error("--speed", "is that of an animation of a motion", "such as -o lift.gif")
    if output is None or ending is None:
        if not render.has_display():
            raise _error("--output", "is missing: there is no display for a window", "such as -o picture.png")
        scene.scene(result, state, off_screen=False, **drawing).show(title=str(file))
    elif ending in shapefile.ENDINGS:
        shapefile.save_shape(result, output, state, colour=colour, force=force)
        say(f"written: {output}, in {shapefile.UNITS[ending]}")
    elif ending in moving.ENDINGS:
        if state is not None:
            raise _error("--state", f"has no meaning for {output}", "an animation shows all states")
        animate.animate(result, output, fps=fps, speed=speed, force=force, **drawing)
        say(f"drawn: {output}")
        if not in_motion and appearance.left_out(result):
            say(appearance.left_out(result))
    else:
        plotter = scene.scene(result, state, off_screen=True, **drawing)
        disk.write(output, stage.png(plotter), force)
        plotter.close()
        say(f"drawn: {output}")


def _in_motion(found: Any, file: Path, moves: bool) -> bool:
    """Whether a file holds a motion, of which there are animations alone; SpecError for what else is no result."""
    from mckibben.files import store
    from mckibben.results.motion import Motion

    if not isinstance(found, Motion):
        store.result_in(found, file)
        return False
    if not moves:
        raise _error(str(file), "holds a motion", "such as -o lift.gif; mckibben plot draws it over time")
    return True


def _pixels(size: str | None) -> tuple[int, int] | None:
    if size is None:
        return None
    width, _, height = size.lower().replace("×", "x").partition("x")
    if not (width.strip().isdecimal() and height.strip().isdecimal()):
        from mckibben.spec.errors import SpecError

        raise SpecError("--size", size, "must be WIDTHxHEIGHT in pixels", "such as 1200x600")
    return int(width), int(height)


def _error(option: str, said: str, advice: str) -> Exception:
    from mckibben.spec.errors import SpecError

    return SpecError(option, allowed=said, advice=advice)
