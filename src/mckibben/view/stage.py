"""The stage on which muscles are shown: a plotter of PyVista with its camera, its scale of colours and its words."""

from __future__ import annotations

import io
import sys
import textwrap
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

import attrs
import numpy as np
from matplotlib import get_data_path
from PIL import Image

from mckibben.results.result import Result
from mckibben.view.appearance import PLAIN, Appearance, head, notes
from mckibben.view.braid3d import Body
from mckibben.view.mesh import Mesh, surface
from mckibben.view.projection import MM
from mckibben.view.render import has_display, ready
from mckibben.view.tube import Tube

PAPER, INK = "#ffffff", "#262626"
FIBRE, PLAIN_FIBRE, RUBBER, METAL, GHOST = "#3d4852", "#c89b3c", "#eceef0", "#b7bdc4", "#5a7fb0"
"""Colours of what no field colours; plain fibres where nothing is coloured at all."""
MADE = "Faint: the muscle as made."
TOP, BOTTOM = 3.0, 10.5
"""Heights of the head, and of the scale of colours with the notes, in letters."""


def image(plotter: Any) -> Image.Image:
    """What an off-screen plotter shows now."""
    plotter.render()
    return Image.fromarray(np.asarray(plotter.screenshot(return_img=True)))


def png(plotter: Any) -> bytes:
    """What an off-screen plotter shows now, as the bytes of a PNG file."""
    content = io.BytesIO()
    image(plotter).save(content, "PNG")
    return content.getvalue()


@lru_cache(maxsize=1)
def shown(pyvista: Any) -> Any:
    """The kind of plotter that a notebook shows by itself."""

    class Scene(pyvista.Plotter):  # type: ignore[misc]
        """A PyVista Plotter."""

        def _repr_png_(self) -> bytes | None:
            return png(self) if self.off_screen else None

    return Scene


def _turns(pyvista: Any) -> bool:
    """Whether a notebook can turn a plotter: by pyvista[jupyter], which is no part of the extra."""
    if "IPython" not in sys.modules:
        return False
    registered = getattr(pyvista, "registered_jupyter_backends", None)  # before 0.48 there is only trame
    return find_spec("trame") is not None if registered is None else bool(registered())


@attrs.frozen
class Stage:
    """A plotter, and what stays the same from one state to the next: scale of colours and camera."""

    plotter: Any
    result: Result
    look: Appearance
    limits: tuple[float, float]
    note: str = ""

    @classmethod
    def of(
        cls,
        call: str,
        result: Result,
        look: Appearance,
        states: list[int],
        off_screen: bool | None = True,
        note: str = "",
    ) -> Stage:
        """A stage on which all of these states have room; still empty."""
        pyvista = ready(call)
        hidden = off_screen if has_display() else True
        theme = pyvista.themes.DocumentTheme()
        if not _turns(pyvista):
            theme.jupyter_backend = "static"
        plotter = shown(pyvista)(off_screen=hidden, window_size=list(look.size), border=False, theme=theme)
        plotter.set_background(PAPER)
        plotter.enable_anti_aliasing("msaa", multi_samples=4)
        stage = cls(plotter, result, look, look.limits(result, states), note)
        stage._aim([look.body(result, state) for state in states])
        return stage

    def show(self, state: int) -> None:
        """Put one state on the stage, in place of another."""
        look, body = self.look, self.look.body(self.result, state)
        values, on_chamber = look.values(self.result, state), look.on_chamber(self.result)
        chamber = body.chamber()
        plain = PLAIN_FIBRE if values is None else FIBRE
        self._put("fibres", body.fibre_pipes(), body, plain, None if on_chamber else values)
        if chamber is not None:
            opacity = 0.35 if look.translucent else 1.0
            self._put("chamber", chamber, body, RUBBER, values if on_chamber else None, opacity=opacity)
        self._put("fittings", body.fittings(), body, METAL)
        if look.ghost:
            self._ghost()
        self._write(head(self.result, state), [*notes(self.result, body), *([MADE] if look.ghost else [])])
        if values is not None:
            self._scale()

    def _put(self, name: str, mesh: Mesh, body: Body, colour: str, values: Any = None, *, opacity: float = 1.0) -> None:
        """A mesh under a name, coloured by values along v, or plain."""
        made = poly_data(mesh, MM)
        options: dict[str, Any] = {"color": colour}
        if values is not None:
            made.point_data[self.look.colour] = np.interp(mesh.v, body.tube.v, values)
            options = {
                "scalars": self.look.colour,
                "cmap": self.look.map(self.result),
                "clim": self.limits,
                "show_scalar_bar": False,
            }
        shine = {"specular": 0.15, "specular_power": 20.0, "ambient": 0.3, "diffuse": 0.75}
        if opacity < 1.0:
            options["opacity"] = opacity
        self.plotter.add_mesh(made, name=name, interpolate_before_map=True, render=False, **shine, **options)
        self.plotter.actors[name].prop.interpolation = "Phong"

    def _ghost(self) -> None:
        """The muscle as made: a faint surface with the lines of its fibres."""
        rest = Tube.cylinder(self.result.muscle)
        made = poly_data(surface(rest), MM)
        self.plotter.add_mesh(made, name="ghost", color=GHOST, opacity=0.12, render=False)
        import pyvista

        starts = 2.0 * np.pi * np.arange(max(1, min(rest.fibres // 2, 40))) / max(1, min(rest.fibres // 2, 40))
        lines = [rest.point(*rest.fibre(float(start), hand)) * MM for hand in (1, -1) for start in starts]
        rings = [rest.point(v, np.linspace(0.0, 2.0 * np.pi, 97)) * MM for v in (rest.v[0], rest.v[-1])]
        for name, group, opacity, width in (("ghost lines", lines, 0.35, 1.0), ("ghost ends", rings, 0.9, 2.0)):
            joined = pyvista.merge([pyvista.lines_from_points(line) for line in group])
            self.plotter.add_mesh(
                joined, name=name, color=GHOST, opacity=opacity, line_width=width, lighting=False, render=False
            )

    def _aim(self, bodies: list[Body]) -> None:
        """The camera: everything has room between the head and the notes."""
        corners = [part.points for body in bodies for part in (body.fittings(), surface(body.tube))]
        if self.look.ghost:
            corners.append(surface(Tube.cylinder(self.result.muscle)).points)
        screen, _ = self.look.view.project(np.concatenate(corners) * MM)
        low, high = screen.min(axis=0), screen.max(axis=0)
        right, up, towards = self._directions()
        width, height = self.look.size
        letter = self._letters() / height
        top, bottom = TOP * letter, (BOTTOM if self.look.colour != PLAIN else TOP) * letter
        free = 1.0 - top - bottom
        across = 1.06 * max((high[1] - low[1]) / free, (high[0] - low[0]) * height / width)
        centre = (low + high) / 2.0 - np.array([0.0, (bottom - top) / 2.0 * across / self.look.zoom])
        focus = centre[0] * right + centre[1] * up
        camera = self.plotter.camera
        camera.parallel_projection = True
        camera.parallel_scale = across / 2.0 / self.look.zoom
        camera.focal_point, camera.position, camera.up = focus, focus + 10.0 * across * towards, up
        camera.clipping_range = (across, 20.0 * across)

    def _directions(self) -> tuple[Any, Any, Any]:
        """The screen's right and up, and the direction towards the viewer, in space."""
        screen, towards = self.look.view.project(np.eye(3))
        return screen[:, 0], screen[:, 1], towards

    def _write(self, top: str, bottom: list[str]) -> None:
        """The head and the notes."""
        size, (width, height) = self._letters(), self.look.size
        self._text("head", top, (size, height - 2.0 * size), size)
        lines = textwrap.wrap(" ".join([*bottom, self.note]), int(width / (0.45 * size)))
        self._text("notes", "\n".join(lines), (size, 0.6 * size), 0.75 * size)

    def _text(self, name: str, text: str, place: tuple[float, float], size: float, centred: bool = False) -> None:
        font = f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf"  # that of the other pictures; knows most letters
        made = self.plotter.add_text(
            text or " ", position=place, font_size=10, color=INK, font_file=font, name=name, render=False
        )
        made.prop.font_size = round(size)
        if centred:
            made.prop.justification_horizontal = "center"

    def _scale(self) -> None:
        """The scale of colours, below the muscle, with its numbers and what it means."""
        if self.plotter.scalar_bars:
            return
        (width, height), size = self.look.size, self._letters()
        name = "chamber" if self.look.on_chamber(self.result) else "fibres"
        wide = 0.5 if width >= height else 0.7
        left, bottom = (1.0 - wide) / 2.0, 3.6 * size / height
        self.plotter.add_scalar_bar(
            title=" ", mapper=self.plotter.actors[name].mapper, vertical=False, n_labels=0, color=INK,
            title_font_size=1, width=wide, height=2.4 * size / height, position_x=left, position_y=bottom,
            unconstrained_font_size=True, render=False,
        )  # fmt: skip
        numbers = [f"{value:#.3g}".rstrip(".") for value in np.linspace(*self.limits, 5)]
        for k, number in enumerate(numbers):  # VTK's own stand left or right of their place
            if k == 2 or numbers[0] != numbers[-1]:
                place = (left + 0.25 * k * wide) * width, 6.3 * size
                self._text(f"number {k}", number, place, 0.9 * size, centred=True)
        self._text("label", self.look.label(), (width / 2.0, 8.0 * size), size, centred=True)

    def _letters(self) -> float:
        """Size of letters for the size of the window."""
        return float(np.clip(min(self.look.size[1] / 34.0, self.look.size[0] / 48.0), 8.0, 60.0))


def poly_data(mesh: Mesh, scale: float) -> Any:
    """A mesh for PyVista, with its normals."""
    import pyvista

    made = pyvista.PolyData.from_regular_faces(mesh.points * scale, mesh.faces)
    made.point_data["Normals"] = mesh.normals
    made.point_data.active_normals_name = "Normals"
    return made
