"""Random muscles that rub, each with a closed test: case k is drawn from the seed and k alone.

Muscles are those of `options.py`, with other numbers than its own 300; fittings of another radius are left out, which
do not go with friction. Every third combination of options has a chamber that may slide along the mesh, and does.
"""

import itertools
import math
from typing import Any

import numpy as np
from options import case_of, options

import mckibben as mk
from mckibben.model.cylinder import cylinder_angle, cylinder_force
from mckibben.model.parameters import parameters

SEED, EACH = 20261201, 8
TESTS = ("isobaric", "isometric", "isotonic")
CLOSE, EVEN = 4, 7
"""States of a leg: close after its corner, where crossings begin to slip, and evenly spaced on."""
MINOR = 0.3
"""Where the minor loop turns back, as a share of the way back to the first state."""
Case = dict[str, Any]


def drawn(k: int) -> Case:
    """Options and test of case k."""
    s = k // EACH
    on = options(s) | {"radii": 0}
    if s % 3 == 2:
        on["chamber"] = ("gap", "bellows")[s // 3 % 2]
    return {"id": k, "options": on, "slides": s % 3 == 2, "test": TESTS[(s + s // 3) % len(TESTS)], "seed": [SEED, k]}


def rubbing_case(case: Case) -> tuple[mk.Muscle, dict[str, Any]]:
    """The muscle with its friction, and what its test holds and between which values it goes: `at`, `first`, `other`.

    The states at `first` and `other` are not looked at beforehand: where there are none the run must say so.
    """
    on, rng = case["options"], np.random.default_rng([*case["seed"], 1])
    muscle, length, _ = case_of({"options": on, "seed": case["seed"]})
    if case["slides"] and on["chamber"] == "bellows":
        muscle = muscle.replace("chamber.lies", "inside")
    pressure = float(10.0 ** rng.uniform(3.3, 5.6) if case["slides"] else rng.uniform(0.2e5, 4e5))
    muscle = muscle.replace("friction", _friction(muscle, pressure, case["slides"], rng))
    share = float(rng.uniform(0.1, 0.7))
    if case["test"] == "isobaric":
        stroke = float(rng.uniform(0.02, 0.12)) * float(muscle.rest_length)
        return muscle, {"at": pressure, "first": length, "other": length + stroke * (1 if rng.random() < 0.3 else -1)}
    if case["test"] == "isometric":
        return muscle, {"at": length, "first": pressure, "other": share * pressure}
    p = parameters(muscle.replace("friction", None))
    force = float(cylinder_force(cylinder_angle(length, p), 0.8 * pressure, p))
    return muscle, {"at": force, "first": pressure, "other": max(share, 0.5) * pressure}


def _friction(muscle: mk.Muscle, pressure: float, slides: bool, rng: np.random.Generator) -> mk.Friction:
    """Friction by the size of the fibres and the tension that the pressure makes; one kind in five is left out."""
    braid, diameter = muscle.braid, float(muscle.braid.fibre.diameter)
    tension = math.pi * float(braid.radius) ** 2 * (pressure + 1e4) / braid.fibres
    coefficient, arm = float(rng.uniform(0.05, 0.6)), float(rng.uniform(0.05, 0.5)) * diameter
    constant = float(rng.uniform(0.0, 0.1)) * diameter * 0.3 * tension
    turn, which = float(10.0 ** rng.uniform(-3.0, -1.7)), rng.random()
    if slides and which < 0.4:
        coefficient = constant = 0.0
    elif which > 0.8:
        coefficient = 0.0
    elif which > 0.6:
        constant = 0.0
    more: dict[str, Any] = {}
    if coefficient or constant:
        more["stiffness"] = (coefficient * arm * 0.3 * tension + constant) / turn
    if slides:
        more |= {"chamber_coefficient": float(rng.uniform(0.02, 0.6))}
        more |= {"chamber_stiffness": float(10.0 ** rng.uniform(7.5, 9.0))}
    return mk.Friction(coefficient=coefficient, arm=arm, constant=constant, **more)


def path(first: float, other: float, finer: int = 1) -> np.ndarray:
    """first, other, part of the way back and to other again, back to first, and all the way to and fro once more.

    The part of the way closes at once, since it is shorter than the way that led to it; all of it the second time,
    when no crossing knows any more how first was reached. With `finer` each step is taken in as many equal parts, so
    that every state of the rough path is one of the fine.
    """
    leg = np.concatenate([np.geomspace(0.01, 0.15, CLOSE), np.linspace(0.15, 1.0, EVEN)[1:]])
    back = other + MINOR * (first - other)
    ways = [(first, other), (other, back), (back, other), (other, first), (first, other), (other, first)]
    rough = np.concatenate([[first], *(begin + (end - begin) * leg for begin, end in ways)])
    shares = np.arange(1, finer + 1) / finer
    parts = [begin + (end - begin) * shares for begin, end in itertools.pairwise(rough)]
    return np.concatenate([[first], *parts])


LEG = CLOSE + EVEN - 1
CORNERS = tuple(LEG * k for k in range(7))
"""States of the rough path at which it turns, the first and the last among them."""


def test_of(name: str, at: float, values: np.ndarray) -> mk.Step:
    """The test through values of what it varies."""
    varied = values.tolist()
    if name == "isobaric":
        return mk.Isobaric(pressure=at, length=varied)
    if name == "isometric":
        return mk.Isometric(length=at, pressure=varied)
    return mk.Isotonic(force=at, pressure=varied)
