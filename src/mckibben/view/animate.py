"""`animate()`: the states of a result one after the other, as a GIF or an MP4."""

from __future__ import annotations

import io
import tempfile
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from mckibben import disk
from mckibben.spec.errors import SpecError
from mckibben.view.appearance import Appearance, left_out, reached, the_result
from mckibben.view.stage import Stage, image

__all__ = ["ENDINGS", "animate"]

ENDINGS = {".gif": "shown by everything", ".mp4": "smaller; needs imageio-ffmpeg"}
SAMPLES = 5
"""Frames from which the colours of a GIF are chosen."""
NEARLY_WHITE = 240


def animate(
    result: Any, path: str | PathLike[str], *, fps: float = 5.0, force: bool = False,
    colour: str | None = "fibre_tension", cut: bool = False, translucent: bool = False, ghost: bool = False,
    axis: str = "horizontal", tilt: float = 18.0, turn: float = 0.0, zoom: float = 1.0,
    size: Any = None,
) -> Path:  # fmt: skip
    """The states of a result in three dimensions, one after the other, as a file.

    Camera and scale of colours are the same in all frames. States that were not reached are left out, which each frame
    says. It takes PyVista as `scene` does; an MP4 also imageio-ffmpeg, which brings a program under the GPL and is
    therefore not installed with it.

    Args:
        result: what `run` or `load` gave.
        path: the file; its ending, .gif or .mp4, says the format. It is written whole or not at all.
        fps: frames a second, from 0.1 to 50.
        force: replace a file that is there already.
        colour: variable that colours fibres or chamber, as of `scene`.
        cut: cut a sector out of braid and chamber.
        translucent: a chamber that one can see through.
        ghost: the muscle as made, faintly.
        axis: "horizontal" or "vertical".
        tilt: angle [deg] by which the far end leaves the viewer.
        turn: angle [deg] by which the muscle is turned about its axis.
        zoom: how many times larger than fits the frame, around the middle.
        size: width and height of the frames in pixels; as of `scene` where left out.

    Returns:
        The path of the file.

    Raises:
        SpecError: as `scene`, for a result of which no state was reached, and for a file that exists (without `force`)
            or cannot be written.

    >>> curve = mk.run(mk.presets.paper(), mk.Isometric(length="115 mm", pressure="0 to 1 bar", points=3))
    >>> mk.animate(curve, "filling.gif", colour="theta")  # doctest: +SKIP
    >>> try:
    ...     mk.animate(curve, "filling.mov")
    ... except mk.SpecError as error:
    ...     print(error)
    filling.mov: must end in .gif (shown by everything) or .mp4 (smaller; needs imageio-ffmpeg)
    """
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        known = " or ".join(f"{name} ({meaning})" for name, meaning in ENDINGS.items())
        raise SpecError(str(path), allowed=f"must end in {known}")
    if isinstance(fps, bool) or not isinstance(fps, Real) or not 0.1 <= fps <= 50.0:
        raise SpecError("animate.fps", fps, "must be from 0.1 to 50 frames a second")
    shape = the_result("animate", result)
    look = Appearance.of("animate", shape, colour, cut, translucent, ghost, axis, tilt, turn, zoom, size)
    states = reached("animate", shape)
    disk.check_target(path, force)
    ffmpeg = _ffmpeg(str(path)) if ending == ".mp4" else None
    stage = Stage.of("animate", shape, look, states, note=left_out(shape))
    try:
        made = _gif(stage, states, fps) if ffmpeg is None else _mp4(ffmpeg, stage, states, fps)
    finally:
        stage.plotter.close()
    return disk.write(path, made, force)


def _frame(stage: Stage, state: int) -> Image.Image:
    stage.show(state)
    return image(stage.plotter)


def _gif(stage: Stage, states: list[int], fps: float) -> bytes:
    """A GIF, in whose frames a colour is always the same one of the 256 that it has."""
    chosen = sorted({states[round(k)] for k in np.linspace(0, len(states) - 1, min(SAMPLES, len(states)))})
    samples = {state: _frame(stage, state) for state in chosen}
    palette = _palette(list(samples.values()), stage.look.map(stage.result))
    frames = [
        (samples.get(state) or _frame(stage, state)).quantize(palette=palette, dither=Image.Dither.NONE)
        for state in states
    ]
    content = io.BytesIO()
    frames[0].save(
        content, "GIF", save_all=True, append_images=frames[1:], duration=round(1e3 / fps), loop=0, optimize=False
    )
    return content.getvalue()


def _palette(samples: list[Image.Image], scale: Any) -> Image.Image:
    """White, the scale of colours, and what else these pictures need: 256 colours in all.

    None is nearly white, because Pillow would take the background for it.
    """
    pixels = np.concatenate([np.asarray(sample).reshape(-1, 3) for sample in samples])
    others = Image.fromarray(pixels[pixels.min(axis=1) < NEARLY_WHITE][None])
    fixed = np.concatenate([[[255, 255, 255]], np.round(255.0 * scale(np.linspace(0.0, 1.0, 63))[:, :3])])
    rest = np.array(others.quantize(192, dither=Image.Dither.NONE).getpalette())[: 3 * 192]
    made = Image.new("P", (1, 1))
    made.putpalette([int(part) for part in np.concatenate([fixed.ravel(), rest])])
    return made


def _mp4(ffmpeg: Any, stage: Stage, states: list[int], fps: float) -> bytes:
    """An MP4; its sides are made even, as its usual encoding needs."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "out.mp4"
        width, height = (side // 2 * 2 for side in stage.look.size)
        writer = ffmpeg.write_frames(str(made), (width, height), fps=float(fps), macro_block_size=2, quality=8)
        try:
            writer.send(None)
            for state in states:
                writer.send(np.ascontiguousarray(np.asarray(_frame(stage, state))[:height, :width]))
        finally:
            writer.close()
        return made.read_bytes()


def _ffmpeg(name: str) -> Any:
    try:
        import imageio_ffmpeg
    except ImportError as error:
        advice = "pip install imageio-ffmpeg (it brings a program under the GPL), or write a .gif"
        raise SpecError(name, allowed="is an MP4, which takes imageio-ffmpeg to write", advice=advice) from error
    return imageio_ffmpeg
