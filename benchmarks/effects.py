"""What each effect beyond the paper costs: the same curve of 21 states with it, everything compiled.

Compare with "following alone, 24 unknowns" and "mk.run in full" of the same run.
"""

from typing import Any

import jax
import numpy as np
from curve import LONG, MUSCLE, PATH, PRESSURES
from timing import timed

import mckibben as mk
from mckibben.discretise.placement import crowding
from mckibben.solver.bench import Bench
from mckibben.solver.find import find
from mckibben.solver.follow import follow, padded
from mckibben.solver.held import rows_of, targets_of

EFFECTS = {
    "stretch": ("braid.fibre.stretch", True),
    "roll": ("braid.joint", "pin"),
    "fittings": ("fittings", mk.Fittings(compliance="0.01 mm/N")),
    "thick wall": ("chamber.wall", "thick"),
}


def measure() -> list[dict[str, Any]]:
    """Following alone and `run` with each effect."""
    test = mk.Isometric(length=LONG, pressure="0 to 1 bar", points=len(PATH))
    rows = []
    for name, change in EFFECTS.items():
        muscle = MUSCLE.replace(*change)
        rows.append(following(muscle, f"following alone, 24 unknowns each, with {name}"))
        times = timed(lambda muscle=muscle: mk.run(muscle, test), 5)  # type: ignore[misc]
        rows.append({"name": f"mk.run in full, with {name}", "states": len(PATH), "error": None, **times})
    return rows


def following(muscle: mk.Muscle, name: str) -> dict[str, Any]:
    """The compiled following alone, from the first state on."""
    bench = Bench.of(muscle)
    b = crowding(bench.p, np.full(1, LONG), np.full(1, np.nan), np.full(1, PRESSURES[-1]))
    on = bench.problem(24, b)
    first = find(on, PATH[0])
    own, which = rows_of(PATH[0].names, on.loads)
    targets = padded(targets_of(PATH, on.unit, on.loads))
    count, close = np.asarray(len(PATH)), np.asarray(1e-6)

    def call() -> Any:
        return jax.block_until_ready(follow((on.basis, own), on.p, on.b, first.state, which, targets, count, close))

    times = timed(call, 15)
    assert int(call().good) == len(PATH)
    return {"name": name, "states": len(PATH), "error": None, **times}
