"""`scene()`: a muscle in three dimensions, by PyVista."""

from __future__ import annotations

from typing import Any

from mckibben.view.appearance import Appearance, the_result, the_state
from mckibben.view.stage import Stage

__all__ = ["scene"]


def scene(
    result: Any, state: int | None = None, *, colour: str | None = "fibre_tension", cut: bool = False,
    translucent: bool = False, ghost: bool = False, axis: str = "horizontal", tilt: float = 18.0, turn: float = 0.0,
    zoom: float = 1.0, size: Any = None, off_screen: bool | None = None,
) -> Any:  # fmt: skip
    """One state in three dimensions: fibres over and under each other, the chamber inside, the end fittings.

    Nothing is solved. Fibres have their own diameter (where none is given, 0.35 of the room between neighbours, and the
    picture says so), and lie by turns half a diameter outside and inside of the surface that the model computes, as in
    a plain weave. The chamber is drawn inside, with its thickness as deformed, on whichever side the model has it. The
    fittings are no part of the model. A braid of more than some 100,000 crossings is drawn with fewer fibres, which the
    picture says.

    It takes PyVista: pip install "mckibben[view]"; without a display also EGL or OSMesa (Debian: libegl1 and
    libgl1-mesa-dri, or libosmesa6).

    Args:
        result: what `run`, `solve` or `load` gave.
        state: number of the state, from 0, or from the end -1, -2, ...; the last that was reached where left out.
        colour: variable along the muscle that colours fibres ("fibre_tension", "density_fibres", "density_twist",
            "theta", "fibre_stretch", ...) or chamber ("stretch_hoop", "density_chamber", "contact_pressure", ...); the
            scale of colours has the unit for people. None or "none" for plain colours.
        cut: cut a sector out of braid and chamber, so that the wall shows.
        translucent: a chamber that one can see through.
        ghost: the muscle as made, faintly, fixed at the same end.
        axis: the muscle lies "horizontal" or stands "vertical".
        tilt: angle [deg] by which the far end leaves the viewer.
        turn: angle [deg] by which the muscle is turned about its axis.
        zoom: how many times larger than fits the window, around the middle; from 0.1 to 100.
        size: width and height of the window in pixels; (1200, 600), of a vertical muscle (700, 1000), where left out.
        off_screen: True to draw without a window; where left out, that is so where there is no display.

    Returns:
        A PyVista Plotter, in mm. `.show()` opens a window, and `.screenshot("x.png")` of one that is off screen writes
        a picture. A notebook shows it by itself; with `pyvista[jupyter]` installed, `.show()` gives one to be turned.

    Raises:
        SpecError: for a state that was not reached, an unknown colour, PyVista missing, or a machine that cannot draw.

    >>> state = mk.solve(mk.presets.paper(), length="115 mm", pressure="1 bar")
    >>> mk.scene(state, cut=True, ghost=True).show()  # doctest: +SKIP
    >>> try:
    ...     mk.scene(state, colour="tension")
    ... except mk.SpecError as error:
    ...     print(error)
    scene.colour = tension: is unknown; did you mean "fibre_tension"?
    """
    shape = the_result("scene", result)
    look = Appearance.of("scene", shape, colour, cut, translucent, ghost, axis, tilt, turn, zoom, size)
    number = the_state("scene", shape, state)
    stage = Stage.of("scene", shape, look, [number], off_screen)
    stage.show(number)
    return stage.plotter
