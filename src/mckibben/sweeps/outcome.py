"""What a sweep keeps of every design: variables per state and per design, each declared once.

Words are kept as small whole numbers that their attributes explain (`flag_values`, `flag_meanings`), because a hundred
thousand designs have millions of states. NaN and -1 stand for what was not computed.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import attrs
import numpy as np

from mckibben.results.result import Result
from mckibben.results.variables import FIELDS, STEP
from mckibben.results.verdict import Verdict

__all__ = [
    "DESIGN",
    "LATER",
    "METHODS",
    "STATES",
    "STATUSES",
    "Columns",
    "Kept",
    "Kinds",
    "Method",
    "Status",
    "empty",
    "keep",
    "keep_plain",
    "keep_states",
    "refuse",
]

Columns = dict[str, np.ndarray]
"""The variables of some designs: (designs, steps) or (designs)."""


class Status(StrEnum):
    """How far a design came."""

    COMPLETE = "complete"
    INCOMPLETE = "incomplete"  # part of its states have no admissible equilibrium or were not reached
    WRONG_INPUT = "wrong input"  # its values do not go together
    FAILED = "failed"  # the program failed on it


class Method(StrEnum):
    """Which solver found the states."""

    BATCH = "batch"
    SINGLE = "single"


VERDICTS, STATUSES, METHODS = tuple(Verdict), tuple(Status), tuple(Method)
ABSENT = -1


@attrs.frozen
class Kept:
    """One variable of a sweep."""

    dtype: str  #: "float64", "int8" or "str"
    attributes: dict[str, Any]

    @property
    def fill(self) -> Any:
        """What stands where nothing was computed."""
        return {"float64": np.nan, "str": ""}.get(self.dtype, ABSENT)


def _number(unit: str, meaning: str) -> Kept:
    return Kept("float64", {"long_name": meaning, "units": unit})


def _flags(words: tuple[StrEnum, ...], meaning: str, absent: str) -> Kept:
    values = [ABSENT, *range(len(words))]
    names = " ".join(str(word).replace(" ", "_") for word in (absent, *words))
    return Kept("int8", {"long_name": meaning, "flag_values": values, "flag_meanings": names})


_NUMBERS = (
    "length", "contraction", "force", "pressure", "volume", "air_volume", "energy_bending_1", "energy_bending_2",
    "energy_twist", "energy_chamber", "energy", "error_estimate", "residual",
)  # fmt: skip
_LARGEST = {"peak_fibre_tension": "fibre_tension", "largest_radius": "r"}
_COUNTS = ("modes_length_control", "modes_force_control", "modes_antisymmetric")

STATES: dict[str, Kept] = (
    {name: _number(*STEP[name]) for name in _NUMBERS}
    | {
        "peak_fibre_tension": _number(FIELDS["fibre_tension"][0], "largest tension of one fibre along the muscle"),
        "largest_radius": _number(FIELDS["r"][0], "largest radius along the muscle"),
        "verdict": _flags(VERDICTS, STEP["verdict"][1], "not_computed"),
    }
    | {name: Kept("int8", {"long_name": STEP[name][1], "units": "1"}) for name in _COUNTS}
)
"""Variables per design and state."""

LATER = ("air_volume",)
"""Variables that stores of earlier versions do not hold; NaN there."""

DESIGN: dict[str, Kept] = {
    "reason": Kept("str", {"long_name": "why a design is not complete"}),
    "method": _flags(METHODS, "which solver found the states", "none"),
    "status": _flags(STATUSES, "how far a design came", "pending"),
}
"""Variables per design; the last, `status`, says whether there is anything in the others."""


def empty(designs: int, steps: int) -> Columns:
    """The variables of designs of which nothing is known yet, to be filled in."""
    kinds = {"str": object}
    of_states = {
        name: np.full((designs, steps), kept.fill, kinds.get(kept.dtype, kept.dtype)) for name, kept in STATES.items()
    }
    return of_states | {
        name: np.full(designs, kept.fill, kinds.get(kept.dtype, kept.dtype)) for name, kept in DESIGN.items()
    }


def keep(columns: Columns, k: int, result: Result) -> None:
    """Put a result into the columns as design k. A branch may hold fewer states than were asked for."""
    n, data = len(result), result.data
    for name in (*_NUMBERS, *_COUNTS):
        columns[name][k, :n] = data[name].values
    for name, field in _LARGEST.items():
        columns[name][k, :n] = data[field].values.max(axis=1)  # NaN where a state is not there
    columns["verdict"][k, :n] = [VERDICTS.index(Verdict(word)) for word in result.verdict]
    complete = result.status == "complete"
    columns["status"][k] = STATUSES.index(Status.COMPLETE if complete else Status.INCOMPLETE)
    columns["method"][k] = METHODS.index(Method.SINGLE)
    if not complete:
        bad = next(i for i, word in enumerate(result.verdict) if word not in (Verdict.STABLE, Verdict.UNSTABLE))
        columns["reason"][k] = f"state {bad}: {data['reason'].values[bad]}"


@attrs.frozen
class Kinds:
    """What n states are: their verdicts, the reasons for them, and the counts of unstable modes."""

    verdicts: list[str]
    reasons: list[str]
    length_control: np.ndarray
    force_control: np.ndarray
    antisymmetric: np.ndarray


def keep_plain(
    columns: Columns, index: np.ndarray, numbers: dict[str, np.ndarray], stable_loads: np.ndarray, whole: bool
) -> None:
    """Put many designs (d, n) of a batch, stable in every state, into the columns at `index`; `whole` of those solved
    on the full length, whose antisymmetric modes are not told apart."""
    for name in (*_NUMBERS, *_LARGEST):
        columns[name][index] = numbers[name]
    columns["modes_length_control"][index] = 0
    columns["modes_antisymmetric"][index] = -1 if whole else 0
    columns["modes_force_control"][index] = np.where(stable_loads, 0, 1)
    columns["verdict"][index] = VERDICTS.index(Verdict.STABLE)
    columns["status"][index] = STATUSES.index(Status.COMPLETE)
    columns["method"][index] = METHODS.index(Method.BATCH)


def keep_states(columns: Columns, k: int, numbers: dict[str, np.ndarray], kinds: Kinds) -> None:
    """Put the states of one design of a batch into the columns as design k; of one that is no good they are NaN."""
    good = np.isin(kinds.verdicts, [Verdict.STABLE, Verdict.UNSTABLE])
    for name in (*_NUMBERS, *_LARGEST):
        columns[name][k] = np.where(good, numbers[name], np.nan)
    for name in ("length_control", "force_control", "antisymmetric"):
        columns[f"modes_{name}"][k] = getattr(kinds, name)
    columns["verdict"][k] = [VERDICTS.index(Verdict(word)) for word in kinds.verdicts]
    columns["status"][k] = STATUSES.index(Status.COMPLETE if good.all() else Status.INCOMPLETE)
    if not good.all():
        bad = int(np.argmin(good))
        columns["reason"][k] = f"state {bad}: {kinds.reasons[bad]}"


def refuse(columns: Columns, k: int, status: Status, reason: str) -> None:
    """Note that there is nothing of design k, and why."""
    columns["status"][k] = STATUSES.index(status)
    columns["reason"][k] = " ".join(reason.split())
