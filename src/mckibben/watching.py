"""How far long work is, told to whoever waits: a bar in a terminal or in a notebook."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import Any, Protocol

__all__ = ["Watch", "progress", "unseen"]

OFTEN = 0.2
"""Seconds between two pictures of a bar in a notebook."""


class Watch(Protocol):
    """A function that is called with (done, in all) and, where the work has several parts, the name of the next one.

    In all is 0 where nobody knows.
    """

    def __call__(self, done: int, total: int = 0, what: str = "", /) -> None: ...


@contextmanager
def progress(what: str = "done", *, unit: str = "") -> Iterator[Watch]:
    """A bar for long calls: `with mk.progress("fit") as watch: mk.fit(..., watch=watch)`.

    In a terminal it is drawn on stderr and leaves nothing behind; in a notebook it takes no widgets, and the last word
    on it stays. Where neither is, as in a log, nothing is written.

    Args:
        what: what is under way, in a word or two.
        unit: what is counted ("designs"); then the terminal also tells how many are done a second.

    Returns:
        A context; within it a function to hand to the `watch` of any call that has one.

    Raises:
        Nothing of its own: what ends the work early goes on its way, and the bar of a notebook says so.

    >>> test = mk.FreeContraction(pressure="1 bar")
    >>> with mk.progress("sweep", unit="designs") as watch:
    ...     data = mk.sweep(mk.presets.paper(), test, {"braid.angle": ["36 deg", "37 deg"]}, watch=watch)
    """
    if _in_notebook():
        bar = _Bar(what)
        try:
            yield bar.watch
        except BaseException:
            bar.end("ended")
            raise
        bar.end("done")
        return
    from rich.console import Console

    console = Console(stderr=True, highlight=False, markup=False, emoji=False)
    with _in_terminal(console, what, unit) if console.is_terminal else unseen() as watch:
        yield watch


@contextmanager
def unseen() -> Iterator[Watch]:
    """A function to call that shows nothing."""
    yield lambda done, total=0, what="", /: None


def _in_notebook() -> bool:
    """Whether this is the kernel of a notebook, which is so only after IPython was imported."""
    found = sys.modules.get("IPython")
    shell = None if found is None else found.get_ipython()
    return shell is not None and hasattr(shell, "kernel")


class _Bar:
    """A bar of HTML that is drawn anew in its place."""

    def __init__(self, what: str) -> None:
        from IPython import display

        self._what, self._done, self._total, self._said = what, 0, 0, "begun; what is new is compiled first"
        self._begun = self._drawn = time.perf_counter()
        self._first: tuple[float, int] | None = None
        shown: Any = display.display
        self._place: Any = shown(self, display_id=True)

    def watch(self, done: int, total: int = 0, what: str = "", /) -> None:
        now = time.perf_counter()
        self._first = self._first or (now, done)
        self._done, self._total, self._what = done, total, what or self._what
        count = f"{done} of {total}" if total else f"{done}"
        left = (now - self._first[0]) * (total - done) / max(done - self._first[1], 1)
        self._said = f"{count}, {_time(now - self._begun)}" + (f", about {_time(left)} left" if done < total else "")
        if now - self._drawn >= OFTEN or done == total:
            self._drawn = now
            self._place.update(self)

    def end(self, how: str) -> None:
        took = _time(time.perf_counter() - self._begun)
        self._said = f"{self._done} {how} in {took}" if self._done else f"{how} in {took}"
        self._total = self._total or max(self._done, 1)
        self._place.update(self)

    def __repr__(self) -> str:
        return f"{self._what}: {self._said}"

    def _repr_html_(self) -> str:
        known = f' value="{min(self._done, self._total)}" max="{self._total}"' if self._total else ""
        return f"<progress{known}></progress> {escape(repr(self))}"


def _time(seconds: float) -> str:
    whole = round(seconds)
    return (
        f"{seconds:.1f} s" if seconds < 10.0 else f"{whole} s" if whole < 120 else f"{whole // 60} min {whole % 60} s"
    )


@contextmanager
def _in_terminal(console: Any, what: str, unit: str) -> Iterator[Watch]:
    """The bar shows the time elapsed and the time left, and with `unit` how many are done a second.

    What was done before the first call, as when a sweep goes on, does not count for these.
    """
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Elapsed(TimeElapsedColumn):
        """Time since the work began, with its label."""

        def render(self, task: Any) -> Text:
            return Text.assemble("elapsed ", super().render(task))

    class Left(TimeRemainingColumn):
        """Time that is left, with its label."""

        def render(self, task: Any) -> Text:
            return Text.assemble("left ", super().render(task))

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        *((TextColumn("{task.fields[rate]}"),) if unit else ()),
        Elapsed(),
        Left(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(f"{what}: compiling", total=None, rate="")
        begun = False

        def watch(done: int, total: int = 0, part: str = "", /) -> None:
            nonlocal begun
            if unit and not begun:
                bar.reset(task, completed=done, total=total or None)
                begun = True
            speed = bar.tasks[0].speed
            rate = f"{speed:.3g} {unit}/s" if unit and speed else ""
            bar.update(task, description=part or what, completed=done, total=total or None, rate=rate)

        yield watch
