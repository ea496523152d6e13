"""What a datasheet shows: force over length and pressure."""

from typing import Any

import numpy as np
import xarray as xr

from mckibben.experiments.foresee import refuse_friction
from mckibben.experiments.run import run
from mckibben.spec import Isobaric, Muscle, Step
from mckibben.spec.plausible import trusted
from mckibben.spec.text import to_toml

VARIABLES = {"force": "N", "volume": "m^3", "contraction": "1", "energy": "J"}


def force_map(
    muscle: Muscle,
    *,
    length: Any = None,
    contraction: Any = None,
    pressure: Any,
    points: int | None = None,
    tolerance: float = 1e-6,
) -> xr.Dataset:
    """Force-length-pressure map: one isobaric curve for each pressure.

    Args:
        muscle: the specification.
        length: lengths [m]: a ramp such as "60 mm to 115 mm", or a list.
        contraction: in place of the lengths: 1 - h/H0, such as "0 to 25 %".
        pressure: gauge pressures [Pa]: a ramp such as "0 to 3 bar", or a list.
        points: number of lengths and of pressures along ramps (21 if left out).
        tolerance: relative error aimed at.

    Returns:
        A Dataset over pressure and length: force [N], volume [m^3], contraction, stored energy [J], largest fibre
        tension [N], and the verdict; NaN where there is no admissible state.

    Raises:
        SpecError: for wrong input only.

    >>> table = mk.force_map(mk.presets.paper(), length="115 mm to 105 mm", pressure="0 to 1 bar", points=3)
    >>> table.force.sel(pressure=1e5).values.round(2)  # N
    array([101.22,  79.87,  61.77])
    """
    refuse_friction(muscle, "force_map")
    (across,) = Step(length=length, contraction=contraction, force=0.0, points=points).as_steps(muscle)  # type: ignore[call-arg]
    grid = across, Step(force=0.0, pressure=pressure, points=points)
    lengths, pressures = (getattr(step, name) for step, name in zip(grid, ("length", "pressure"), strict=True))
    heights, levels = lengths.sample(grid[0].points), pressures.sample(grid[1].points)
    with trusted():  # these numbers were read above
        tests = [Isobaric(pressure=float(P), length=heights.tolist()) for P in levels]
    curves = [run(muscle, test, tolerance=tolerance) for test in tests]
    axes = ("pressure", "length")
    variables: dict[str, Any] = {
        name: (axes, np.stack([curve.data[name].values for curve in curves]), {"units": unit})
        for name, unit in VARIABLES.items()
    }
    tension = np.stack([curve.data["fibre_tension"].max("v").values for curve in curves])
    variables["largest_fibre_tension"] = (axes, tension, {"units": "N"})
    variables["verdict"] = (axes, np.stack([np.array(curve.verdict) for curve in curves]))
    coords = {
        "pressure": ("pressure", levels, {"units": "Pa", "long_name": "gauge pressure"}),
        "length": ("length", heights, {"units": "m", "long_name": "distance between the fittings"}),
    }
    about = {"muscle": to_toml(muscle, allow_custom=True), "assumed": ", ".join(muscle.assumed)}
    return xr.Dataset(variables, coords, about)
