"""PyVista, ready to draw: whether it is there, and whether VTK can draw on this machine.

Without a display VTK draws by EGL or by OSMesa, and where it finds neither it takes the whole process down. So another
process tries first.
"""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Any

from mckibben.spec.errors import SpecError

__all__ = ["has_display", "library", "ready"]

_CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"
"""The variable by which VTK is told how to draw."""
WAYS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")
"""How VTK draws without a display, the first that works."""
_TRIAL = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(16, 16)
window.AddRenderer(vtkRenderer())
window.Render()
"""


def library(call: str) -> Any:
    """PyVista; SpecError in one sentence where it is missing."""
    try:
        import pyvista
    except ImportError as error:
        raise SpecError(call, allowed="takes PyVista", advice='pip install "mckibben[view]"') from error
    return pyvista


def ready(call: str) -> Any:
    """PyVista on a machine that can draw; SpecError in one sentence where it cannot."""
    with ThreadPoolExecutor(max_workers=1) as pool:  # the import and the trial take a second each
        drawing = pool.submit(can_draw)
        found = library(call)
    if not drawing.result():
        raise SpecError(
            call,
            allowed="VTK cannot draw here: there is no display, and neither EGL nor OSMesa works",
            advice="install Debian's packages libegl1 and libgl1-mesa-dri, or libosmesa6",
        )
    return found


def has_display() -> bool:
    """Whether a window can be opened."""
    return not sys.platform.startswith("linux") or bool(os.environ.get("DISPLAY"))


@lru_cache(maxsize=1)
def can_draw() -> bool:
    """Whether VTK draws on this machine; tells VTK how, where there is no display."""
    if has_display():
        return not sys.platform.startswith("linux") or _tried(None)
    if os.environ.get(_CHOICE):
        return _tried(None)
    for way in WAYS:
        if _tried(way):
            os.environ[_CHOICE] = way  # VTK would try the display first, and complain that there is none
            return True
    return False


def _tried(way: str | None) -> bool:
    """Whether a small picture can be drawn, in a process that may die of it."""
    chosen = {} if way is None else {_CHOICE: way}
    try:
        trial = subprocess.run(
            [sys.executable, "-c", _TRIAL], env=os.environ | chosen, capture_output=True, timeout=60.0, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return trial.returncode == 0
