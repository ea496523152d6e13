"""Are the errors that paths with friction tell large enough? Few steps against many, on more unknowns and points.

Where some crossings slip and others stick, forces depend on the steps of the path and on where the border lies between
two points. The paper's muscle with both parts of friction goes along five paths, with each kind of ends, in 1, 4 and 12
steps from turn to turn, by `mk.run` as it is called by default. The same in 48 steps, on 48 unknowns and twice their
points, stands for the truth. Writes validation/friction_steps.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

import mckibben as mk
from mckibben.experiments.rubbing import denser
from mckibben.experiments.run import crowding_for
from mckibben.experiments.walked import walked
from mckibben.solver.bench import Bench
from mckibben.spec import Test

FRICTION = mk.Friction(coefficient=0.3, arm="0.1 mm", constant="0.01 N mm")
STEPS, MANY, UNKNOWNS = (1, 4, 12), 48, 48


def isobaric(lengths: list[float]) -> Test:
    return mk.Isobaric(pressure="1 bar", length=lengths)


def isometric(length: str) -> Callable[[list[float]], Test]:
    return lambda pressures: mk.Isometric(length=length, pressure=pressures)


def isotonic(pressures: list[float]) -> Test:
    return mk.Isotonic(force="10 N", pressure=pressures)


PATHS: dict[str, tuple[Callable[[list[float]], Test], tuple[float, ...]]] = {
    "isobaric at 1 bar, 110 to 100 to 104 mm": (isobaric, (0.110, 0.100, 0.104)),
    "isometric at 105 mm, 0 to 1 to 0 bar": (isometric("105 mm"), (0.0, 1e5, 0.0)),
    "isometric at 115 mm, 0 to 1 bar": (isometric("115 mm"), (0.0, 1e5)),
    "isometric at 100 mm, 0 to 2 to 0 bar": (isometric("100 mm"), (0.0, 2e5, 0.0)),
    "isotonic at 10 N, 0.5 to 1 to 0.6 bar": (isotonic, (0.5e5, 1e5, 0.6e5)),
}


def through(corners: Sequence[float], steps: int) -> list[float]:
    """From corner to corner in so many steps each."""
    legs = [np.linspace(a, b, steps + 1)[1:] for a, b in pairwise(corners)]
    return [corners[0], *np.concatenate(legs).tolist()]


def truth(muscle: mk.Muscle, test: Test) -> tuple[np.ndarray, np.ndarray]:
    """Forces and lengths along a path on more unknowns and points."""
    bench, steps = Bench.of(muscle), test.as_steps(muscle)
    problem = denser(bench, bench.problem(UNKNOWNS, crowding_for(bench, steps)))
    states = [one.present for leg in walked(bench, problem, steps, lambda k, n: None) for one in leg.states]
    return np.array([one["force"] for one in states]), np.array([one["length"] for one in states])


def rows() -> list[str]:
    """A row for each path: errors and estimates."""
    found, ratios = [], []
    for ends in ("clamped", "pinned", "free"):
        muscle = mk.presets.paper().replace("friction", FRICTION).replace("ends", ends)
        area = np.pi * muscle.braid.radius**2
        for name, (make, corners) in PATHS.items():
            forces, lengths = truth(muscle, make(through(corners, MANY)))
            for steps in STEPS:
                curve = mk.run(muscle, make(through(corners, steps)))
                force, length = (one[:: MANY // steps] for one in (forces, lengths))
                load = np.maximum(np.abs(force), area * np.abs(curve.pressure))
                error = np.maximum(np.abs(curve.force - force) / load, np.abs(curve.length - length) / length)
                told = curve.data["error_estimate"].values
                ratios.append(float((error / told).max()))
                numbers = f"{error.max():.1e} | {told.max():.1e} | {ratios[-1]:.2f} | {np.median(error / told):.2f}"
                found.append(f"| {ends} | {name} | {steps} | {numbers} |")
                print(found[-1], flush=True)
    above = sum(ratio > 1.0 for ratio in ratios)
    most = f"{max(ratios):.1f} times at most"
    said = f"Of {len(ratios)} paths {above} have a state whose error is above its estimate, {most}."
    return [said, "", *found]


def main() -> None:
    """Write the page."""
    said, _, *table = rows()
    head = [
        "# Errors of paths with friction",
        "",
        "Written by `python validation/friction_steps.py`. " + " ".join((__doc__ or "").split("\n\n")[1].split()),
        "",
        said,
        "",
        "| ends | path | steps from turn to turn | largest error | largest told | error over told | median of that |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    Path(__file__).with_suffix(".md").write_text("\n".join([*head, *table]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
