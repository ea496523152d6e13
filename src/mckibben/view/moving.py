"""Frames one after the other as the bytes of a GIF or an MP4."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from mckibben.spec.errors import SpecError

__all__ = ["ENDINGS", "FPS", "checked_fps", "ending_of", "gif", "mp4", "writer"]

ENDINGS = {".gif": "shown by everything", ".mp4": "smaller; needs imageio-ffmpeg"}
FPS = (0.1, 50.0)
"""Frames a second: a GIF counts in hundredths of a second, and programs slow down one that is faster."""
SAMPLES = 5
"""Frames from which the colours of a GIF are chosen."""
NEARLY_WHITE = 240


def ending_of(path: Any) -> str:
    """The ending of the file's name; SpecError for one that no animation has."""
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        known = " or ".join(f"{name} ({meaning})" for name, meaning in ENDINGS.items())
        raise SpecError(str(path), allowed=f"must end in {known}")
    return ending


def checked_fps(fps: Any) -> float:
    """Frames a second; SpecError for what is none."""
    if isinstance(fps, bool) or not isinstance(fps, Real) or not FPS[0] <= float(fps) <= FPS[1]:
        raise SpecError("animate.fps", fps, f"must be from {FPS[0]:g} to {FPS[1]:g} frames a second")
    return float(fps)


def gif(frame: Callable[[int], Image.Image], count: int, milliseconds: int, scale: Any) -> bytes:
    """A GIF of frames 0 to count - 1, in which a colour is always the same one of the 256 that it has.

    `scale` gives the colours that must be right: a map from 0 to 1 to colours.
    """
    chosen = sorted({round(k) for k in np.linspace(0, count - 1, min(SAMPLES, count))})
    samples = {k: frame(k) for k in chosen}
    palette = _palette(list(samples.values()), scale)
    frames = (
        (samples.pop(k, None) or frame(k)).quantize(palette=palette, dither=Image.Dither.NONE) for k in range(count)
    )
    content = io.BytesIO()
    next(frames).save(
        content, "GIF", save_all=True, append_images=frames, duration=milliseconds, loop=0, optimize=False
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


def mp4(frame: Callable[[int], Image.Image], count: int, fps: float, ffmpeg: Any) -> bytes:
    """An MP4 of frames 0 to count - 1; its sides are made even, as its usual encoding needs."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "out.mp4"
        first = np.asarray(frame(0))
        height, width = (side // 2 * 2 for side in first.shape[:2])
        out = ffmpeg.write_frames(str(made), (width, height), fps=fps, macro_block_size=2, quality=8)
        try:
            out.send(None)
            for k in range(count):
                shown = np.asarray(frame(k)) if k else first
                out.send(np.ascontiguousarray(shown[:height, :width]))
        finally:
            out.close()
        return made.read_bytes()


def writer(name: str) -> Any:
    """What writes an MP4; SpecError where it is missing."""
    try:
        import imageio_ffmpeg
    except ImportError as error:
        advice = "pip install imageio-ffmpeg (it brings a program under the GPL), or write a .gif"
        raise SpecError(name, allowed="is an MP4, which takes imageio-ffmpeg to write", advice=advice) from error
    return imageio_ffmpeg
