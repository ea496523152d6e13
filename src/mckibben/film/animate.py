"""`animate()`: the states of a result one after the other, or a rig in motion, as a GIF or an MP4."""

from __future__ import annotations

from inspect import signature
from os import PathLike
from pathlib import Path
from typing import Any

from mckibben import disk
from mckibben.results.motion import Motion
from mckibben.spec.errors import SpecError
from mckibben.view import moving
from mckibben.view.animate import of_states
from mckibben.view.appearance import read_size

__all__ = ["animate"]

SPEEDS = (1e-5, 1e3)
SIZE = (960, 540)
"""Width and height of the frames of a motion [pixels]."""
LEAST = (480, 300)
FPS_OF_STATES, FPS_OF_MOTION = 5.0, 20.0


def animate(
    shown: Any, path: str | PathLike[str], *, fps: float | None = None, speed: float | None = None,
    force: bool = False, colour: str | None = "fibre_tension", cut: bool = False, translucent: bool = False,
    ghost: bool = False, axis: str = "horizontal", tilt: float = 18.0, turn: float = 0.0, zoom: float = 1.0,
    size: Any = None,
) -> Path:  # fmt: skip
    """The states of a result in three dimensions, or a rig in motion, as a GIF or an MP4.

    Camera and scale of colours are the same in all frames. An MP4 takes imageio-ffmpeg, which brings a program under
    the GPL and is therefore not installed with the rest.

    Of a result every state is a frame, drawn by PyVista as `scene` does; states that were not reached are left out,
    which each frame says. Of a motion the frames are evenly spread in time: the rig from the side, true to scale along
    the muscle, with the load or the pulley, end stops, what each valve does, and the chamber in the colour of its
    pressure; beside it length (or angle) and pressure over time. The silhouettes are solved at the length and
    pressure of each frame; where the motion is outside of its map, or the muscle has no stable state, a dashed outline
    of the braid as made stands for it. Between the times of a motion its numbers are straight.

    Args:
        shown: what `run`, `simulate` or `load` gave.
        path: the file; its ending, .gif or .mp4, says the format. It is written whole or not at all.
        fps: frames a second, from 0.1 to 50; 5 of a result and 20 of a motion where left out. A GIF shows each frame
            for whole hundredths of a second: of a motion the frames are spread by what comes nearest.
        speed: of a motion, how fast it is shown: 1, as where it is left out, is real time, 0.1 ten times slower.
        force: replace a file that is there already.
        colour: of a result, the variable that colours fibres or chamber, as of `scene`.
        cut: of a result, cut a sector out of braid and chamber.
        translucent: of a result, a chamber that one can see through.
        ghost: of a result, the muscle as made, faintly.
        axis: of a result, "horizontal" or "vertical".
        tilt: of a result, the angle [deg] by which the far end leaves the viewer.
        turn: of a result, the angle [deg] by which the muscle is turned about its axis.
        zoom: of a result, how many times larger than fits the frame, around the middle.
        size: width and height of the frames in pixels; as of `scene` where left out, (960, 540) of a motion.

    Returns:
        The path of the file.

    Raises:
        SpecError: as `scene`, for a result of which no state was reached, for a motion that makes more than 1500
            frames, for what has no meaning for a motion, and for a file that exists (without `force`) or cannot be
            written.

    >>> rig = mk.Rig(
    ...     muscle=mk.presets.paper(), load=mk.FixedEnd(length="100 mm"), command=1.0,
    ...     supply=mk.Supply(gauge="2 bar"), valve=mk.Valve(C="0.1 L/s/bar", b=0.3),
    ... )
    >>> motion = mk.simulate(rig, until="1 s")
    >>> mk.animate(motion, "filling.gif", fps=4, size=(480, 300)).name
    'filling.gif'
    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> mk.animate(curve, "blown_up.gif", colour="theta")  # doctest: +SKIP
    >>> try:
    ...     mk.animate(curve, "filling.mov")
    ... except mk.SpecError as error:
    ...     print(error)
    filling.mov: must end in .gif (shown by everything) or .mp4 (smaller; needs imageio-ffmpeg)
    """
    looks = {"colour": colour, "cut": cut, "translucent": translucent, "ghost": ghost, "axis": axis, "tilt": tilt,
             "turn": turn, "zoom": zoom}  # fmt: skip
    if not isinstance(shown, Motion):
        if speed is not None:
            raise SpecError("animate.speed", speed, "is that of a motion, which simulate gives", "give fps")
        return of_states(shown, path, FPS_OF_STATES if fps is None else fps, force, **looks, size=size)
    usual = signature(animate).parameters
    for name, value in looks.items():
        if value != usual[name].default:
            raise SpecError(f"animate.{name}", value, "has no meaning for a motion, which is drawn from the side")
    return _of_motion(shown, path, fps, speed, force, SIZE if size is None else read_size("animate", size))


def _of_motion(
    motion: Motion, path: str | PathLike[str], fps: float | None, speed: float | None, force: bool,
    size: tuple[int, int],
) -> Path:  # fmt: skip
    from mckibben.film.frames import frames_of, rig_of

    ending = moving.ending_of(path)
    fps = moving.checked_fps(FPS_OF_MOTION if fps is None else fps)
    speed = 1.0 if speed is None else speed
    if isinstance(speed, bool) or not isinstance(speed, (int, float)) or not SPEEDS[0] <= speed <= SPEEDS[1]:
        raise SpecError(
            "animate.speed", speed, f"must be a number from {SPEEDS[0]:g} to {SPEEDS[1]:g}", "1 is real time"
        )
    if any(side < least for side, least in zip(size, LEAST, strict=True)):
        raise SpecError("animate.size", size, f"must be at least {LEAST[0]} by {LEAST[1]} pixels for a motion")
    disk.check_target(path, force)
    ffmpeg = moving.writer(str(path)) if ending == ".mp4" else None
    rig = rig_of(motion)
    frames = frames_of(motion, fps, speed, whole=ffmpeg is None)
    from mckibben.film.picture import SCALE, Film
    from mckibben.film.silhouettes import silhouettes  # here, because it takes the solver

    lines = [
        silhouettes(muscle, frames.length[:, k], frames.pressure[:, k], frames.inside[:, k])
        for k, muscle in enumerate(rig.muscles)
    ]
    picture = Film(motion, frames, lines, float(speed), size)
    if ffmpeg is None:
        made = moving.gif(picture.image, len(frames), round(1e3 * frames.shown), SCALE)
    else:
        made = moving.mp4(picture.image, len(frames), 1.0 / frames.shown, ffmpeg)
    return disk.write(path, made, force)
