"""The picture of a motion: what moves, pressure, force and air over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mckibben.results.motion import Motion
from mckibben.spec.controls import PID
from mckibben.spec.errors import SpecError
from mckibben.units import from_si
from mckibben.view import style
from mckibben.view.words import sentence

__all__ = ["MANY", "energies", "lines", "marks", "moved", "moves", "names", "outside", "target", "words"]

WIDE, TALL = style.PAGE, 4.6
MANY = 40
"""Events up to which each is marked."""


def moved(motion: Motion) -> Figure:
    """Four panels over time: length, or the angle of a pulley; pressure and command; force; air taken and energies.

    Times outside of the map are shaded, events marked; a target is dashed.
    """
    figure = style.new_figure(WIDE, TALL)
    panels = figure.subplots(2, 2, sharex=True)
    moves(panels[0, 0], motion)
    lines(panels[0, 1], motion, "pressure", "Pa")
    _commands(panels[0, 1], motion)
    lines(panels[1, 0], motion, "force", "N")
    _energies(panels[1, 1], motion)
    for axes in panels.ravel():
        marks(axes, motion)
    for axes in panels[1]:
        axes.set_xlabel("Time (s)")
    for axes, letter in zip(panels.ravel(), "abcd", strict=True):
        style.panel(axes, letter)
    heading, notes = words(motion)
    style.heading(figure, heading)
    style.note(figure, " ".join(notes))
    return figure


def words(motion: Motion) -> tuple[str, list[str]]:
    """The heading, and the notes below."""
    notes = [*((f"not complete: {motion.reason}",) if motion.reason else ()), *motion.notes]
    heading = f"Motion of {motion.data.attrs['title']}; {motion.consumed:.3g} normal litres of air"
    return heading, [sentence(line) for line in notes]


def outside(motion: Motion) -> np.ndarray:
    """Whether a muscle is outside of the range of its map, at each time."""
    return np.asarray(~motion.of("inside").reshape(len(motion.time), -1).all(axis=1))


def moves(axes: Axes, motion: Motion) -> None:
    """What moves over time: the length, or the angle of a pulley; a target is dashed."""
    if "angle" in motion.data:
        axes.plot(motion.time, style.shown(motion.angle, "rad"), color=style.BLUE, label="angle")
        axes.set_ylabel(style.axis_label("angle", "rad"))
        _target(axes, motion, "angle", "rad")
        style.tidy(axes, legend="best")
        return
    lines(axes, motion, "length", "m")
    _target(axes, motion, "length", "m")


def target(motion: Motion, of: str) -> np.ndarray | None:
    """The target [SI] over time of a PID controller of what is drawn; None where there is none."""
    try:
        command = motion.rig.command
    except SpecError:  # a Python function, which a motion does not hold
        return None
    if not (isinstance(command, PID) and str(command.of) == of):
        return None
    return np.array([command.target(float(t)) for t in motion.time])


def _target(axes: Axes, motion: Motion, of: str, unit: str) -> None:
    wanted = target(motion, of)
    if wanted is not None:
        shown = style.shown(wanted, unit)
        axes.plot(motion.time, shown, color=style.GREY, linestyle="--", linewidth=1.0, label="target")


def names(motion: Motion) -> Sequence[str]:
    """Names of the muscles; one without a name where there is one."""
    return [str(one) for one in motion.data["muscle"].values] if motion.several else [""]


def lines(axes: Axes, motion: Motion, name: str, unit: str) -> None:
    """A variable of each muscle over time."""
    values = motion.of(name).reshape(len(motion.time), -1)
    for k, label in enumerate(names(motion)):
        axes.plot(
            motion.time, style.shown(values[:, k], unit), color=style.LINES[k], linewidth=1.2, label=label or None
        )
    axes.set_ylabel(style.axis_label(f"gauge {name}" if name == "pressure" else name, unit))
    style.tidy(axes, legend="upper left" if name == "pressure" else "best")


def _commands(axes: Axes, motion: Motion) -> None:
    """The command of each valve, on an axis of its own."""
    other = axes.twinx()
    values = motion.of("command").reshape(len(motion.time), -1)
    for k in range(values.shape[1]):
        other.plot(motion.time, values[:, k], color=style.LINES[k], linewidth=0.6, alpha=0.5, drawstyle="steps-post")
    other.set_ylim(-1.08, 4.0)  # the lower part of the panel
    other.set_yticks([-1.0, 0.0, 1.0], ["vent", "0", "fill"])
    other.set_ylabel("Command (thin)", fontsize=style.TICK, loc="bottom")
    other.tick_params(labelsize=style.TICK - 0.5, width=0.5, length=2.0)
    for side in ("top", "left"):
        other.spines[side].set_visible(False)
    low, high = axes.get_ylim()
    axes.set_yticks([tick for tick in axes.get_yticks() if low <= tick <= high])
    axes.set_ylim(low - 0.35 * (high - low), high)


def energies(motion: Motion) -> dict[str, tuple[np.ndarray, str]]:
    """Energies [J] over time that are not zero throughout, by their names, with their colours."""
    work = motion.of("work").reshape(len(motion.time), -1).sum(axis=1)
    all_of = {"work on the load": (work, style.BLUE), "lost": (motion.of("lost"), style.VERMILLION),
              "kinetic": (motion.of("kinetic"), style.GREEN)}  # fmt: skip
    return {name: (values, colour) for name, (values, colour) in all_of.items() if np.abs(values).max() > 0.0}


def _energies(axes: Axes, motion: Motion) -> None:
    axes.plot(motion.time, motion.of("consumed"), color=style.BLACK, linewidth=1.2, label="air taken (L)")
    axes.set_ylabel("Air taken (normal L)")
    other = axes.twinx()
    for label, (values, colour) in energies(motion).items():
        other.plot(motion.time, from_si(values, "J"), color=colour, linewidth=1.0, label=label)
    handles, labels = axes.get_legend_handles_labels()
    more, further = other.get_legend_handles_labels()
    other.set_ylabel("Energy (J)", fontsize=style.LABEL)
    other.tick_params(labelsize=style.TICK, width=0.6, length=2.5)
    for side in ("top", "left"):
        other.spines[side].set_visible(False)
    if not more:
        other.set_axis_off()
    style.tidy(axes)
    axes.legend(handles + more, labels + further, loc="upper left", fontsize=style.TICK - 0.5, frameon=False)


def marks(axes: Axes, motion: Motion) -> None:
    """Where the map is outside of its range, and when something happened."""
    out = outside(motion)
    if out.any():
        axes.fill_between(motion.time, 0.0, 1.0, where=out.tolist(), color="0.9", transform=axes.get_xaxis_transform(),
                          zorder=0, linewidth=0.0)  # fmt: skip
    times = motion.events["time"].tolist()
    for t in times if len(times) <= MANY else ():
        axes.axvline(t, color=style.GREY, linewidth=0.5, linestyle=":")
