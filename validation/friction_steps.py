"""Are the errors that paths with friction tell large enough? Few steps against many, on more unknowns and points.

Where some crossings slip and others stick, forces depend on the steps of the path and on where the border lies between
two points. The paper's muscle with both parts of friction goes along five paths, with each kind of ends, in 1, 4 and 12
steps from turn to turn, by `mk.run` as it is called by default. The same in 48 steps, on 48 unknowns and twice their
points, stands for the truth. Further paths have friction and corners drawn by chance. Writes
validation/friction_steps.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
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
ENDS = ("clamped", "pinned", "free")
DRAWN, SEED = 36, 20261130
HEAD = "| ends | path | steps from turn to turn | largest error | largest told | error over told | median of that |"
Rows = dict[str, float]
"""Rows of a table, and the largest error over what is told in each."""


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


def compared(words: str, muscle: mk.Muscle, make: Callable[[list[float]], Test], corners: Sequence[float]) -> Rows:
    """A row of the table for each number of steps: the errors of a path and what was told of them."""
    forces, lengths = truth(muscle, make(through(corners, MANY)))
    area, found = np.pi * muscle.braid.radius**2, {}
    for steps in STEPS:
        curve = mk.run(muscle, make(through(corners, steps)))
        if not len(curve.force) == curve.reached == len(forces[:: MANY // steps]):
            raise RuntimeError(f"{words} was not reached whole in {steps} or {MANY} steps")
        force, length = (one[:: MANY // steps] for one in (forces, lengths))
        load = np.maximum(np.abs(force), area * np.abs(curve.pressure))
        error = np.maximum(np.abs(curve.force - force) / load, np.abs(curve.length - length) / length)
        told = curve.data["error_estimate"].values
        ratio = error / told
        row = f"{words} | {steps} | {error.max():.1e} | {told.max():.1e} | {ratio.max():.2f} | {np.median(ratio):.2f}"
        found[f"| {row} |"] = float(ratio.max())
        print(f"| {row} |", flush=True)
    return found


def named() -> Rows:
    """The paths of `PATHS` with each kind of ends."""
    found: Rows = {}
    for ends in ENDS:
        muscle = mk.presets.paper().replace("friction", FRICTION).replace("ends", ends)
        for name, (make, corners) in PATHS.items():
            found |= compared(f"{ends} | {name}", muscle, make, corners)
    return found


def by_chance() -> Rows:
    """Paths of each kind with friction and corners drawn at random."""
    chance, found = np.random.default_rng(SEED), {}
    for k in range(DRAWN):
        ends, kind = ENDS[k % 3], ("isobaric", "isometric", "isotonic")[k // 3 % 3]
        arm, constant, held = chance.uniform(0.02, 0.2), chance.choice([0.0, 0.01, 0.05]), chance.uniform(0.3, 3.0)
        friction = mk.Friction(coefficient=chance.uniform(0.05, 0.5), arm=f"{arm} mm", constant=f"{constant} N mm")
        muscle = mk.presets.paper().replace("friction", friction).replace("ends", ends)
        if kind == "isobaric":
            at, corners = f"{held:.2f} bar", chance.uniform(0.085, 0.118, 3)
            path = partial(mk.Isobaric, at)
        elif kind == "isometric":
            at, corners = f"{chance.uniform(90.0, 118.0):.1f} mm", np.array([0.0, held, chance.uniform(0.0, held)])
            path = partial(mk.Isometric, at)
        else:
            at, corners = f"{chance.uniform(2.0, 20.0):.1f} N", chance.uniform(0.5, 2.0, 3)
            path = partial(mk.Isotonic, at)
        scale, unit = (1.0, "m") if kind == "isobaric" else (1e5, "bar")
        turns = " to ".join(f"{value:.3f}" for value in corners)
        words = f"{ends} | {kind} at {at}, {turns} {unit}, coefficient {friction.coefficient:.2f}, {constant:g} N mm"
        found |= compared(words, muscle, path, (scale * corners).tolist())
    return found


def said(found: Rows) -> str:
    ratios = list(found.values())
    above = sum(ratio > 1.0 for ratio in ratios)
    return (
        f"Of {len(ratios)} paths {above} have a state whose error is above what is told of it; the largest is "
        f"{max(ratios):.2f} of it."
    )


def main() -> None:
    """Write the page."""
    about = "Written by `python validation/friction_steps.py`. " + " ".join((__doc__ or "").split("\n\n")[1].split())
    lines = ["# Errors of paths with friction", "", about]
    for title, found in {"Named paths": named(), f"Paths drawn by chance (seed {SEED})": by_chance()}.items():
        lines += ["", f"## {title}", "", said(found), "", HEAD, "| --- " * HEAD.count(" | ") + "| --- |", *found]
    Path(__file__).with_suffix(".md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
