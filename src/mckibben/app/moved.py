"""A motion for people and for programs: its summary as tables and JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mckibben.app.console import say, table
from mckibben.app.outputs import finite
from mckibben.units import show

if TYPE_CHECKING:
    from mckibben.results.motion import Motion

__all__ = ["as_json", "described", "show_motion"]

SHOWN = 12
"""Events that are shown."""


def show_motion(motion: Motion, seconds: float) -> None:
    """Print the summary, what happened, and the notes."""
    frame = motion.summary()
    rows = [(str(name), *map(str, row)) for name, row in zip(frame.index, frame.values.tolist(), strict=True)]
    title = f"Motion of {motion.data.attrs['title']}, {show(float(motion.time[-1]), 's', 4)}"
    say(table(("", *frame.columns), rows, title=title, right=(1, 2, 3, 4), whole=(0, 1, 2, 3, 4)), whole=True)
    events = motion.events
    for time, event in events.values.tolist()[:SHOWN]:
        say(f"{show(float(time), 's', 5)}: {event}")
    if len(events) > SHOWN:
        say(f"... {len(events) - SHOWN} more events")
    if not motion.complete:
        say(f"not complete: {motion.reason}")
    for note in motion.notes:
        say(f"- {note}")
    say(f"{motion.data.attrs['steps']} steps in {seconds:.2g} s")


def as_json(motion: Motion, files: dict[str, str | None]) -> dict[str, Any]:
    """The first, last, least and largest values in SI units, events and notes for JSON."""
    data = motion.data
    found: dict[str, Any] = {}
    for name, variable in data.data_vars.items():
        if variable.dtype.kind == "f":
            first, last = variable.values[0], variable.values[-1]
            found[str(name)] = {
                "unit": str(variable.attrs["units"]), "first": first.tolist(), "last": last.tolist(),
                "least": finite(float(variable.min())), "largest": finite(float(variable.max())),
            }  # fmt: skip
    return {
        "complete": motion.complete, "reason": motion.reason, "time": float(motion.time[-1]), "values": found,
        "inside": motion.inside, "events": motion.events.values.tolist(), "notes": list(motion.notes),
        "steps": int(data.attrs["steps"]), "mckibben_version": str(data.attrs["mckibben_version"]), **files,
    }  # fmt: skip


def described(motion: Motion) -> list[tuple[str, str]]:
    """What a saved motion is, in rows of a name and a text."""
    about = motion.data.attrs
    rows = [
        (
            "holds",
            f"the motion of {about['title']}, {len(motion.time)} times to {motion.time[-1]:.4g} s",
        ),
        ("made", f"with mckibben {about['mckibben_version']}, by {about['method']} at {about['tolerance']:g}"),
        ("complete", "yes" if motion.complete else motion.reason),
    ]
    frame = motion.summary()
    rows += [(str(name), f"{row[0]} to {row[1]}, between {row[2]} and {row[3]}")
             for name, row in zip(frame.index, frame.values.tolist(), strict=True)]  # fmt: skip
    return [*rows, *(("note", note) for note in motion.notes)]
