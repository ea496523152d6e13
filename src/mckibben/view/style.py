"""House style of the pictures: sizes, colours, labels with units, notes, and writing to disk.

Figures are made without pyplot, so nothing global is kept: pictures can be drawn in threads and without a display.
"""

from __future__ import annotations

import os
import textwrap
from collections.abc import Iterable
from pathlib import Path
from threading import Lock
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ..spec import Muscle, SpecError
from ..units import DISPLAY, from_si

COLUMN, PAGE = 3.5, 7.16
"""Widths [inch] of a column and of a page of a two-column paper."""

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILLION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
LINES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Colours of Okabe and Ito, which colour-blind readers can tell apart; yellow is too faint for lines."""

DENSITY_MESH, DENSITY_CHAMBER, SEQUENCE = "viridis", "cividis", "viridis"
"""Colour maps of even perceived steps."""

GREY = "0.45"
LABEL, TICK, NOTE = 8.0, 7.0, 5.5
"""Font sizes [pt] at print size."""

_WRITING = Lock()


def new_figure(width: float = COLUMN, height: float = 2.6) -> Figure:
    """An empty figure of a given size [inch] that no global state knows of."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def shown(values: Any, unit: str) -> Any:
    """SI values in the unit that people see: m in mm, Pa in bar, rad in deg, J in mJ."""
    return from_si(values, DISPLAY.get(unit, unit))


def axis_label(meaning: str, unit: str) -> str:
    """Label of an axis: axis_label("force", "N") is "Force (N)"; `unit` is SI or the unit shown, "1" or "" is none."""
    written = DISPLAY.get(unit, unit)
    for power, raised in (("^2", "²"), ("^3", "³"), ("^4", "⁴")):
        written = written.replace(power, raised)
    first = meaning[:1].upper() + meaning[1:]
    return first if written in ("", "1") else f"{first} ({written})"


def tidy(axes: Axes, legend: str | None = None, **options: Any) -> Axes:
    """Fonts, spines and grid of the house; with `legend` a legend at that place."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_linewidth(0.6)
    axes.tick_params(labelsize=TICK, width=0.6, length=2.5)
    axes.tick_params(which="minor", width=0.4, length=1.5)
    for label in (axes.xaxis.label, axes.yaxis.label, axes.title):
        label.set_fontsize(LABEL)
    axes.grid(True, color="0.9", linewidth=0.5)
    axes.set_axisbelow(True)
    if legend is not None and axes.get_legend_handles_labels()[0]:
        settings: dict[str, Any] = {"loc": legend, "fontsize": TICK - 0.5, "frameon": False, "handlelength": 2.2}
        axes.legend(**settings | options)
    return axes


def panel(axes: Axes, letter: str) -> None:
    """Letter of a panel, in its upper left corner outside the axes."""
    axes.set_title(letter, loc="left", fontsize=LABEL, fontweight="bold", pad=4.0)


def colour_bar(figure: Figure, colours: Any, place: Any, label: str, **options: Any) -> Any:
    """A colour bar in the house's fonts."""
    bar = figure.colorbar(colours, ax=place, **({"aspect": 28, "pad": 0.02} | options))
    bar.set_label(label, fontsize=TICK)
    bar.ax.tick_params(labelsize=TICK - 0.5, width=0.5, length=2.0)
    bar.outline.set_linewidth(0.5)
    return bar


def note(figure: Figure, text: str) -> None:
    """A small note below everything; several notes stand below each other."""
    width = int(figure.get_figwidth() * 72.0 / (0.57 * NOTE))
    lines = [figure.get_supxlabel(), *textwrap.wrap(text, width)]
    figure.supxlabel("\n".join(line for line in lines if line), fontsize=NOTE, color=GREY, x=0.01, ha="left")


def assumption_note(figure: Figure, muscle: Muscle) -> None:
    """Say in the picture which values of the muscle are assumptions; nothing if there are none."""
    groups = (
        ("fibre count", "braid.fibres"),
        ("fibre values", "braid.fibre."),
        ("chamber values", "chamber"),
        ("end condition", "ends"),
    )
    words = [word for word, start in groups if any(_within(name, start) for name in muscle.assumed)]
    known = [start for _, start in groups]
    words += [name for name in muscle.assumed if not any(_within(name, start) for start in known)]
    if not words:
        return
    said = (", ".join(words[:-1]) + " and " if words[1:] else "") + words[-1]
    said = said.replace("fibre values, chamber values", "fibre and chamber values")
    said = said.replace("fibre values and chamber values", "fibre and chamber values")
    reason = ": the paper does not print them" if (muscle.name or "").startswith("paper") else ""
    verb = "is" if words == ["fibre count"] or words == ["end condition"] else "are"
    note(figure, f"{said[0].upper()}{said[1:]} {verb} assumed{reason}.")


def _within(name: str, start: str) -> bool:
    return name == start or (name + ".").startswith(start if start.endswith(".") else start + ".")


def save(figure: Figure, stem: str | os.PathLike[str], formats: Iterable[str] = ("pdf", "png")) -> tuple[Path, ...]:
    """Write a figure as STEM.pdf and STEM.png (200 dpi); a reader never sees half a file.

    Returns the paths. Raises SpecError for a place that cannot be written.
    """
    paths = []
    for kind in formats:
        path = Path(f"{os.fspath(stem)}.{kind}")
        part = path.with_name(f".{path.name}.{os.getpid()}.part")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            try:
                _write(figure, part, kind)
                os.replace(part, path)
            finally:
                part.unlink(missing_ok=True)
        except OSError as error:
            raise SpecError("picture", str(path), f"cannot be written: {error.strerror or error}") from error
        paths.append(path)
    return tuple(paths)


def _write(figure: Figure, path: Path, kind: str) -> None:
    """One file without a date, so that equal pictures are equal files; fonts as journals want them (TrueType)."""
    nothing = {"pdf": {"CreationDate": None}, "svg": {"Date": None}}.get(kind)
    with _WRITING:
        before = matplotlib.rcParams["pdf.fonttype"]
        matplotlib.rcParams["pdf.fonttype"] = 42
        try:
            figure.savefig(path, format=kind, dpi=200, metadata=nothing)
        finally:
            matplotlib.rcParams["pdf.fonttype"] = before
