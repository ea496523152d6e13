"""`Design`: the answer of a design, which can be solved further, and how it is made."""

from __future__ import annotations

import tomllib
import warnings
from typing import Any

import attrs
import numpy as np

from mckibben.designing.places import By, Place
from mckibben.designing.prices import Prices
from mckibben.designing.reading import places_of
from mckibben.designing.states import states_at
from mckibben.designing.tried import MET, Limit, Task, Tried, Worth
from mckibben.experiments.run import MuscleWarning, run
from mckibben.experiments.solve import solve
from mckibben.measure.report import versions
from mckibben.results.design import CURVES, STATES, Designed
from mckibben.results.result import Result, State
from mckibben.spec import Isobaric, Muscle, Path, SpecError
from mckibben.spec.text import muscle_from_mapping, to_toml
from mckibben.units import show

__all__ = ["Design", "answer"]

ROUNDED = {"force": 6, "contraction": 10}
"""Digits that mean something where the number is zero but for rounding."""
POINTS = 25
"""Points of a force-contraction curve."""


@attrs.frozen(eq=False, repr=False)
class Design(Designed):
    """What `design` gives: the best muscle, what it does at the states asked for, what limits it, and the front.

    `table` has the best values, `limits` the demands, `states` what the muscle does, `curves` its force over the
    contraction, `notes` what limits it and what more room would give; `front` the best compromises of several goals.

    Args:
        muscle: the best design; of a front, the one nearest to having the best of every goal.
        given: the muscle from which the design began.
        data: xarray Dataset of all this, in SI.

    >>> muscle = mk.presets.paper().replace("braid.angle", "45 deg")
    >>> pull = mk.ForceAt(pressure="1 bar", contraction="5 %")
    >>> best = mk.design(muscle, {"braid.angle": "42 deg to 50 deg"}, mk.Maximise(pull), designs=64)
    >>> best.feasible, best.table.loc["braid.angle", "value"]
    (True, '50 deg')
    """

    def solution(self, state: int | str = 0) -> State:
        """The full solution of the best muscle at one of its `states`, by number or name.

        >>> muscle = mk.presets.paper().replace("braid.angle", "45 deg")
        >>> pull = mk.ForceAt(pressure="1 bar", contraction="5 %")
        >>> best = mk.design(muscle, {"braid.angle": "42 deg to 50 deg"}, mk.Maximise(pull), designs=64)
        >>> best.solution(0).verdict == "stable"
        True
        """
        names = [str(name) for name in self.data["state"].values]
        if state not in names and state not in range(len(names)):
            raise SpecError("state", state, "is no state of this design", "choose from " + "; ".join(names))
        k = names.index(state) if isinstance(state, str) else int(state)
        length, pressure = (float(self.data[name].values[k]) for name in ("length", "pressure"))
        return solve(self.muscle, length=Path((length,), unit="m"), pressure=Path((pressure,), unit="Pa"))

    def member(self, design: int) -> Muscle:
        """A design of the front as a muscle, by its number."""
        if "front_muscle" not in self.data or design not in range(len(self.data["design"])):
            count = len(self.data["design"]) if "front_muscle" in self.data else 0
            raise SpecError("design", design, f"is no design of the front, which has {count}", "they count from 0")
        return muscle_from_mapping(tomllib.loads(str(self.data["front_muscle"].values[design])))


def _named_states(task: Task) -> dict[str, Place]:
    """The states at which designs are judged: their places by what they are, in words; ends of ranges are enough."""
    found: dict[str, Place] = {}
    for measure in task.measures:
        places = places_of(measure)
        ranged = hasattr(measure, "between")
        for place in (places[0], places[1 if measure.kind == "work" else -1]) if ranged else places:
            found.setdefault(_said(place), place)
    return found


def _said(place: Place) -> str:
    at = show(place.pressure, "Pa", 4)
    if place.pull is not None:
        where = show(place.at, "m", 4) if place.by == By.LENGTH else f"{100.0 * place.at:.4g} % contraction"
        return f"{show(place.pull, 'N', 4)} at {where}"
    if place.by == By.LENGTH:
        return f"{show(place.at, 'm', 4)} at {at}"
    if place.by == By.FORCE or (place.by == By.SHARE and place.at == 1.0):
        return f"{show(place.at, 'N', 4)} at {at}" if place.by == By.FORCE and place.at else f"free at {at}"
    if place.at == 0.0:
        return f"as made at {at}"
    return f"{100.0 * place.at:.4g} % contraction at {at}"


def _judged(task: Task, muscle: Muscle, tolerance: float) -> tuple[dict[str, Any], list[str]]:
    """Variables of the states and curves of a design, as `run` finds them, and what these say of a real muscle."""
    named = _named_states(task)
    seen = states_at(muscle, {}, 1, named.values(), tolerance) if named else None
    where = {name: tuple(float(seen.at(place, kind)[0]) for kind in ("length", "pressure")) if seen else (np.nan,) * 2
             for name, place in named.items()}  # fmt: skip
    rest = float(muscle.rest_length)
    rows: dict[str, list[float]] = {name: [np.nan] * len(named) for name in STATES}
    verdicts, curves, notes = ["not converged"] * len(named), [], []
    pressures = list(dict.fromkeys(pressure for _, pressure in where.values() if np.isfinite(pressure)))
    for pressure in pressures:
        own = [k for k, at in enumerate(where.values()) if at[1] == pressure and np.isfinite(at[0])]
        lengths = [list(where.values())[k][0] for k in own]
        ends = min(*lengths, rest, 0.99 * rest), max(*lengths, rest)
        points = np.concatenate([np.linspace(*ends, POINTS), lengths])
        order = np.argsort(-points, kind="stable")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MuscleWarning)  # the notes have them
            test = Isobaric(pressure=Path((pressure,), unit="Pa"), length=points[order].tolist())
            found = run(muscle, test)
        notes += [f"at {show(pressure, 'Pa', 4)}: {caution}" for caution in found.cautions]
        at = np.argsort(order)
        curves.append((found.contraction[at[:POINTS]], found.force[at[:POINTS]]))
        for k, row in zip(own, at[POINTS:].tolist(), strict=True):
            verdicts[k] = found.verdict[row]
            for name in STATES:
                rows[name][k] = _of_state(found, name, row)
    variables: dict[str, Any] = {
        name: ("state", np.array(values, float), dict(zip(("units", "long_name"), STATES[name], strict=True)))
        for name, values in rows.items()
    }
    variables["verdict"] = ("state", np.array(verdicts, str))
    variables["state"] = ("state", np.array(list(named), str))
    variables["curve"] = ("curve", np.array(pressures, float), {"units": "Pa", "long_name": "gauge pressure"})
    for k, (name, about) in enumerate(CURVES.items()):
        values = np.array([curve[k] for curve in curves]) if curves else np.zeros((0, POINTS))
        variables[name] = (("curve", "point"), values, dict(zip(("units", "long_name"), about, strict=True)))
    return variables, list(dict.fromkeys(notes))


def _of_state(found: Result, name: str, row: int) -> float:
    field = {"largest_radius": "r", "peak_fibre_tension": "fibre_tension"}.get(name)
    if field is not None:
        return float(found.data[field].values[row].max())
    value = float(found.data[name].values[row])
    return value if name not in ROUNDED else round(value, ROUNDED[name]) + 0.0


def answer(
    task: Task, fine: Tried, best: int, prices: Prices, front: tuple[np.ndarray, Worth] | None,
    about: dict[str, Any], notes: list[str],
) -> Design:  # fmt: skip
    """The answer from the best of those tried."""
    import xarray as xr

    space, x = task.space, fine.x[best]
    worth = fine.some(np.array([best]))
    muscle = space.muscle_at(x)
    values = space.values(x)
    found, cautions = _judged(task, muscle, about["tolerance"])
    axes = space.axes
    nan = float("nan")
    variables: dict[str, Any] = {
        "value": ("number", np.array([_number(value) for value in values])),
        "said": ("number", [axis.text(value) for axis, value in zip(axes, values, strict=True)]),
        "from": ("number", np.array([nan if axis.number is None else axis.number.low for axis in axes])),
        "to": ("number", np.array([nan if axis.number is None else axis.number.high for axis in axes])),
        "searched": ("number", [axis.searched for axis in axes]),
        "unit": ("number", [axis.unit or "1" for axis in axes]),
        "meaning": ("number", [axis.meaning for axis in axes]),
        "goal_value": ("goal", worth.goals[0]),
        "goal_kind": ("goal", [goal.measure.kind for goal in task.goals]),
        "goal_unit": ("goal", [goal.measure.unit for goal in task.goals]),
        "goal_display": ("goal", [goal.measure.display for goal in task.goals]),
        **_of_limits(task.limits, worth, prices), **found,
    }  # fmt: skip
    coords: dict[str, Any] = {
        "number": [axis.name for axis in axes], "goal": [goal.said for goal in task.goals],
        "limit": ("limit", np.array([limit.said for limit in task.limits], str)),
        **{name: variables.pop(name) for name in ("state", "curve")},
    }  # fmt: skip
    if front is not None:
        variables |= _of_front(task, *front)
        coords["design"] = np.arange(len(front[0]))
    attributes = about | {
        "muscle": to_toml(muscle, allow_custom=True), "given": to_toml(space.muscle, allow_custom=True),
        "notes": "\n".join([*notes, *prices.notes, *cautions]), "mckibben_version": versions()["mckibben"],
    }  # fmt: skip
    dataset = xr.Dataset(variables, coords, attributes)
    for name in dataset.variables:
        dataset[name].values.flags.writeable = False
    return Design(muscle, space.muscle, dataset)


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else float("nan")


def _of_limits(limits: tuple[Limit, ...], worth: Worth, prices: Prices) -> dict[str, Any]:
    measures = [limit.demand.measure for limit in limits]
    return {
        "limit_value": ("limit", worth.limited[0]),
        "limit_at": ("limit", np.array([limit.at for limit in limits], float)),
        "limit_over": ("limit", worth.over[0, :-1]),
        "limit_sign": ("limit", np.array([limit.sign for limit in limits], float)),
        "limit_met": ("limit", worth.over[0, :-1] <= MET),
        "limit_active": ("limit", prices.active),
        "limit_gain": ("limit", prices.limits),
        "limit_kind": ("limit", np.array([measure.kind for measure in measures], str)),
        "limit_unit": ("limit", np.array([measure.unit for measure in measures], str)),
        "limit_display": ("limit", np.array([measure.display for measure in measures], str)),
        "limit_pressure": ("limit", np.array([getattr(measure, "pressure", np.nan) for measure in measures], float)),
        "limit_force": ("limit", np.array([getattr(measure, "force", np.nan) for measure in measures], float)),
        "limit_contraction": ("limit", np.array([_contraction(measure) for measure in measures], float)),
    }  # fmt: skip


def _contraction(measure: Any) -> float:
    """Where a force is limited, for the picture; NaN for other measures."""
    if measure.kind != "force" or measure.length is not None:
        return float("nan")
    return float(measure.contraction or 0.0)


def _of_front(task: Task, x: np.ndarray, worth: Worth) -> dict[str, Any]:
    rows = [task.space.values(row) for row in x]
    texts = [[axis.text(value) for axis, value in zip(task.space.axes, row, strict=True)] for row in rows]
    muscles = [to_toml(task.space.muscle_at(row), allow_custom=True) for row in x]
    return {
        "front_value": (("design", "number"), np.array([[_number(value) for value in row] for row in rows])),
        "front_said": (("design", "number"), np.array(texts, str)),
        "front_goal": (("design", "goal"), worth.goals),
        "front_muscle": ("design", np.array(muscles, str)),
    }
