"""From the states of a simulation to its answer: what was seen, energies, and what must be known of it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from mckibben.motion.drive import Driven
from mckibben.motion.energies import of_muscles, of_rig
from mckibben.motion.mapped import Mapped
from mckibben.motion.plant import Plant
from mckibben.motion.regime import Seen
from mckibben.results.motion import HANGING, OF_MUSCLES, OF_RIG, TURNING, Motion
from mckibben.spec.loads import FixedEnd, Load
from mckibben.spec.rigtext import rig_to_toml
from mckibben.units import show

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["recorded"]

NAMES = ("agonist", "antagonist")
UNBALANCED = 1e-3
"""Error of the energies, over the largest of them, that is told."""
PUSHES = 1e-3
"""Share of the largest force from which a muscle that pushes is told of."""


def recorded(plant: Plant, done: Driven, method: str, tolerance: float) -> Motion:
    """The answer."""
    y = np.array(done.states)
    seen = {
        name: np.array([[getattr(one, name) for one in rates.muscles] for rates in done.seen]) for name in Seen._fields
    }
    muscles = {name: np.array(values) for name, values in of_muscles(plant, y, seen).items()}
    variables: dict[str, Any] = {}
    several = plant.n > 1
    dims = ("time", "muscle") if several else ("time",)
    for name, (unit, meaning) in OF_MUSCLES.items():
        values = muscles[name] if several else muscles[name][:, 0]
        variables[name] = (dims, values, {"units": unit, "long_name": meaning})
    for name, meaning in (("inside", "whether the map is good there"), ("slack", "whether its cable is slack")):
        values = seen[name].astype(bool)
        variables[name] = (dims, values if several else values[:, 0], {"long_name": meaning})
    for name, values in of_rig(plant, y, muscles).items():
        values = np.array(values)
        unit, meaning = (OF_RIG | TURNING | HANGING)[name]
        variables[name] = (("time",), values, {"units": unit, "long_name": meaning})
    variables["moves"] = (
        ("time",),
        np.array(done.modes),
        {"long_name": "how the load moves: free, stuck, or at an end stop"},
    )
    coords: dict[str, Any] = {"time": ("time", np.array(done.times), {"units": "s", "long_name": "time"})}
    if several:
        coords["muscle"] = ("muscle", np.array(NAMES), {})
    for _, array, *_ in variables.values():
        array.flags.writeable = False
    return Motion(_dataset(variables, coords, _about(plant, done, seen, variables, method, tolerance)))


def _dataset(variables: dict[str, Any], coords: dict[str, Any], about: dict[str, Any]) -> xr.Dataset:
    import xarray as xr  # here, because it takes half a second to import

    return xr.Dataset(variables, coords, about)


def _about(
    plant: Plant, done: Driven, seen: dict[str, np.ndarray], variables: dict[str, Any], method: str, tolerance: float
) -> dict[str, Any]:
    rig = plant.rig
    assumed = sorted({name for muscle in rig.muscles for name in muscle.assumed})
    return {
        "rig": rig_to_toml(rig, allow_function=True), "title": _title(plant), "reason": done.reason,
        "notes": "\n".join(_notes(plant, done, seen, variables)), "events": json.dumps(done.events), "method": method,
        "tolerance": float(tolerance), "steps": done.steps, "load": rig.load.kind,
        "supplied": float(plant.supplied), "atmosphere": float(plant.atmosphere), "temperature": float(plant.around),
        "assumed": ", ".join(assumed),
        "mckibben_version": _version(),
    }  # fmt: skip


@cache
def _version() -> str:
    return version("mckibben")


def _title(plant: Plant) -> str:
    load, rig = plant.rig.load, plant.rig
    names = " against ".join(f'"{muscle.name}"' if muscle.name else "a muscle" for muscle in rig.muscles)
    if isinstance(load, FixedEnd):
        return f"{names} held at {show(load.length, 'm', 4)}"
    if isinstance(load, Load):
        return f"{names} with {show(load.mass, 'kg', 4)}"
    return f"{names} on a pulley of {show(load.radius, 'm', 4)}"


def _notes(plant: Plant, done: Driven, seen: dict[str, np.ndarray], variables: dict[str, Any]) -> list[str]:
    found = []
    times = np.array(done.times)
    for k in range(plant.n):
        name = "the muscle" if plant.n == 1 else f"the {NAMES[k]}"
        out = ~seen["inside"][:, k].astype(bool)
        if out.any():
            count, first = f"{int(out.sum())} of {len(out)} times", show(float(times[out][0]), "s", 4)
            said = "its numbers there are a continuation, not the muscle's"
            found.append(f"{name} is outside of its map at {count}, first at {first}: {said}")
        force = seen["force"][:, k].astype(float)
        pushing = force < -PUSHES * max(float(np.abs(force).max()), 1e-9)
        if pushing.any() and not plant.rig.fixed and not plant.slackens:
            at = show(float(times[pushing][0]), "s", 4)
            found.append(f"{name} pushes, first at {at}: on a cable it would be slack (slack = true)")
    found += _of_balance(variables)
    for chart in plant.charts[: 1 if len({id(one) for one in plant.charts}) == 1 else plant.n]:
        found += _of_map(chart)
    assumed = {name for muscle in plant.rig.muscles for name in muscle.assumed}
    if assumed:
        found.append(f"assumed, not measured: {', '.join(sorted(assumed))}")
    return found


def _of_balance(variables: dict[str, Any]) -> list[str]:
    """Whether the energies do not add up as well as they should."""
    off = float(np.abs(variables["balance"][1]).max())
    moved = max(float(np.abs(variables[name][1]).max()) for name in ("enthalpy", "work", "lost", "pushed", "kinetic"))
    if off <= UNBALANCED * moved:
        return []
    return [f"the energies add up to {off:.2g} J only, of {moved:.2g} J moved: ask for a smaller tolerance"]


def _of_map(chart: Mapped) -> Sequence[str]:
    found, error = [], getattr(chart, "error", None)
    if error is not None:
        found.append(f"the forces are those of a map, good to {100.0 * float(error):.2g} % of the largest")
    if getattr(chart, "rubbing_at", None) is not None:
        off = getattr(chart, "friction_error", None)
        good = "" if off is None else f" that are good to {show(float(off), 'N', 2)}"
        said = "friction at the crossings goes by the length alone; pressure turns them too"
        found.append(f"{said}, and leaves a muscle at a fixed length anywhere between its branches{good}")
    return found
