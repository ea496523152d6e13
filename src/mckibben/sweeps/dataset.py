"""From the designs in a row to a Dataset with named dimensions."""

from __future__ import annotations

import datetime
import json
from typing import Any

import numpy as np
import xarray as xr

import mckibben.results.swept  # noqa: F401  # whoever has a sweep has `data.mckibben`, and sees it in a notebook
from mckibben.measure.report import versions
from mckibben.spec.text import to_toml
from mckibben.sweeps.outcome import DESIGN, STATES, Columns, empty
from mckibben.sweeps.plan import Plan

__all__ = ["Memory", "about", "arranged", "coordinates", "flat"]


def about(plan: Plan) -> dict[str, Any]:
    """Attributes that the Dataset of a sweep carries; `sweep` holds what its numbers depend on, as JSON."""
    dims = ["design"] if plan.table else [varied.field for varied in plan.varied]
    over = None if plan.table else json.dumps({varied.field: varied.plain for varied in plan.varied})
    return {
        "title": f"sweep of {len(plan)} McKibben muscles, {plan.test.kind} test",
        "muscle": to_toml(plan.muscle, allow_custom=True),
        "test": to_toml(plan.test),
        "over": over or ", ".join(varied.field for varied in plan.varied),
        "dimensions": json.dumps(dict(zip(dims, plan.shape, strict=True))),
        "tolerance": plan.tolerance,
        "assumed": ", ".join(plan.muscle.assumed),
        "mckibben_version": versions()["mckibben"],
        "versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "sweep": json.dumps(plan.identity()),
        "source": "Quaglierini, Arroyo, DeSimone, RoboSoft 2023",
    }


def coordinates(plan: Plan) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
    """What each field is in each design, along `design`; and the states along `step`."""
    found = {}
    places = np.arange(len(plan))
    at = [places] * len(plan.varied) if plan.table else list(np.unravel_index(places, plan.shape))
    for varied, index in zip(plan.varied, at, strict=True):
        found[varied.field] = ("design", varied.coordinate[index], varied.about)
    return found | {"step": ("step", np.arange(plan.steps), {"long_name": "state"})}


def flat(plan: Plan, columns: Columns) -> xr.Dataset:
    """The variables of all designs, in a row."""
    kinds = [(STATES, ("design", "step")), (DESIGN, ("design",))]
    variables = {
        name: (dims, columns[name], dict(kept.attributes))
        for declared, dims in kinds
        for name, kept in declared.items()
    }
    return xr.Dataset(variables, coordinates(plan), about(plan))


def arranged(data: xr.Dataset) -> xr.Dataset:
    """A Dataset of designs in a row with a dimension for each field of the grid, or along `design` for a table."""
    shape: dict[str, int] = json.loads(data.attrs["dimensions"])
    fields = [name for name, coordinate in data.coords.items() if coordinate.dims == ("design",)]
    if list(shape) == ["design"]:
        return data.set_coords(fields)
    axes: dict[Any, Any] = {"step": data.coords["step"].variable}
    sizes = tuple(shape.values())
    for axis, name in enumerate(shape):
        first = tuple(slice(None) if k == axis else 0 for k in range(len(sizes)))
        values = data.coords[name].values.reshape(sizes)[first]
        axes[name] = (name, values, data.coords[name].attrs)
    made = {
        name: ((*shape, *variable.dims[1:]), variable.data.reshape(*sizes, *variable.shape[1:]), variable.attrs)
        for name, variable in data.variables.items()
        if name not in data.coords
    }
    return xr.Dataset(made, axes, data.attrs)


class Memory:
    """A sweep kept in memory, read and written like a store."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.missing = list(range(plan.chunks))
        self._columns = empty(len(plan), plan.steps)

    def put(self, index: int, columns: Columns) -> None:
        """Keep the designs of a chunk."""
        for name, values in columns.items():
            self._columns[name][self.plan.within(index)] = values

    def dataset(self) -> xr.Dataset:
        """All designs, arranged by their fields."""
        return arranged(flat(self.plan, self._columns))
