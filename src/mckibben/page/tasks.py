"""The tasks of a page by name: what its working processes can be asked for."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

from mckibben.page.plain import encoded
from mckibben.spec import SpecError

__all__ = ["TASKS", "TaskError", "perform"]

Tell = Callable[[str, str], None]
"""Called with the name of a part of an answer, and the part as JSON."""


class TaskError(Exception):
    """A task that could not be done, in one sentence for whoever asked."""


def perform(task: str, said: Mapping[str, Any], tell: Tell) -> str:
    """Do a task: its answer as JSON. TaskError, in one line, where what was said is wrong."""
    if task not in TASKS:
        raise TaskError(f'there is no task "{task[:40]}"')
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # cautions are part of what is told
            return encoded(TASKS[task](said, lambda name, part: tell(name, encoded(part))))
    except SpecError as error:
        raise TaskError(str(error)) from error


def _open(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.opening import opened

    return opened(said)


def _case(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.opening import opened_file

    return opened_file(said["path"], said["name"])


def _seen(name: str, said: Mapping[str, Any]) -> Any:
    """A look, or its curves. A kind of muscle that is new to this process takes its time, and is looked at only where
    `first` says so: else the answer is what has to be prepared."""  # fmt: skip
    from mckibben.page.asked import asked_of
    from mckibben.page.curves import curves
    from mckibben.page.look import look
    from mckibben.page.muscles import kind_of

    asked = asked_of(said)
    kind = f"{name} of {kind_of(asked.muscle)}"
    if kind not in _KNOWN and said.get("first") is not True:
        return {"prepare": kind}
    found = (look if name == "look" else curves)(asked)
    _KNOWN.add(kind)
    return found


_KNOWN: set[str] = set()
"""Kinds of muscles whose functions are at hand in this process."""


def _reach(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.asked import asked_of
    from mckibben.page.reach import reach

    return reach(asked_of(said))


def _file(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.downloads import written

    return written(said["kind"], said["asked"], said["folder"])


def _data(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.measured import data_of, described, sheets_of

    several = sheets_of(said)
    return {"sheets": several} if several else described(data_of(said), said["name"])


def _measured(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.asked import asked_of
    from mckibben.page.measured import data_of, measured

    return measured(asked_of(said), data_of(said), said["name"])


def _effects(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.asked import asked_of
    from mckibben.page.jobs import effects_of

    return effects_of(asked_of(said), tell)


def _fit(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.asked import asked_of
    from mckibben.page.jobs import fitted

    return fitted(asked_of(said), said, tell)


def _design(said: Mapping[str, Any], tell: Any) -> Any:
    from mckibben.page.asked import asked_of
    from mckibben.page.wanted import designed

    return designed(asked_of(said), said, tell)


TASKS: dict[str, Callable[[Mapping[str, Any], Callable[[str, Any], None]], Any]] = {
    "open": _open, "case": _case, "look": lambda said, tell: _seen("look", said),
    "curves": lambda said, tell: _seen("curves", said), "reach": _reach, "file": _file,
    "data": _data, "measured": _measured, "effects": _effects, "fit": _fit, "design": _design,
}  # fmt: skip
