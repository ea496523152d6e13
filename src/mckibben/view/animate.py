"""The states of a result one after the other, as a GIF or an MP4."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

from PIL import Image

from mckibben import disk
from mckibben.view import moving
from mckibben.view.appearance import Appearance, left_out, reached, the_result
from mckibben.view.stage import Stage, image

__all__ = ["of_states"]


def of_states(given: Any, path: str | PathLike[str], fps: float, force: bool, **looks: Any) -> Path:
    """Write the states of a result in three dimensions as a file; SpecError as `animate` says.

    `looks` are what `Appearance.of` takes.
    """
    ending = moving.ending_of(path)
    fps = moving.checked_fps(fps)
    shape = the_result("animate", given)
    look = Appearance.of("animate", shape, **looks)
    states = reached("animate", shape)
    disk.check_target(path, force)
    ffmpeg = moving.writer(str(path)) if ending == ".mp4" else None
    stage = Stage.of("animate", shape, look, states, note=left_out(shape))

    def frame(k: int) -> Image.Image:
        stage.show(states[k])
        return image(stage.plotter)

    try:
        if ffmpeg is None:
            made = moving.gif(frame, len(states), round(1e3 / fps), look.map(shape))
        else:
            made = moving.mp4(frame, len(states), fps, ffmpeg)
    finally:
        stage.plotter.close()
    return disk.write(path, made, force)
